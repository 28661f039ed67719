"""Where to hide measured ground: in patches shaped like holes, near them, on ground as uneven as theirs."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.holes import Holes

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Patches at most; and compartments in them, about, unless that makes fewer patches than the last number.
PATCHES, PIXELS, LEAST = 64, 4096, 8
#: Share of what was filled that must fit somewhere: small patches do not speak for large holes.
LEAST_SHARE = 0.5
#: Larger holes are not tried: filling so much ten times takes seconds, and hardly any ground is as large.
LARGEST = 2048
#: How far from its hole a patch may be: so many times the hole's longer side, and compartments more.
TIMES, MORE = 3, 8
#: Steps that a longer side takes from one place that is tried to the next, and places tried at once.
STEPS, TRIED = 6, 512
#: Places to choose from for each that is wanted.
KNOWN = 16
#: Compartments from a patch to the end of the grid, at least: nearer, filling would go by fewer.
ENDS = 2


def patches_like(grid: Grid, raster: Floats, found: Holes, filled: Integers) -> list[tuple[float, Integers]]:
    """Say which measured compartments to hide, in patches shaped like some of the holes that were filled.

    Parameters
    ----------
    grid : Grid
    raster : ndarray of shape (rows, columns), float64
        Elevations of the layer's pillars; NaN elsewhere.
    found : Holes
        Of the layer.
    filled : ndarray of shape (n,), int64
        Compartments of them that were filled, ascending.

    Returns
    -------
    list of tuple
        How much each compartment of a patch stands for, and these compartments; nothing where patches that
        fit somewhere would stand for too small a share of what was filled.
    """
    holes = _drawn(found, filled)
    drawn = sum(count for count, _ in holes)
    fitted = [(count, _places(grid, raster, hole, count)) for count, hole in holes if len(hole) <= LARGEST]
    if sum(count for count, places in fitted if places) < LEAST_SHARE * drawn:
        return []
    return [(count / (len(places) * len(place)), place) for count, places in fitted for place in places]


def _drawn(found: Holes, filled: Integers) -> list[tuple[int, Integers]]:
    """Draw holes evenly from all compartments that were filled: how often each, and its compartments."""
    size = np.bincount(found.region, minlength=found.count)
    own = found.region[np.isin(found.compartment, filled, assume_unique=True)]
    # Of a hole that was hardly filled, because other layers are in the way, most is not what was filled.
    chosen = np.flatnonzero(2 * np.bincount(own, minlength=found.count) >= size)
    if not len(chosen):
        return []
    chosen = chosen[np.argsort(size[chosen], kind="stable")]
    reached = np.cumsum(size[chosen])
    draws = int(np.clip(PIXELS * reached[-1] / np.square(size[chosen]).sum(), LEAST, PATCHES))
    at = (np.arange(draws) + 0.5) / draws * reached[-1]
    drawn, counts = np.unique(chosen[np.searchsorted(reached, at, side="right")], return_counts=True)
    order, ends = np.argsort(found.region, kind="stable"), np.cumsum(size)
    return [
        (count, found.compartment[order[ends[n] - size[n] : ends[n]]])
        for n, count in zip(drawn.tolist(), counts.tolist(), strict=True)
    ]


def _places(grid: Grid, raster: Floats, hole: Integers, wanted: int) -> list[Integers]:
    """Shift a hole to places that are measured together with their rims, none on another.

    Of those nearby, the ones whose rims are as uneven as the hole's own: where holes are, ground is rougher.
    """
    rim = np.setdiff1d(np.concatenate([hole - 1, hole + 1, hole - grid.columns, hole + grid.columns]), hole)
    shift, side = _shifts_within(grid, hole)
    step = shift @ np.array([grid.columns, 1])
    known = _measured(raster.ravel(), np.concatenate([rim, hole]), step, KNOWN * wanted)
    uneven = np.ptp(raster.ravel()[rim + step[known, np.newaxis]], axis=1)
    known = known[np.argsort(np.abs(uneven - np.ptp(raster.ravel()[rim])), kind="stable")]
    taken: list[int] = []
    for one in known.tolist():
        if len(taken) < wanted and all(np.abs(shift[one] - shift[other]).max() >= side for other in taken):
            taken.append(one)
    return [hole + step[one] for one in taken]


def _measured(elevation: Floats, places: Integers, step: Integers, wanted: int) -> Integers:
    """Find about as many steps as are wanted, the first ones, that lead from all places to measured ones."""
    found: list[Integers] = []
    for first in range(0, len(step), TRIED):
        there = elevation[places + step[first : first + TRIED, np.newaxis]]
        found.append(first + np.flatnonzero(~np.isnan(there).any(axis=1)))
        if sum(map(len, found)) >= wanted:
            break
    return np.concatenate([np.zeros(0, np.int64), *found])


def _shifts_within(grid: Grid, hole: Integers) -> tuple[Integers, int]:
    """Rows and columns by which to shift a hole within the grid, and its longer side."""
    row, column = grid.row_column(hole)
    side = int(max(np.ptp(row), np.ptp(column))) + 1
    shift = _shifts(side)
    least = [ENDS - row.min(), ENDS - column.min()]
    most = [grid.rows - 1 - ENDS - row.max(), grid.columns - 1 - ENDS - column.max()]
    return shift[((shift >= least) & (shift <= most)).all(axis=1)], side


@lru_cache(maxsize=64)
def _shifts(side: int) -> Integers:
    """Rows and columns by which to shift a hole with such a longer side, the shortest way first."""
    step = max(1, side // STEPS)
    reach = (TIMES * side + MORE) // step
    steps = np.arange(-reach, reach + 1) * step
    shift = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    shift = shift[np.argsort(np.square(shift).sum(axis=1), kind="stable")]
    shift.flags.writeable = False
    return shift
