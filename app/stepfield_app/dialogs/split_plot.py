"""Pillars of a layer by elevation, and the line that parts them, to be dragged."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from stepfield_app.appearance import numbers_font
from stepfield_app.controls import named
from stepfield_app.scenes.parting import Parting
from stepfield_app.theme import Theme
from stepfield_app.wording import digits_for, metres, round_step

#: Room for the numbers at the left, and above and below the bars, logical pixels; size of small text.
AXIS, MARGIN, SMALL = 72, 12, 11
#: Part of the range that an arrow key moves the line by.
STEP = 0.005
#: How many numbers stand at the axis, at most.
NUMBERS = 6


class SplitPlot(QWidget):
    """Bars lying at their elevation; what is above the line has the colour of the new layer.

    Parameters
    ----------
    parting : Parting
    colours : tuple of str
        Of what stays and of what goes.
    theme : Theme
    """

    chosen = Signal(float)  # elevation, metres

    def __init__(self, parting: Parting, colours: tuple[str, str], theme: Theme) -> None:
        super().__init__()
        self._parting, self._colours, self._theme = parting, colours, theme
        self._elevation = parting.low
        named(self, "Pillars by elevation", "Drag the line, or move it with the arrow keys")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setCursor(Qt.CursorShape.SplitVCursor)

    def show_elevation(self, elevation: float) -> None:
        """Move the line without saying that it was chosen."""
        self._elevation = elevation
        self.update()

    def sizeHint(self) -> QSize:  # noqa: N802
        """Return a size that tells surfaces apart."""
        return QSize(320, 280)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take the line there."""
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._choose(self._elevation_at(event.position().y()))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Drag the line along."""
        self.mousePressEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Move the line up or down."""
        steps = {Qt.Key.Key_Up: 1, Qt.Key.Key_Down: -1, Qt.Key.Key_PageUp: 10, Qt.Key.Key_PageDown: -10}
        step = steps.get(Qt.Key(event.key()))
        if step is None:
            super().keyPressEvent(event)
        else:
            self._choose(self._elevation + step * STEP * (self._parting.high - self._parting.low))

    def _choose(self, elevation: float) -> None:
        self.show_elevation(min(max(elevation, self._parting.low), self._parting.high))
        self.chosen.emit(self._elevation)

    # --- Painting -------------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint bars, numbers and the line."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(self._theme.field))
        font = numbers_font(self.font())
        font.setPixelSize(SMALL)
        painter.setFont(font)
        self._paint_bars(painter)
        self._paint_numbers(painter)
        self._paint_line(painter)

    def _room(self) -> QRectF:
        return QRectF(self.rect()).adjusted(AXIS, MARGIN, -MARGIN, -MARGIN)

    def _place_of(self, elevation: float) -> float:
        room, parting = self._room(), self._parting
        return room.bottom() - (elevation - parting.low) / (parting.high - parting.low) * room.height()

    def _elevation_at(self, place: float) -> float:
        room, parting = self._room(), self._parting
        return parting.low + (room.bottom() - place) / room.height() * (parting.high - parting.low)

    def _paint_bars(self, painter: QPainter) -> None:
        room, edges, counts = self._room(), self._parting.edges, self._parting.counts
        lengths = counts / max(int(counts.max()), 1) * room.width()
        stays, goes = (QColor(colour) for colour in self._colours)
        for number in np.flatnonzero(counts):
            bottom, top = self._place_of(edges[number]), self._place_of(edges[number + 1])
            is_above = (edges[number] + edges[number + 1]) / 2 > self._elevation
            bar = QRectF(room.left(), top, max(float(lengths[number]), 1.0), bottom - top)
            painter.fillRect(bar, goes if is_above else stays)

    def _paint_numbers(self, painter: QPainter) -> None:
        room, parting = self._room(), self._parting
        step = round_step((parting.high - parting.low) / NUMBERS)
        painter.setPen(QColor(self._theme.muted))
        for number in range(int(np.ceil(parting.low / step)), int(np.floor(parting.high / step)) + 1):
            place = QRectF(0, self._place_of(number * step) - SMALL, room.left() - 8, 2 * SMALL)
            side = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
            painter.drawText(place, side, metres(number * step, digits_for(step)))

    def _paint_line(self, painter: QPainter) -> None:
        room, place = self._room(), round(self._place_of(self._elevation))
        for colour, width in ((self._theme.window, 4), (self._theme.accent, 2)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawLine(QPointF(room.left() - 6, place), QPointF(room.right(), place))
        if self.hasFocus():
            painter.setPen(QPen(QColor(self._theme.accent), 1))
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
