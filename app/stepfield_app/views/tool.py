"""What takes mouse and keyboard in a view before the view's own navigation does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QCursor, QKeyEvent, QMouseEvent, QPainter, QWheelEvent
from PySide6.QtWidgets import QWidget

View = TypeVar("View")
Cursor = QCursor | Qt.CursorShape

#: Eighths of a degree of one notch of a wheel.
NOTCH = 120


@dataclass(frozen=True)
class Hand:
    """Where the mouse is, logical pixels of the view, and which of Shift, Ctrl and Alt are down."""

    at: QPointF
    keys: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier


class Tool(Generic[View]):
    """Something that takes the mouse of a view and paints over it; takes nothing unless it says so."""

    def press(self, view: View, hand: Hand) -> bool:
        """Take a press of the left button, or leave it to the view."""
        return False

    def drag(self, view: View, hand: Hand) -> None:
        """Follow the mouse after a press that was taken."""

    def release(self, view: View, hand: Hand) -> None:
        """Let go where the mouse is."""

    def hover(self, view: View, hand: Hand) -> Cursor | None:
        """Return the cursor that tells what a press here would do; None for the view's own."""
        return None

    def leave(self, view: View) -> None:
        """Note that the mouse has left the view."""

    def wheel(self, view: View, hand: Hand, notches: float) -> bool:
        """Take a turn of the wheel, or leave it to the view."""
        return False

    def key(self, view: View, event: QKeyEvent, is_down: bool) -> bool:
        """Take a key that goes down or up, or leave it to the view."""
        return False

    def keeps(self, view: View, event: QKeyEvent) -> bool:
        """Whether a key is the tool's although the window has a command for it."""
        return False

    def paint(self, view: View, painter: QPainter) -> None:
        """Paint over the view."""


class Grip(Generic[View]):
    """The tool of one view, and whether it has the mouse.

    Parameters
    ----------
    view : View
        What the tool is told it works in.
    surface : QWidget
        The widget that the mouse is over: the cursor is set there.
    """

    def __init__(self, view: View, surface: QWidget) -> None:
        self.tool: Tool[View] | None = None
        self._view, self._surface = view, surface
        self._is_held = False
        self._hovered: QPointF | None = None

    @property
    def is_held(self) -> bool:
        """Whether the tool has taken a press and not let go."""
        return self._is_held

    def let_go(self) -> None:
        """Forget a press: its release went elsewhere, as that of a drag to another widget does."""
        self._is_held = False

    def press(self, event: QMouseEvent) -> bool:
        """Offer a press to the tool; while it has the mouse, no other button does anything."""
        if self._is_held:
            return True
        if self.tool is not None and event.button() == Qt.MouseButton.LeftButton:
            self._is_held = self.tool.press(self._view, _hand(event))
        return self._is_held

    def move(self, event: QMouseEvent) -> bool:
        """Let the tool follow the mouse if it has it."""
        if self._is_held and self.tool is not None:
            self.tool.drag(self._view, _hand(event))
            return True
        return self._is_held

    def release(self, event: QMouseEvent) -> bool:
        """Let the tool let go if it has the mouse."""
        if not self._is_held:
            return False
        if event.button() == Qt.MouseButton.LeftButton:
            self._is_held = False
            if self.tool is not None:
                self.tool.release(self._view, _hand(event))
        return True

    def hover(self, event: QMouseEvent) -> bool:
        """Show what a press would do; False when the view may say it."""
        self._hovered = event.position()
        return self._point(event.modifiers())

    def leave(self) -> None:
        """Note that the mouse has left."""
        self._hovered = None
        if self.tool is not None:
            self.tool.leave(self._view)

    def wheel(self, event: QWheelEvent) -> bool:
        """Offer a turn of the wheel to the tool; while the tool has the mouse, nothing zooms."""
        if self.tool is None:
            return False
        hand = Hand(event.position(), event.modifiers())
        notches = (event.angleDelta().y() or event.angleDelta().x()) / NOTCH  # Alt turns the wheel sideways
        return self.tool.wheel(self._view, hand, notches) or self._is_held

    def key(self, event: QKeyEvent, *, is_down: bool) -> bool:
        """Offer a key to the tool, and show what a press would do now."""
        if self.tool is None:
            return False
        is_taken = self.tool.key(self._view, event, is_down)
        self._point(event.modifiers())
        return is_taken

    def keeps(self, event: QKeyEvent) -> bool:
        """Whether the tool wants a key before the window's commands."""
        return self.tool is not None and self.tool.keeps(self._view, event)

    def paint(self, painter: QPainter) -> None:
        """Let the tool paint over the view."""
        if self.tool is not None:
            painter.save()
            self.tool.paint(self._view, painter)
            painter.restore()

    def _point(self, keys: Qt.KeyboardModifier) -> bool:
        if self.tool is None or self._hovered is None:
            return False
        cursor = self.tool.hover(self._view, Hand(self._hovered, keys))
        if cursor is not None:
            self._surface.setCursor(cursor)
        return cursor is not None


def _hand(event: QMouseEvent) -> Hand:
    return Hand(event.position(), event.modifiers())
