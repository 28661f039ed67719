"""A slider with two ends: each can be dragged, and so can the part between them."""

from __future__ import annotations

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPalette, QWheelEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

#: Steps of a key, a page key and a notch of the wheel, as shares of the whole.
STEP, PAGE = 0.005, 0.05
#: Radius of a handle and height of the groove, logical pixels.
RADIUS, GROOVE = 7, 4
#: The ends never come closer than this.
THINNEST = 0.002
LOWER, UPPER, BOTH = 0, 1, 2

_KEYS = {
    Qt.Key.Key_Left: -STEP,
    Qt.Key.Key_Down: -STEP,
    Qt.Key.Key_Right: STEP,
    Qt.Key.Key_Up: STEP,
    Qt.Key.Key_PageDown: -PAGE,
    Qt.Key.Key_PageUp: PAGE,
}


class SlabSlider(QWidget):
    """Two ends between 0 and 1. Arrow keys move the end last touched, Space takes the other one.

    ``chosen`` comes from the operator only; ``pressed`` and ``released`` say from when to when a mouse drags.
    """

    chosen = Signal(float, float)
    pressed = Signal()
    released = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._ends = (0.0, 1.0)
        self._held: int | None = None
        self._active = UPPER
        self._grip = 0.0  # where within what it holds the mouse took hold
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    @property
    def ends(self) -> tuple[float, float]:
        """Where the ends are."""
        return self._ends

    @property
    def is_held(self) -> bool:
        """Whether a mouse drags it."""
        return self._held is not None

    def show_ends(self, lower: float, upper: float) -> None:
        """Move the ends without saying that they were chosen, unless a hand holds them."""
        if not self.is_held:
            self._ends = (min(max(lower, 0.0), 1.0), min(max(upper, 0.0), 1.0))
            self.update()

    def sizeHint(self) -> QSize:  # noqa: N802
        """As high as a slider."""
        return QSize(160, 2 * RADIUS + 10)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """Narrow panels are fine."""
        return QSize(80, 2 * RADIUS + 10)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take hold of the nearer end, or of the part between."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        share = self._share(event.position().x())
        self._held = self._what_is_at(share)
        if self._held != BOTH:
            self._active = self._held
        self._grip = share - self._ends[self._active if self._held != BOTH else LOWER]
        if abs(self._grip) * self._length() > RADIUS and self._held != BOTH:
            self._grip = 0.0  # a click on the groove takes the end there
        self.pressed.emit()
        self._drag(share)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Drag."""
        if self.is_held:
            self._drag(self._share(event.position().x()))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Let go."""
        if self.is_held and event.button() == Qt.MouseButton.LeftButton:
            self._held = None
            self.released.emit()
            self.update()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Move the active end, or take the other one."""
        if event.key() == Qt.Key.Key_Space:
            self._active = LOWER if self._active == UPPER else UPPER
            self.update()
        elif event.key() in _KEYS:
            self._move(self._active, self._ends[self._active] + _KEYS[Qt.Key(event.key())])
        else:
            super().keyPressEvent(event)

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Move the active end."""
        self._move(self._active, self._ends[self._active] + STEP * event.angleDelta().y() / 120)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Draw groove, part between and handles in the colours of the other sliders."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        role, middle = QPalette.ColorRole, self.height() / 2
        accent, knob = self.palette().color(role.Highlight), self.palette().color(role.PlaceholderText)
        low, high = (self._place(end) for end in self._ends)
        for start, stop, colour in (
            (RADIUS, self.width() - RADIUS, self.palette().color(role.Mid)),
            (low, high, accent),
        ):
            painter.setBrush(colour)
            painter.drawRoundedRect(QRectF(start, middle - GROOVE / 2, stop - start, GROOVE), 2, 2)
        for end, place in enumerate((low, high)):
            is_marked = self._held in (end, BOTH) or (self.hasFocus() and self._active == end)
            painter.setBrush(accent if is_marked else knob)
            painter.drawEllipse(QRectF(place - RADIUS, middle - RADIUS, 2 * RADIUS, 2 * RADIUS))

    def _length(self) -> float:
        return max(1.0, self.width() - 2 * RADIUS)

    def _place(self, share: float) -> float:
        return RADIUS + share * self._length()

    def _share(self, x: float) -> float:
        return (x - RADIUS) / self._length()

    def _what_is_at(self, share: float) -> int:
        lower, upper = self._ends
        reach = RADIUS / self._length()
        if lower + reach < share < upper - reach and (lower, upper) != (0.0, 1.0):
            return BOTH
        return LOWER if abs(share - lower) < abs(share - upper) else UPPER

    def _drag(self, share: float) -> None:
        if self._held is not None:
            self._move(self._held, share - self._grip)

    def _move(self, what: int, share: float) -> None:
        lower, upper = self._ends
        if what == BOTH:
            thickness = upper - lower
            lower = min(max(share, 0.0), 1.0 - thickness)
            upper = lower + thickness
        elif what == LOWER:
            lower = min(max(share, 0.0), upper - THINNEST)
        else:
            upper = max(min(share, 1.0), lower + THINNEST)
        if (lower, upper) != self._ends:
            self._ends = (lower, upper)
            self.update()
            self.chosen.emit(lower, upper)
