"""Which pillars are complex: the height-maps are too far from their points, and not by a speck."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import UNASSIGNED
from stepfield.reconstruction import Reconstruction

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: A mesh needs so many points in a compartment to follow anything there.
FEWEST_POINTS = 4
#: A complex pillar with fewer complex ones around it is a speck,
FEWEST_AROUND = 2
#: unless it is a post, or one of two: its points run upwards for more than so many compartments, and none
#: that is complex touches it. Where one does, as at the end of a wall, its mesh reaches over the speck.
TALL = 1.0


def detect(result: Reconstruction, residual: Floats) -> Flags:
    """Find the complex pillars.

    Parameters
    ----------
    result : Reconstruction
    residual : ndarray of shape (P,)
        Root mean square distances of the pillars' points to their surface, metres.

    Returns
    -------
    ndarray of shape (P,), bool
    """
    field = result.field
    far: Flags = np.nan_to_num(residual) > float(result.parameters.complex_residual)
    far &= field.points >= FEWEST_POINTS
    around = touching(result, np.flatnonzero(far))
    together: Flags = far & (_number_around(around, far) >= FEWEST_AROUND)
    is_tall: Flags = field.high - field.low > TALL * field.compartments.grid.cell_size
    is_post: Flags = far & is_tall & (_number_around(around, together) == 0)
    return together | is_post


def _number_around(around: Integers, chosen: Flags) -> Integers:
    """How many chosen pillars touch each one, from the pairs that touch."""
    return np.bincount(around[chosen[around[:, 1]], 0], minlength=len(chosen))


def dilated(result: Reconstruction, chosen: Flags) -> Flags:
    """Add the assigned pillars that touch chosen ones: the overlap of one compartment."""
    near = chosen.copy()
    near[touching(result, np.flatnonzero(chosen))[:, 1]] = True
    near &= result.layering.layer != UNASSIGNED
    return near


def touching(result: Reconstruction, chosen: Integers) -> Integers:
    """Pairs of a chosen pillar and one that touches it.

    Two pillars touch in neighbouring compartments, corner to corner included, where the gap between their
    spans is no wider than the tolerance.

    Parameters
    ----------
    result : Reconstruction
    chosen : ndarray of shape (n,)

    Returns
    -------
    ndarray of shape (m, 2), int64
    """
    field, tolerance = result.field, float(result.parameters.layer_tolerance)
    low, high, pairs = field.low, field.high, [np.zeros((0, 2), np.int64)]
    for one, other in _side_by_side(result, chosen):
        gap = np.maximum(low[one] - high[other], low[other] - high[one])
        touch = gap <= tolerance
        pairs.append(np.column_stack([one[touch], other[touch]]))
    return np.concatenate(pairs)


def _side_by_side(result: Reconstruction, chosen: Integers) -> list[tuple[Integers, Integers]]:
    """Pairs of a chosen pillar and one of each neighbouring compartment, direction by direction."""
    field, grid = result.field, result.field.compartments.grid
    occupied = field.compartments.occupied
    row, column = grid.row_column(field.compartment[chosen])
    found = []
    for south, east in ((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j):
        inside = (row + south >= 0) & (row + south < grid.rows)
        inside &= (column + east >= 0) & (column + east < grid.columns)
        one = chosen[inside]
        wanted = field.compartment[one] + south * grid.columns + east
        place = np.minimum(np.searchsorted(occupied, wanted), len(occupied) - 1)
        there = occupied[place] == wanted
        found.append(_all_of(field.first, one[there], place[there]))
    return found


def _all_of(first: Integers, one: Integers, place: Integers) -> tuple[Integers, Integers]:
    """Pair each pillar with all the pillars of the occupied compartment at its place."""
    number = first[place + 1] - first[place]
    start = np.repeat(first[place] - np.cumsum(number) + number, number)
    return np.repeat(one, number), start + np.arange(len(start))
