"""Marks of suspicious pillars in the map, and the box that chooses which."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPixmap
from PySide6.QtWidgets import QComboBox, QWidget

from stepfield.suspects import CLOSE, ISOLATED, KINDS, SEAMS
from stepfield_app.controls import BESIDE_TEXT, named
from stepfield_app.scenes.suspects import ORDER, Cells
from stepfield_app.theme import DARK, HALO, Theme, rgb
from stepfield_app.views.pixels import PixelItem, Pixels, Place, packed

Integers = NDArray[np.int64]

#: Side of the smallest mark and how far its dark ground reaches beyond it, logical pixels.
LEAST, AROUND = 3.0, 1.0
#: From this side on a mark is a frame, so that the map shows within it.
FRAME_FROM, THICK = 7.0, 2.0
#: Opacity of the inside of a frame, 0 to 255.
INSIDE = 70
#: What can be marked: text, kinds, explanation.
CHOICES: tuple[tuple[str, tuple[str, ...], str], ...] = (
    ("No marks", (), "Mark nothing"),
    ("Close", (CLOSE,), "Pillars that fit another layer nearly as well"),
    ("Seams", (SEAMS,), "Pillars that continue each other but lie in two layers"),
    ("Isolated", (ISOLATED,), "Pillars that continue no other of their layer"),
    ("All marks", KINDS, "Everything suspicious"),
)
SWATCH = 10


def colours(theme: Theme) -> tuple[str, ...]:
    """Colours of the kinds, in the order of :data:`~stepfield_app.scenes.suspects.ORDER`."""
    known = {CLOSE: theme.warning, SEAMS: theme.error, ISOLATED: theme.accent}
    return tuple(known[kind] for kind in ORDER)


class Marks(PixelItem):
    """Marks compartments: dots from afar, frames from near by.

    Parameters
    ----------
    inks : callable
        Colours of the kinds of compartments in a theme; those of suspicious ones by default.
    """

    def __init__(self, inks: Callable[[Theme], tuple[str, ...]] = colours) -> None:
        super().__init__()
        self._inks = inks
        self._cells: Cells | None = None
        self._theme = DARK
        self.setZValue(0.5)  # over the picture, under the selection

    @property
    def cells(self) -> Cells | None:
        """What it marks."""
        return self._cells

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self._theme = theme
        self.set_cells(self._cells)

    def set_cells(self, cells: Cells | None) -> None:
        """Mark other compartments, or none."""
        self._cells = cells
        bounds = QRectF()
        if cells is not None and len(cells.kind):
            west, north, side = cells.west.min(), cells.north.max(), cells.cell_size
            wide, high = cells.west.max() + side - west, north - cells.north.min() + side
            bounds = QRectF(west, north - high, wide, high)
        self.changed(bounds)

    def write(self, pixels: Pixels, place: Place) -> None:
        """Write the marks that are in the picture."""
        if self._cells is None:
            return
        cells, (height, width) = self._cells, pixels.shape
        left, right = (place.columns(cells.west + step) for step in (0, cells.cell_size))
        top, bottom = (place.rows(cells.north - step) for step in (0, cells.cell_size))
        seen = np.flatnonzero((right > 0) & (left < width) & (bottom > 0) & (top < height))
        if not len(seen):
            return
        side, kind = float(right[seen[0]] - left[seen[0]]), cells.kind[seen]
        inks = np.array([rgb(colour) for colour in self._inks(self._theme)], np.uint8)
        if side >= FRAME_FROM * place.ratio:
            edges = [np.rint(edge[seen]).astype(np.int64) for edge in (left, top, right, bottom)]
            thick = max(1, round(THICK * place.ratio))
            _write_frames(pixels, edges, packed(inks)[kind], packed(inks, INSIDE)[kind], thick)
        else:
            column, row = (((a + b) / 2)[seen] for a, b in ((left, right), (top, bottom)))
            codes = np.zeros((height, width), np.uint8)
            inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
            at = row[inside].astype(np.int64), column[inside].astype(np.int64)
            np.maximum.at(codes, at, kind[inside] + 1)
            reach = int(max(side, LEAST * place.ratio)) // 2
            _write_dots(pixels, codes, packed(inks), reach, round(AROUND * place.ratio))


def _write_dots(pixels: Pixels, codes: NDArray[np.uint8], inks: Pixels, reach: int, around: int) -> None:
    """Write squares around pixels, the most telling on top, on a dark ground that reaches farther."""
    marks = _spread(codes, reach)
    pixels[_spread(marks, around) > 0] = packed(np.array([rgb(HALO)], np.uint8))[0]
    is_marked = marks > 0
    pixels[is_marked] = inks[marks[is_marked] - 1]


def _spread(codes: NDArray[np.uint8], by: int) -> NDArray[np.uint8]:
    """Give every pixel the greatest code within some pixels of it, across and down."""
    spread = codes.copy()
    for step in range(1, by + 1):
        np.maximum(spread[:, step:], codes[:, :-step], out=spread[:, step:])
        np.maximum(spread[:, :-step], codes[:, step:], out=spread[:, :-step])
    across = spread.copy()
    for step in range(1, by + 1):
        np.maximum(spread[step:], across[:-step], out=spread[step:])
        np.maximum(spread[:-step], across[step:], out=spread[:-step])
    return spread


def _write_frames(pixels: Pixels, edges: list[Integers], ink: Pixels, faint: Pixels, thick: int) -> None:
    """Write frames with a tinted inside; at this size a picture holds but some thousands of them."""
    height, width = pixels.shape
    lefts, rights = (np.clip(edge, 0, width) for edge in (edges[0], edges[2]))
    tops, bottoms = (np.clip(edge, 0, height) for edge in (edges[1], edges[3]))
    boxes = np.column_stack([lefts, tops, rights, bottoms]).tolist()
    for (left, top, right, bottom), colour, inside in zip(boxes, ink, faint, strict=True):
        pixels[top:bottom, left:right] = colour
        pixels[top + thick : max(bottom - thick, top), left + thick : max(right - thick, left)] = inside


class MarkBox(QComboBox):
    """Chooses what is marked in the map."""

    #: The kinds to mark, a tuple of str.
    chosen = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        named(self, "Marks in the map", "Mark pillars whose layer is doubtful, in the map")
        for text, kinds, explanation in CHOICES:
            self.addItem(text, kinds)
            self.setItemData(self.count() - 1, explanation, Qt.ItemDataRole.ToolTipRole)
        self.set_theme(DARK)
        widest = max(self.fontMetrics().horizontalAdvance(text) for text, _, _ in CHOICES)
        self.setFixedWidth(widest + SWATCH + BESIDE_TEXT)
        self.currentIndexChanged.connect(lambda _: self.chosen.emit(self.kinds))

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds to mark."""
        kinds: tuple[str, ...] = CHOICES[self.currentIndex()][1]
        return kinds

    def set_theme(self, theme: Theme) -> None:
        """Show beside each kind the colour of its marks."""
        for at, (_, kinds, _) in enumerate(CHOICES):
            if len(kinds) == 1:
                self.setItemIcon(at, _swatch(colours(theme)[ORDER.index(kinds[0])]))


def _swatch(colour: str) -> QIcon:
    pixmap = QPixmap(SWATCH, SWATCH)
    pixmap.fill(QColor(colour))
    return QIcon(pixmap)
