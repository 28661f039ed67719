"""Which triangles lie over each square of the plan: what makes looking for the nearest one cheap."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.fidelity.triangles import Triangles
from stepfield.grid import Grid

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Share of a square by which a triangle may reach into the next one without being counted there.
OVERLAP = 1e-6
#: Squares at most: as many as triangles, times this, and never fewer than the other number.
SQUARES_A_TRIANGLE, LEAST_SQUARES = 4, 1 << 16
#: Squares of a mesh whose triangles lie on no grid.
TYPICAL_SQUARES = 1 << 14


@dataclass(frozen=True, eq=False)
class Buckets:
    """Triangles by the squares of a grid, in local coordinates.

    Attributes
    ----------
    grid : Grid
        Its corner is the local origin.
    start : ndarray of shape (squares + 1,), int64
        Where each square's triangles begin in ``triangle``.
    triangle : ndarray of shape (E,), int64
        Those that lie over a square at least in part.
    low, high : ndarray of shape (squares,), float64
        Lowest and highest elevation of a square's triangles; infinite without any.
    """

    grid: Grid
    start: Integers
    triangle: Integers
    low: Floats
    high: Floats

    @classmethod
    def of(cls, triangles: Triangles, grid: Grid) -> Buckets:
        """Sort triangles into the squares of a grid that covers them."""
        square, triangle = _entries(triangles, grid)
        order = np.argsort(square, kind="stable")
        start = np.zeros(len(grid) + 1, np.int64)
        np.cumsum(np.bincount(square, minlength=len(grid)), out=start[1:])
        triangle = triangle[order]
        low, high = np.full(len(grid), np.inf), np.full(len(grid), -np.inf)
        held = np.flatnonzero(np.diff(start))
        if len(held):
            lowest, highest = triangles.span(2)
            low[held] = np.minimum.reduceat(lowest[triangle], start[held])
            high[held] = np.maximum.reduceat(highest[triangle], start[held])
        return cls(grid, start, triangle, low, high)

    def pairs(self, square: Integers) -> tuple[Integers, Integers]:
        """Pair every square asked for with each of its triangles: places in ``square``, and triangles."""
        first = self.start[square]
        count = self.start[square + 1] - first
        place = np.repeat(np.arange(len(square)), count)
        step = np.arange(len(place)) - np.repeat(np.cumsum(count) - count, count)
        return place, self.triangle[first[place] + step]

    def around(self, square: Integers, ring: int) -> Integers:
        """Squares of a ring around others, shape (n, 8 * ring); -1 beyond the grid."""
        grid = self.grid
        row, column = grid.row_column(square)
        down, right = _ring(ring)
        rows, columns = row[:, np.newaxis] + down, column[:, np.newaxis] + right
        there = (rows >= 0) & (rows < grid.rows) & (columns >= 0) & (columns < grid.columns)
        return np.where(there, rows * grid.columns + columns, -1)

    def least_squared(self, square: Integers, x: Floats, y: Floats, z: Floats) -> Floats:
        """Squared distance that everything over a square has at least."""
        grid = self.grid
        row, column = grid.row_column(square)
        west, south = column * grid.cell_size, (grid.rows - 1 - row) * grid.cell_size
        least = np.square(outside(x, west, west + grid.cell_size))
        least += np.square(outside(y, south, south + grid.cell_size))
        least += np.square(outside(z, self.low[square], self.high[square]))
        least *= 1 - 1e-5  # triangles may reach a hair into the next square
        return least

    def to_border(self, x: Floats, y: Floats) -> Floats:
        """Distance in the plan from the nearest side of a point's square; not positive beside the grid."""
        side = self.grid.cell_size
        grid = self.grid
        ends = []
        for axis, count in ((x, grid.columns), (y, grid.rows)):
            step = np.clip(np.floor(axis / side), 0, count - 1) * side
            ends += [axis - step, step + side - axis]
        return np.minimum(np.minimum(ends[0], ends[1]), np.minimum(ends[2], ends[3]))


def coarsened(grid: Grid, triangles: int) -> Grid:
    """Return a grid over the same place without absurdly more squares than there are triangles."""
    most = max(SQUARES_A_TRIANGLE * triangles, LEAST_SQUARES)
    times = 1
    while -(-grid.columns // times) * -(-grid.rows // times) > most:
        times *= 2
    columns, rows = -(-grid.columns // times), -(-grid.rows // times)
    return Grid(grid.west, grid.south, grid.cell_size * times, columns, rows)


def grid_for(low: Floats, high: Floats, triangles: int) -> Grid:
    """Return a grid over the plan between two corners, shape (2,) or longer, for a mesh on no grid."""
    width, depth = (max(float(high[i] - low[i]), 1e-9) for i in range(2))
    squares = max(triangles, TYPICAL_SQUARES)
    side = max(math.sqrt(width * depth / squares), max(width, depth) / squares)
    columns, rows = (max(1, math.ceil(length / side)) for length in (width, depth))
    return Grid(float(low[0]), float(low[1]), side, columns, rows)


def _entries(triangles: Triangles, grid: Grid) -> tuple[Integers, Integers]:
    """Every pair of a square and a triangle whose bounds overlap in the plan."""
    first, last = [], []
    for axis, count in ((0, grid.columns), (1, grid.rows)):
        low, high = (ends / grid.cell_size for ends in triangles.span(axis))
        begin = np.floor(low + OVERLAP)
        end = np.maximum(np.ceil(high - OVERLAP) - 1, begin)
        first.append(np.clip(begin, 0, count - 1).astype(np.int64))
        last.append(np.clip(end, 0, count - 1).astype(np.int64))
    wide, high_up = (b - a + 1 for a, b in zip(first, last, strict=True))
    if (wide * high_up == 1).all():
        return (grid.rows - 1 - first[1]) * grid.columns + first[0], np.arange(len(wide))
    count = wide * high_up
    triangle = np.repeat(np.arange(len(count)), count)
    step = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count, count)
    up, right = np.divmod(step, wide[triangle])
    row = grid.rows - 1 - (first[1][triangle] + up)
    return row * grid.columns + first[0][triangle] + right, triangle


def _ring(ring: int) -> tuple[Integers, Integers]:
    """Steps to the squares of a ring, nearest ways first: rows down and columns right, shape (8 * ring,)."""
    steps = np.arange(-ring, ring + 1)
    down, right = (a.ravel() for a in np.meshgrid(steps, steps, indexing="ij"))
    outer = np.maximum(np.abs(down), np.abs(right)) == ring
    return down[outer], right[outer]


def outside(value: Floats, low: Floats | float, high: Floats | float) -> Floats:
    """How far a value is from an interval, 0 within it."""
    away: Floats = np.maximum(np.maximum(low - value, value - high), 0)
    return away
