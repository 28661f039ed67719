"""The elevations of the scan by layer, laid beside a vertical axis, with the average of each layer."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QWidget

from stepfield_app.theme import rgb
from stepfield_app.views.extent import Extent
from stepfield_app.views.overlay import Overlay
from stepfield_app.views.pictures import Histogram
from stepfield_app.views.pixels import Boxes, packed
from stepfield_app.views.plot import Plot
from stepfield_app.wording import counted, digits_for, metres, round_step

EMPTY = "Open a scan to see how its points are spread over the elevations."
#: The longest bar leaves this share of the width free.
FREE = 0.06
#: Height of a label, logical pixels.
LABEL = 15
#: Bars longer than so many times one that this share of the bars is shorter than run out of the plot.
USUAL, TIMES_USUAL = 0.95, 3
#: Opacity of the bars: the line at a layer's average shows on the bars of that layer.
BARS = 120


class HistogramView(Plot):
    """Shows a finished histogram."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("points", "elevation", equal_scales=False, parent=parent)
        self.setAccessibleName("Histogram of the elevations, with the average of each layer")
        self.setToolTip("How many points each layer has at each elevation; lines mark its average")
        self._histogram: Histogram | None = None
        self._bars = Boxes()
        self._readout = ""
        self.addItem(self._bars, ignoreBounds=True)
        self.hideAxis("bottom")
        self.pane.setMouseEnabled(x=False, y=True)
        self.setMinimumSize(160, 120)
        self.set_empty_text(EMPTY)
        self.hovered.connect(self._read)
        self.hover_ended.connect(self._forget_cursor)

    def sizeHint(self) -> QSize:  # noqa: N802
        """Return a size that fits a panel."""
        return QSize(260, 220)

    def set_histogram(self, histogram: Histogram | None) -> None:
        """Show a finished histogram; None says how to get one."""
        self._histogram = histogram
        self.set_empty_text("" if histogram is not None else EMPTY)
        if histogram is None:
            self.forget()
            return
        self._stack(histogram)
        edges, longest = histogram.edges, _longest(histogram.counts.sum(axis=0))
        extent = Extent(0.0, float(edges[0]), longest * (1 + FREE), float(edges[-1]))
        self.set_extent(extent, keep_zoom=self.is_touched and extent.is_level_with(self.extent))
        self.viewport().update()  # labels reach beyond the bars

    def fit(self) -> None:
        """Show everything, the bars beginning at the axis."""
        super().fit()
        if self.extent is not None:
            self.pane.setXRange(0.0, self.extent.right, padding=0)

    def _stack(self, histogram: Histogram) -> None:
        """Put the bars of the layers one after the other."""
        edges, counts = histogram.edges, histogram.counts
        ends = np.cumsum(counts, axis=0)
        low, high = (np.broadcast_to(side, counts.shape) for side in (edges[:-1], edges[1:]))
        bars = np.stack([ends - counts, ends, low, high], axis=-1)[counts > 0]
        colours = packed(np.array([rgb(colour) for colour in histogram.colours], np.uint8), BARS)
        self._bars.set_boxes(bars.astype(np.float64), colours[np.nonzero(counts)[0]])

    def _read(self, count: float, elevation: float) -> None:
        histogram = self._histogram
        if histogram is None:
            return
        place = int(np.searchsorted(histogram.edges, elevation, side="right")) - 1
        self._readout = ""
        if 0 <= place < histogram.counts.shape[1]:
            low, high = histogram.edges[place : place + 2]
            digits = digits_for(round_step(max(float(high - low), 1e-4)))
            span = f"{metres(low, digits)} to {metres(high, digits)}"
            self._readout = f"{span}: {counted(int(histogram.counts[:, place].sum()), 'point')}"
        self.viewport().update()

    def _forget_cursor(self) -> None:
        self._readout = ""
        self.viewport().update()

    @property
    def readout(self) -> str:
        """What it says about the bar under the cursor."""
        return self._readout

    def paint_over(self, painter: QPainter, area: QRectF) -> None:
        """Paint the layers' averages, and the count under the cursor."""
        if self._histogram is not None:
            self._paint_levels(painter, area, self._histogram)
        super().paint_over(painter, area)
        if self._readout:
            Overlay(painter, area, self.theme).note(self._readout, self.theme.text)

    def _paint_levels(self, painter: QPainter, area: QRectF, histogram: Histogram) -> None:
        known = sorted(
            (level for level in histogram.levels if math.isfinite(level[2])), key=lambda level: level[2]
        )
        places = [round(self.pixel_of(0.0, elevation).y()) for _, _, elevation in known]
        labels = apart(places, area)
        for (name, colour, elevation), at, label in zip(known, places, labels, strict=True):
            if not area.top() <= at <= area.bottom():
                continue
            text = f"{name}  {metres(elevation)}"
            room = QRectF(0, 0, painter.fontMetrics().horizontalAdvance(text) + 18, LABEL)
            room.moveTopRight(QPointF(area.right(), label - LABEL / 2))
            painter.setPen(QPen(QColor(colour), 2))
            painter.drawPolyline(
                [QPointF(area.left(), at), QPointF(room.left() - 12, at), QPointF(room.left() - 2, label)]
            )
            self._paint_label(painter, room, text, colour)

    def _paint_label(self, painter: QPainter, room: QRectF, text: str, colour: str) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(*rgb(self.theme.window), 210))
        painter.drawRoundedRect(room, 3, 3)
        painter.setBrush(QColor(colour))
        painter.drawRect(QRectF(room.left() + 2, room.center().y() - 4, 8, 8))
        painter.setPen(QColor(self.theme.text))
        painter.drawText(
            room.adjusted(0, 0, -3, 0), Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, text
        )


def _longest(totals: NDArray[np.int64]) -> float:
    """Length that the width of the plot stands for: a floor of one height would leave the rest no length."""
    usual = float(np.quantile(totals[totals > 0], USUAL)) if totals.any() else 1.0
    return min(float(totals.max(initial=1)), TIMES_USUAL * usual)


def apart(places: Sequence[float], area: QRectF) -> list[float]:
    """Move labels apart so that none covers another.

    Parameters
    ----------
    places : sequence of float
        Where the labels should be, descending pixels.
    area : QRectF
        Where there is room for them.
    """
    moved: list[float] = []
    limit = area.bottom() - LABEL / 2
    for place in places:
        moved.append(min(place, limit))
        limit = moved[-1] - LABEL
    limit = area.top() + LABEL / 2
    for index in reversed(range(len(moved))):  # what was pushed out at the top comes back down
        moved[index] = max(moved[index], limit)
        limit = moved[index] + LABEL
    return moved
