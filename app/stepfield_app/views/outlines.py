"""Outlines of what is selected, in the map and in the profile: a light line between dark ones, on any colour.

They are made of pixels: the cost is that of the screen's, however many compartments are selected.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF

from stepfield_app.scenes.marked import ELSEWHERE, HERE, Marked
from stepfield_app.theme import HALO, OUTLINES, rgb
from stepfield_app.views.pixels import Floats, PixelItem, Pixels, Place, packed

Mask = NDArray[np.bool_]

#: Thickness of the light line and of the dark ones beside it, logical pixels.
CORE, EDGE = 1.0, 1.0
#: Opacity, 0 to 255, of the outline of what is in the layer shown, and of what is in another.
STRONG, FAINT = 255, 110


class SelectedCells(PixelItem):
    """Outlines the compartments that hold selected pillars."""

    def __init__(self) -> None:
        super().__init__()
        self._marked: Marked | None = None
        self.setZValue(1)

    @property
    def marked(self) -> Marked | None:
        """What it outlines."""
        return self._marked

    def set_marked(self, marked: Marked | None) -> None:
        """Outline other compartments, or none."""
        self._marked = marked
        self.changed(QRectF() if marked is None else _bounds(marked))

    @property
    def is_blank(self) -> bool:
        """Whether nothing is outlined."""
        return self._marked is None

    def write(self, pixels: Pixels, place: Place) -> None:
        """Write the outlines, what is in the layer shown last."""
        if self._marked is None:
            return
        margin = _margin(place.ratio)
        height, width = pixels.shape
        seen = _sampled(self._marked, place, height + 2 * margin, width + 2 * margin, margin)
        for kind, opacity in ((ELSEWHERE, FAINT), (HERE, STRONG)):
            _write_outline(pixels, seen == kind, place.ratio, opacity)


class SelectedBlocks(PixelItem):
    """Outlines the selected ones among the pillars of a profile."""

    def __init__(self) -> None:
        super().__init__()
        self._spans = np.zeros((0, 4))
        self.setZValue(1)

    def set_spans(self, spans: Floats) -> None:
        """Outline rectangles: left, right, bottom and top, shape (n, 4); what touches gets one outline."""
        if self.is_blank and not len(spans):
            return
        self._spans = spans
        bounds = QRectF()
        if len(spans):
            (left, _, bottom, _), (_, right, _, top) = spans.min(axis=0), spans.max(axis=0)
            bounds = QRectF(left, bottom, right - left, top - bottom)
        self.changed(bounds)

    @property
    def is_blank(self) -> bool:
        """Whether nothing is outlined."""
        return not len(self._spans)

    def has(self, x: float, y: float) -> bool:
        """Whether a place of the plot lies in one of the rectangles."""
        left, right, bottom, top = self._spans.T
        return bool(((left <= x) & (x <= right) & (bottom <= y) & (y <= top)).any())

    def write(self, pixels: Pixels, place: Place) -> None:
        """Write the outlines."""
        margin = _margin(place.ratio)
        height, width = (side + 2 * margin for side in pixels.shape)
        seen = np.zeros((height, width), bool)
        left, right = np.clip(np.rint(place.columns(self._spans[:, :2])) + margin, 0, width).astype(int).T
        bottom, top = np.clip(np.rint(place.rows(self._spans[:, 2:])) + margin, 0, height).astype(int).T
        for west, east, low, high in np.column_stack([left, right, bottom, top]).tolist():
            seen[min(high, low - 1) : low, west : max(east, west + 1)] = True
        _write_outline(pixels, seen, place.ratio, STRONG)


def _bounds(marked: Marked) -> QRectF:
    rows, columns = marked.cells.shape
    wide, high = columns * marked.cell_size, rows * marked.cell_size
    return QRectF(marked.west, marked.north - high, wide, high)


def _sampled(marked: Marked, place: Place, height: int, width: int, margin: int) -> NDArray[np.uint8]:
    """Cells under the pixels; the most telling one where a pixel shows several."""
    rows, columns = marked.cells.shape
    west, east = (place.columns(np.array([0.0, columns * marked.cell_size]) + marked.west) + margin).tolist()
    top, bottom = (place.rows(marked.north - np.array([0.0, rows * marked.cell_size])) + margin).tolist()
    across, down = _under(west, east, columns, width), _under(top, bottom, rows, height)
    seen = np.zeros((height, width), np.uint8)
    if across is not None and down is not None:
        cells = marked.cells[down.cells, across.cells]
        cells = np.maximum.reduceat(cells, down.starts, axis=0)
        seen[down.pixels, across.pixels] = np.maximum.reduceat(cells, across.starts, axis=1)
    return seen


@dataclass(frozen=True, eq=False)
class _Under:
    """Which cells of a row lie under which pixels, and the cell at which each of those begins."""

    cells: slice
    pixels: slice
    starts: NDArray[np.int64]


def _under(begin: float, end: float, count: int, length: int) -> _Under | None:
    """Lay ``count`` cells from pixel ``begin`` to ``end``; None where no pixel of the picture shows any."""
    first = max(0, round(begin))
    last = min(length, max(round(end), first + 1))
    if last <= first or end <= 0:
        return None
    stops = (np.arange(first, last + 1) - begin) / (end - begin) * count
    starts = np.clip(np.floor(stops[:-1] + 1e-9), 0, count - 1).astype(np.int64)
    stop = min(count, max(int(np.ceil(stops[-1] - 1e-9)), int(starts[-1]) + 1))
    return _Under(slice(int(starts[0]), stop), slice(first, last), starts - starts[0])


def _write_outline(pixels: Pixels, seen: Mask, ratio: float, opacity: int) -> None:
    """Write the outline of an area, given with a margin around the picture."""
    core, edge, margin = _thick(CORE, ratio), _thick(EDGE, ratio), _margin(ratio)
    inside = _shrunk(seen, core)
    light = seen & ~inside
    dark = (~_shrunk(~seen, edge) & ~seen) | (inside & ~_shrunk(inside, edge))
    frame = np.s_[margin : margin + pixels.shape[0], margin : margin + pixels.shape[1]]
    for area, colour in ((dark, HALO), (light, OUTLINES["selection"])):
        pixels[area[frame]] = packed(np.array([rgb(colour)], np.uint8), opacity)[0]


def _shrunk(area: Mask, by: int) -> Mask:
    """Take away a seam of some pixels along the edge; what leaves the picture is taken to go on there."""
    kept = area
    for _ in range(by):
        last, kept = kept, kept.copy()
        kept[1:] &= last[:-1]
        kept[:-1] &= last[1:]
        kept[:, 1:] &= last[:, :-1]
        kept[:, :-1] &= last[:, 1:]
    return kept


def _thick(length: float, ratio: float) -> int:
    return max(1, round(length * ratio))


def _margin(ratio: float) -> int:
    return _thick(CORE, ratio) + 2 * _thick(EDGE, ratio)
