"""The empty compartments around pillars: what a move takes along so that it survives another cell size.

A scanner leaves holes, and a wall is one compartment wide. On another grid the compartment that holds such
a pillar is mostly empty ground of the old one: nobody would find more than half of it among the pillars.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.pillars import StepField
from stepfield.places import ROUNDING, standing_in

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Steps to the eight compartments around one: rows, columns.
AROUND = [(row, column) for row in (-1, 0, 1) for column in (-1, 0, 1) if row or column]


@dataclass(frozen=True)
class Taken:
    """Which compartments of a stretch of the grid are taken.

    Attributes
    ----------
    first : int
        Number of the first compartment of the stretch.
    mask : ndarray of shape (n,), bool
    """

    first: int
    mask: NDArray[np.bool_]

    @classmethod
    def of(cls, compartment: Integers, around: Integers, reach: int) -> Taken:
        """Note those of ascending compartments that are at most ``reach`` numbers from some others."""
        if not len(around):
            return cls(0, np.zeros(0, bool))
        first, last = int(around.min()) - reach, int(around.max()) + reach
        mask = np.zeros(last - first + 1, bool)
        mask[compartment[slice(*np.searchsorted(compartment, [first, last + 1]))] - first] = True
        return cls(first, mask)

    def has(self, compartment: Integers) -> NDArray[np.bool_]:
        """Whether each of some compartments of the stretch is taken."""
        has: NDArray[np.bool_] = self.mask[compartment - self.first]
        return has


def margins(field: StepField, layer: Integers, pillars: Integers) -> Floats:
    """Boxes of empty compartments that adjoin chosen pillars more than others of their layer.

    Where a box reaches no pillar stands, so on this grid the chosen pillars are found with and without them.

    Parameters
    ----------
    field : StepField
    layer : ndarray of shape (P,), int64
        Layer of each pillar.
    pillars : ndarray of shape (n,), int64
        The chosen ones, ascending.

    Returns
    -------
    ndarray of shape (m, 6)
        x0, y0, x1, y1, z_low, z_high in scan coordinates, metres.
    """
    compartments, grid = field.compartments, field.compartments.grid
    found = [
        _around(field, np.flatnonzero(layer == number), pillars[layer[pillars] == number])
        for number in np.unique(layer[pillars])
    ]
    if not found:
        return np.zeros((0, 6))
    cell, low, high = (np.concatenate(part) for part in zip(*found, strict=True))
    is_free = _is_free(field, cell, low, high)
    spans = np.column_stack([low, high])[is_free] + compartments.lowest
    return np.hstack([grid.squares(cell[is_free]), spans])


def _around(field: StepField, members: Integers, chosen: Integers) -> tuple[Integers, Floats, Floats]:
    """Compartments without a member of the layer where most of those around are chosen, and their spans."""
    grid = field.compartments.grid
    taken = Taken.of(
        field.compartment[members], around=field.compartment[chosen], reach=2 * (grid.columns + 1)
    )
    chosen = chosen[_is_at_a_rim(grid, field.compartment[chosen], taken)]
    beside, which = _neighbours(grid, field.compartment[chosen])
    is_empty = ~taken.has(beside)
    beside, which = beside[is_empty], chosen[which[is_empty]]
    order = np.argsort(beside, kind="stable")
    beside, which = beside[order], which[order]
    starts = np.flatnonzero(np.diff(beside, prepend=-1))
    if not len(starts):
        return beside, np.zeros(0), np.zeros(0)
    cell, votes = beside[starts], np.diff(starts, append=len(beside))
    others, voter = _neighbours(grid, cell)
    held = np.bincount(voter[taken.has(others)], minlength=len(cell))
    low = np.minimum.reduceat(field.lows(which), starts)
    high = np.maximum.reduceat(field.highs(which), starts)
    wins = 2 * votes > held
    return cell[wins], low[wins], high[wins]


def _is_at_a_rim(grid: Grid, compartment: Integers, taken: Taken) -> NDArray[np.bool_]:
    """Whether one of those around each of some compartments is not taken, or may be beyond the grid."""
    inner = np.ones(len(compartment), bool)
    for down, right in AROUND:
        inner &= taken.has(compartment + (down * grid.columns + right))
    _, column = grid.row_column(compartment)
    at_rim: NDArray[np.bool_] = ~inner | (column == 0) | (column == grid.columns - 1)
    return at_rim


def _is_free(field: StepField, cell: Integers, low: Floats, high: Floats) -> NDArray[np.bool_]:
    """Whether no pillar of a compartment reaches into a span of elevations, metres above the lowest point."""
    place, pillar = standing_in(field, cell)
    meets = field.lows(pillar) <= high[place] + 2 * ROUNDING
    meets &= field.highs(pillar) >= low[place] - 2 * ROUNDING
    is_free = np.ones(len(cell), bool)
    is_free[place[meets]] = False
    return is_free


def _neighbours(grid: Grid, compartment: Integers) -> tuple[Integers, Integers]:
    """Compartments around each of some, and the index of the one they are around."""
    row, column = grid.row_column(compartment)
    cells, which = [], []
    for down, right in AROUND:
        inside = (row + down >= 0) & (row + down < grid.rows)
        inside &= (column + right >= 0) & (column + right < grid.columns)
        which.append(np.flatnonzero(inside))
        cells.append(compartment[inside] + down * grid.columns + right)
    return np.concatenate(cells), np.concatenate(which)
