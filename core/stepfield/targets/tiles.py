"""A layer with holes as rectangles without: for programs whose height-fields are solid and whole.

A rectangle is solid from its surface down to an underside as low as its lowest sample, so that a rectangle
over a slope would fill the space beneath it. It therefore ends where its underside would come too near to
what lies below.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.targets.terrain import Raster, Terrain, TerrainLayer

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: Quads along a side: what is near a place stays near in memory, and looking for the end of one stays cheap.
LONGEST = 256
#: Thickness of a rectangle below its lowest sample, metres, where there is room for so much.
SLAB = 0.1
#: Shares of the free height below a quad that its slab, and all of its rectangle, may take.
SLAB_SHARE, SHARE = 1 / 8, 1 / 4
#: Gaps are taken to be at least this high, metres: a simulator needs some thickness.
LEAST_GAP = 0.01


@dataclass(frozen=True, slots=True)
class Tile:
    """A rectangle of quads, all of them whole.

    Attributes
    ----------
    row, column : int
        Of the north-west sample.
    rows, columns : int
        Quads; samples are one more.
    slab : float
        Thickness below the lowest sample, metres.
    """

    row: int
    column: int
    rows: int
    columns: int
    slab: float

    def samples(self, elevations: Raster) -> Raster:
        """Return what of a layer the tile covers, shape (rows + 1, columns + 1)."""
        return elevations[self.row : self.row + self.rows + 1, self.column : self.column + self.columns + 1]


def tiles(terrain: Terrain, layer: TerrainLayer) -> Iterator[Tile]:
    """Cover every whole quad of a layer once."""
    whole = layer.quads
    if not whole.size:
        return iter(())
    beneath = _over_quads(_gaps(terrain, layer), np.minimum)
    low = _over_quads(layer.elevations.astype(np.float64), np.minimum)
    bounds = Bounds(low, low - SHARE * beneath, np.minimum(SLAB, SLAB_SHARE * beneath))
    return rectangles(whole, bounds)


def rectangles(
    whole: Flags, bounds: Bounds, east: Flags | None = None, south: Flags | None = None
) -> Iterator[Tile]:
    """Cover squares once, greedily: from the north-west, first east, then south.

    Parameters
    ----------
    whole : ndarray of shape (rows, columns), bool
        The squares to cover.
    bounds : Bounds
    east, south : ndarray of shape (rows, columns), bool
        Whether a square may be in one rectangle with that to its east, and to its south; all may by default.
    """
    free = whole.copy()
    east = whole if east is None else east
    southward = _Southward(
        _run_southward(whole, whole if south is None else south), _run_southward(east, east)
    )
    for row in range(len(free)):
        column = _next(free[row], 0)
        while column < free.shape[1]:
            tile = _tile(row, column, free, east, southward, bounds)
            free[row : row + tile.rows, column : column + tile.columns] = False
            yield tile
            column = _next(free[row], column)


@dataclass(frozen=True, eq=False)
class Bounds:
    """Of every square: its lowest corner, how low its underside may be, and its slab; metres."""

    low: Floats
    floor: Floats
    slab: Floats

    def along(self, quads: tuple[slice, slice], axis: int) -> Bounds:
        """Reduce a block to one quad a row (axis 1) or a column (axis 0)."""
        return Bounds(self.low[quads].min(axis), self.floor[quads].max(axis), self.slab[quads].min(axis))

    def fitting(self) -> int:
        """Count the first quads that one tile holds with its underside above the floor of all."""
        low, slab = np.minimum.accumulate(self.low), np.minimum.accumulate(self.slab)
        fits = low - slab >= np.maximum.accumulate(self.floor)
        return len(fits) if fits.all() else max(1, int(np.argmin(fits)))


@dataclass(frozen=True, eq=False)
class _Southward:
    """How many squares from each to the south hang together, and how many with those to their east."""

    own: NDArray[np.int32]
    with_east: NDArray[np.int32]

    def depth(self, row: int, column: int, columns: int) -> int:
        """Count the rows that a rectangle may have."""
        own = self.own[row, column : column + columns]
        return int(
            np.minimum(own.min(), self.with_east[row, column : column + columns - 1].min(initial=LONGEST))
        )


def _tile(row: int, column: int, free: Flags, east: Flags, southward: _Southward, bounds: Bounds) -> Tile:
    """Grow a tile from its north-west square: whatever is free in a row is so as far south as it is whole."""
    ahead = free[row, column + 1 : column + LONGEST]
    ahead = ahead & east[row, column : column + len(ahead)]
    gone = np.flatnonzero(~ahead)
    width = 1 + (int(gone[0]) if len(gone) else len(ahead))
    columns = bounds.along(np.s_[row : row + 1, column : column + width], 0).fitting()
    depth = min(LONGEST, southward.depth(row, column, columns))
    rows = bounds.along(np.s_[row : row + depth, column : column + columns], 1).fitting()
    block = np.s_[row : row + rows, column : column + columns]
    return Tile(row, column, rows, columns, float(bounds.slab[block].min()))


def _next(free: NDArray[np.bool_], start: int) -> int:
    """Return the first free quad from ``start`` on, or the number of quads."""
    rest = free[start:]
    first = int(rest.argmax()) if len(rest) else 0
    return start + first if len(rest) and rest[first] else len(free)


def _run_southward(whole: Flags, joined: Flags) -> NDArray[np.int32]:
    """Count the whole squares from each to the south, itself included, that are joined to each other."""
    count = np.zeros(whole.shape, np.int32)
    below = np.zeros(whole.shape[1], np.int32)
    for row in range(len(whole) - 1, -1, -1):
        below = np.where(whole[row], np.where(joined[row], below, 0) + 1, 0).astype(np.int32)
        count[row] = below
    return count


def _gaps(terrain: Terrain, layer: TerrainLayer) -> Floats:
    """Free height under every sample of a layer: to what lies next below it, metres.

    Where nothing lies below, the lowest layer is ground however deep, and any other is free to the base.
    """
    own = layer.elevations.astype(np.float64)
    gap = np.full(own.shape, np.inf) if layer.index == 0 else own - terrain.base_elevation
    for other in terrain.layers:
        if other is not layer:
            distance = own - other.elevations
            gap = np.where(distance > 0, np.fmin(gap, distance), gap)
    return np.fmax(gap, LEAST_GAP)


def _over_quads(values: Floats, reduce: np.ufunc) -> Floats:
    """Reduce every quad's four samples to one value, NaN if any is."""
    across = reduce(values[:, :-1], values[:, 1:])
    over: Floats = reduce(across[:-1], across[1:])
    return over
