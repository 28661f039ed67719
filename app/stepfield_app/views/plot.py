"""What map, profile and histogram share: the look of a plane, its legend, a sentence while it is empty."""

from __future__ import annotations

import pyqtgraph as pg
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QPainter, QResizeEvent
from PySide6.QtWidgets import QWidget

from stepfield_app.scenes.legend import Legend
from stepfield_app.theme import DARK, Theme
from stepfield_app.views.lateness import UPDATING, Lateness
from stepfield_app.views.overlay import Overlay, small_font
from stepfield_app.views.plane import Plane

pg.setConfigOptions(imageAxisOrder="row-major", antialias=False)

#: Width of a legend beside a plot, how much nearer to the edge it may come, and the least width of a plot
#: that has one.
LEGEND_ROOM, MARGIN_BESIDE, LEAST_FOR_LEGEND = 84, 8, 360
#: Least height of a plot with a legend beside it: a ramp with two notes, which nothing lies under.
LEAST_BESIDE = 140


class Plot(Plane):
    """A plane in the colours of a theme, with an overlay.

    Parameters
    ----------
    across, up : str
        What the axes measure.
    equal_scales : bool
        Whether a metre is as long upwards as across.
    """

    def __init__(self, across: str, up: str, equal_scales: bool, parent: QWidget | None = None) -> None:
        self.theme = DARK
        self._empty_text, self._legend, self._room = "", Legend(""), -1
        super().__init__(across, up, equal_scales, parent)
        self._lateness = Lateness(self)
        self._lateness.changed.connect(lambda: self.viewport().update())
        self._leave_room(0)
        self.set_theme(DARK)

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self.theme = theme
        self.setBackground(QColor(theme.window))
        for axis in self.axes.values():
            axis.set_theme(theme)
        self.viewport().update()

    def set_empty_text(self, text: str) -> None:
        """Say this in place of a plot; an empty text shows the plot."""
        if text != self._empty_text:
            self._empty_text = text
            self.getPlotItem().setVisible(not text)
            self.viewport().update()

    def set_legend(self, legend: Legend) -> None:
        """Say what the colours mean."""
        self._legend = legend
        self._leave_room(self._legend_room)
        self.viewport().update()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Leave the room beside the plot to the legend, if there is enough for both."""
        super().resizeEvent(event)
        if self.getPlotItem() is not None:  # the base class resizes itself before there is a plot
            self._leave_room(self._legend_room)

    @property
    def _legend_room(self) -> int:
        """Pixels at the right that the legend has for itself: over the plot it would hide data."""
        return LEGEND_ROOM if self._legend.title and self.width() >= LEAST_FOR_LEGEND else 0

    def _leave_room(self, room: int) -> None:
        if room != self._room:  # or all would be laid out anew for every picture
            self._room = room
            self.getPlotItem().layout.setContentsMargins(4, 8, 12 + room, 4)

    def set_pending(self, is_pending: bool) -> None:
        """Mark the plot as of older parameters, unless the newer one arrives in a moment."""
        self._lateness.set_pending(is_pending)

    @property
    def is_marked_pending(self) -> bool:
        """Whether the mark is on the screen."""
        return bool(self._lateness)

    def drawForeground(self, painter: QPainter, rect: QRectF) -> None:  # noqa: N802
        """Paint what lies over the plot, in pixels of the widget."""
        painter.save()
        painter.resetTransform()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._empty_text:
            painter.setFont(self.font())
            Overlay(painter, QRectF(self.viewport().rect()), self.theme).sentence(self._empty_text)
        else:
            painter.setFont(small_font(self.font()))
            self.paint_over(painter, self.inside)
            painter.setClipRect(self.inside)
            self.grip.paint(painter)
        painter.restore()

    def paint_over(self, painter: QPainter, area: QRectF) -> None:
        """Paint over the plot; ``area`` is its inside, in pixels of the widget."""
        overlay = Overlay(painter, area, self.theme)
        if self._legend_room:
            beside = area.adjusted(0, 0, self._legend_room + MARGIN_BESIDE, 0)
            Overlay(painter, beside, self.theme).legend(self._legend, LEAST_BESIDE)
        if self._lateness:
            overlay.note(UPDATING, self.theme.muted)
