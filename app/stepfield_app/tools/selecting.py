"""The hand that selects in one view: strokes, clicks, and the drag of what is selected to somewhere else."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QKeyEvent, QPainter
from PySide6.QtWidgets import QAbstractSpinBox, QApplication, QComboBox, QLineEdit, QWidget

from stepfield_app.scenes.shapes import Kind
from stepfield_app.selection import Selection
from stepfield_app.theme import DARK, Theme
from stepfield_app.tools.choice import Choice
from stepfield_app.tools.cursors import cursor_for
from stepfield_app.tools.grounds import Ground
from stepfield_app.tools.strokes import How, Stroke, how_of, paint_brush
from stepfield_app.views.tool import Cursor, Hand, Tool

#: Carries the selection out of a view until it is dropped somewhere.
Carry = Callable[[QWidget], None]


class SelectingTool(Tool[Any]):
    """Takes the left button of one view while a selecting tool is chosen.

    Parameters
    ----------
    ground : Ground
        The view.
    choice : Choice
    selection : Selection
    carry : callable
        Begins to drag the selection from a widget; returns after the drop.
    """

    def __init__(self, ground: Ground, choice: Choice, selection: Selection, carry: Carry) -> None:
        self.ground, self._choice, self._selection, self._carry = ground, choice, selection, carry
        self.theme: Theme = DARK
        self._stroke: Stroke | None = None
        self._before: Any = None
        self._waits_at: QPointF | None = None
        self._hovered: QPointF | None = None

    @property
    def stroke(self) -> Stroke | None:
        """What is being drawn."""
        return self._stroke

    # --- The mouse ------------------------------------------------------------------------------------------

    def press(self, view: Any, hand: Hand) -> bool:
        """Begin a stroke; on what is selected, wait whether it is to be carried away."""
        kind = self._choice.kind
        if kind is None or not self.ground.is_over(hand.at):
            return False
        if how_of(hand.keys) == "replace" and self.ground.has_selected(hand.at):
            self._waits_at = hand.at
        else:
            self._begin(kind, hand)
        return True

    def drag(self, view: Any, hand: Hand) -> None:
        """Go on with the stroke, or carry the selection away."""
        self._hovered = hand.at
        if self._waits_at is not None:
            if (hand.at - self._waits_at).manhattanLength() >= QApplication.startDragDistance():
                self._waits_at = None
                view.grip.let_go()  # the release will be that of the drag
                self._carry(self.ground.surface)
        elif self._stroke is not None and self._stroke.reach(hand.at):
            if self._stroke.grows:
                self._take(self._stroke.kind, self._stroke.path, self._stroke.how, self._stroke)
            self._repaint()

    def release(self, view: Any, hand: Hand) -> None:
        """Take what the stroke covers; a stroke that covers nothing takes what it points at."""
        stroke, waited_at = self._stroke, self._waits_at
        self._stroke = self._waits_at = None
        if waited_at is not None:
            self.point(waited_at)
        elif stroke is not None:
            stroke.reach(hand.at)
            if stroke.kind in ("rectangle", "lasso") and stroke.is_small:
                self.point(stroke.path[0], stroke.how)
            else:
                self._take(stroke.kind, stroke.path, stroke.how, stroke)
        self._repaint()

    def hover(self, view: Any, hand: Hand) -> Cursor | None:
        """Tell by the cursor what a press would do to the selection."""
        self._hovered = hand.at
        if self._choice.is_aside:
            return Qt.CursorShape.OpenHandCursor
        kind = self._choice.kind
        if kind is None or not self.ground.is_over(hand.at):
            return None
        _take_keyboard(self.ground.focus)
        if kind == "brush":
            self._repaint()
        how = how_of(hand.keys)
        if how == "replace" and self.ground.has_selected(hand.at):
            return Qt.CursorShape.SizeAllCursor
        return cursor_for(how)

    def leave(self, view: Any) -> None:
        """Paint no brush where there is no mouse; the release of Space would go elsewhere now."""
        self._hovered, self._choice.is_aside = None, False
        self._repaint()

    def wheel(self, view: Any, hand: Hand, notches: float) -> bool:
        """Make the brush wider with Ctrl."""
        if self._choice.kind != "brush" or not hand.keys & Qt.KeyboardModifier.ControlModifier:
            return False
        self._choice.widen(notches)
        self._repaint()
        return True

    # --- Keys -----------------------------------------------------------------------------------------------

    def key(self, view: Any, event: QKeyEvent, is_down: bool) -> bool:
        """Navigate as long as Space is held."""
        if event.key() != Qt.Key.Key_Space or self._choice.tool == "navigate":
            return False
        if not event.isAutoRepeat() and self._stroke is None:
            self._choice.is_aside = is_down
            self._repaint()
        return True

    def cancel(self) -> bool:
        """Give a stroke up and leave the selection as it was before; False where there was none."""
        stroke, had_one = self._stroke, self._stroke is not None or self._waits_at is not None
        self._stroke = self._waits_at = None
        if stroke is not None and stroke.grows and self._before is not None:
            self._selection.set(self._before)
        self._repaint()
        return had_one

    # --- Selecting ------------------------------------------------------------------------------------------

    def point(self, at: QPointF, how: How = "replace", kind: Kind | None = None) -> None:
        """Take the pillar at a pixel, or all that is connected to it: with the surface tool, unless told."""
        self._take(kind or ("surface" if self._choice.tool == "surface" else "click"), [at], how)

    def _begin(self, kind: Kind, hand: Hand) -> None:
        self._before = self._selection.mask
        self._stroke = Stroke(kind, how_of(hand.keys), hand, self._choice.radius)
        if self._stroke.grows:
            self._take(kind, self._stroke.path, self._stroke.how, self._stroke)
        self._repaint()

    def _take(self, kind: Kind, path: Sequence[QPointF], how: How, gesture: Stroke | None = None) -> None:
        pick = self.ground.pick(kind, path, self._choice.radius, gesture.lens if gesture else None)
        if pick is not None:
            self._selection.pick(pick, how, gesture)

    # --- Painting -------------------------------------------------------------------------------------------

    def paint(self, view: Any, painter: QPainter) -> None:
        """Paint the stroke, or the brush."""
        if self._stroke is not None:
            self._stroke.paint(painter, self.theme)
        elif self._choice.kind == "brush" and self._hovered is not None:
            paint_brush(painter, self._hovered, self._choice.radius, self.theme)

    def _repaint(self) -> None:
        self.ground.surface.update()


def _take_keyboard(widget: QWidget) -> None:
    """Let the keyboard follow the mouse, Space above all, unless somebody is typing."""
    typed_in = QApplication.focusWidget()
    if typed_in is not widget and not isinstance(typed_in, QLineEdit | QAbstractSpinBox | QComboBox):
        widget.setFocus(Qt.FocusReason.MouseFocusReason)
