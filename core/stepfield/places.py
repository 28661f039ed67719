"""Which pillars stand in given places of the world, and which share a compartment.

All searches cost as much as they are given places, not as much as the step-field has pillars: a project may
hold ten thousand moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.pillars import StepField

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Metres by which places written to a file and read again may differ.
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Coverage:
    """Where rectangles and pillars meet: a rectangle speaks for one pillar of a compartment.

    Attributes
    ----------
    pillars : ndarray of shape (n,), int64
        Ascending.
    share : ndarray of shape (n,), float64
        Of each one's compartment, how much lies within the rectangles that speak for it.
    depth : ndarray of shape (n,), float64
        How far their elevation spans overlap its own, metres.
    box, pillar : ndarray of shape (m,), int64
        Every pair of a rectangle and a pillar it speaks for.
    """

    pillars: Integers
    share: Floats
    depth: Floats
    box: Integers
    pillar: Integers

    @property
    def is_whole(self) -> bool:
        """Whether no compartment is covered in part: the rectangles are those of this grid."""
        return bool((self.share > 1 - ROUNDING).all())

    def following(self, field: StepField, *, one_only: bool) -> Integers:
        """Return the pillars of which more than half is covered; see :func:`pillars_in`."""
        follows = self.share > 0.5 + ROUNDING
        following = self.pillars[follows]
        if one_only:
            following = following[best_of_runs(field.compartment[following], self.depth[follows])]
        return following


def covered(field: StepField, boxes: Floats) -> Coverage:
    """Find what boxes of shape (B, 6), scan coordinates in metres, speak for."""
    box, compartment, area = _shared_area(field.compartments.grid, boxes)
    place, pillar = standing_in(field, compartment)
    low, high = (boxes[:, side][box] - field.compartments.lowest for side in (4, 5))
    overlap = np.minimum(high[place], field.highs(pillar))
    overlap -= np.maximum(low[place], field.lows(pillar))
    meets = overlap >= -ROUNDING
    place, pillar, overlap = place[meets], pillar[meets], overlap[meets]
    # A rectangle speaks for one pillar of a compartment: the one its elevation span overlaps most.
    spoken = best_of_runs(place, overlap)
    place, pillar, overlap = place[spoken], pillar[spoken], overlap[spoken]
    share = area[place] / field.compartments.grid.cell_size**2
    if (pillar[1:] > pillar[:-1]).all():  # as many as boxes, in order: those of this grid
        return Coverage(pillar, share, overlap, box[place], pillar)
    found, which = np.unique(pillar, return_inverse=True)
    shares, depths = (np.bincount(which, each).astype(np.float64) for each in (share, overlap))
    return Coverage(found, shares, depths, box[place], pillar)


def pillars_in(field: StepField, boxes: Floats, *, one_only: bool) -> Integers:
    """Indices of the pillars that follow a move of ``boxes``, ascending.

    A pillar follows when more than half of its compartment lies within the rectangles and its elevation span
    overlaps theirs.

    Parameters
    ----------
    field : StepField
    boxes : ndarray of shape (B, 6)
        x0, y0, x1, y1, z_low, z_high in scan coordinates, metres.
    one_only : bool
        Keep one pillar a compartment, the most overlapping one: two cannot go to the same layer.
    """
    return covered(field, boxes).following(field, one_only=one_only)


def occupants(field: StepField, layer: Integers, pillars: Integers, target: int) -> Integers:
    """Find the pillar of a layer in the compartment of each of some pillars that are not in it.

    Parameters
    ----------
    field : StepField
    layer : ndarray of shape (P,), int64
        Layer of each pillar.
    pillars : ndarray of shape (n,), int64
    target : int

    Returns
    -------
    ndarray of shape (n,), int64
        -1 where there is none.
    """
    found = np.full(len(pillars), -1)
    for step in (1, -1):  # up the compartment, then down it
        seeker = np.flatnonzero(found < 0)
        at = pillars[seeker] + step
        while len(seeker):
            is_inside = (at >= 0) & (at < len(field))
            seeker, at = seeker[is_inside], at[is_inside]
            is_same = field.compartment[at] == field.compartment[pillars[seeker]]
            seeker, at = seeker[is_same], at[is_same]
            hit = layer[at] == target
            found[seeker[hit]] = at[hit]
            seeker, at = seeker[~hit], at[~hit] + step
    return found


def best_of_runs(key: Integers, worth: NDArray[np.float64] | Integers) -> Integers:
    """Indices of the greatest, and of those the first, in each run of equal keys; shape (runs,)."""
    if not len(key):
        return np.zeros(0, np.int64)
    starts = np.flatnonzero(np.diff(key, prepend=key[0] - 1))
    if len(starts) == len(key):
        return starts
    sizes = np.diff(starts, append=len(key))
    best = np.flatnonzero(worth == np.repeat(np.maximum.reduceat(worth, starts), sizes))
    chosen: Integers = best[np.diff(key[best], prepend=key[0] - 1) != 0]
    return chosen


def _shared_area(grid: Grid, boxes: Floats) -> tuple[Integers, Integers, Floats]:
    """Pairs of box and compartment that share area: box index, compartment number, square metres."""
    edge = boxes[:, :4] - [grid.west, grid.south, grid.west, grid.south]
    first = np.floor(edge[:, :2] / grid.cell_size + ROUNDING).astype(np.int64)
    last = np.ceil(edge[:, 2:] / grid.cell_size - ROUNDING).astype(np.int64) - 1
    limit = np.array([grid.columns, grid.rows]) - 1
    first, last = np.maximum(first, 0), np.minimum(last, limit)
    wide, deep = (np.maximum(last[:, axis] - first[:, axis] + 1, 0) for axis in (0, 1))
    box, nth = _counted_out(wide * deep)
    column = first[box, 0] + nth % wide[box]
    north = first[box, 1] + nth // wide[box]
    side = grid.cell_size
    across = np.minimum(edge[box, 2], (column + 1) * side) - np.maximum(edge[box, 0], column * side)
    along = np.minimum(edge[box, 3], (north + 1) * side) - np.maximum(edge[box, 1], north * side)
    return box, (grid.rows - 1 - north) * grid.columns + column, np.maximum(across * along, 0)


def standing_in(field: StepField, compartment: Integers) -> tuple[Integers, Integers]:
    """Pair compartments with all their pillars: index into ``compartment``, index of the pillar."""
    occupied = field.compartments.occupied
    place = np.minimum(np.searchsorted(occupied, compartment), len(occupied) - 1)
    first = field.first[place]
    held = np.where(occupied[place] == compartment, field.first[place + 1] - first, 0)
    which, nth = _counted_out(held)
    return which, first[which] + nth


def _counted_out(sizes: Integers) -> tuple[Integers, Integers]:
    """Index of each of many runs repeated by its size, and 0, 1, 2 … within the run."""
    if (sizes == 1).all():  # boxes of this very grid
        return np.arange(len(sizes)), np.zeros(len(sizes), np.int64)
    which = np.repeat(np.arange(len(sizes)), sizes)
    return which, np.arange(len(which)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
