"""Patches: pillars of one surface that lie close together, so that one layer may be chosen for all of them.

A scan has far fewer patches than pillars, and cuts of least cost seldom need to pass through one: they can
be found among patches and then moved to the pillar. A patch is connected by links within a square tile of
compartments and has one pillar in a compartment. Where there are not layers enough for all patches that
stand above each other, or where they stand above each other in a circle, they are divided in smaller tiles.
Stray points do not hold a patch in a layer: its pillars above or beneath strays are a patch of their own.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.cuts import Ties, highest, lowest

Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Sides of tiles in compartments, the coarse ones first; a patch that is none in any is single pillars.
SIDES = (8, 2, 1)
#: Connected pieces of fewer pillars are fragments; what is larger is firm.
FRAGMENT = 64
#: Pillars among which components are found at once: scipy holds up all other threads meanwhile.
BATCH = 1 << 15


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Where the pillars that take part stand, and which continue each other.

    Attributes
    ----------
    row, column : ndarray of shape (M,), int64
        Of each pillar's compartment, ascending by row and column.
    tower : ndarray of shape (M,), int64
        Number of the compartment among the occupied ones.
    links : ndarray of shape (L, 2), int64
        Linked pillars: all west and east ones, then all north and south ones, each ascending.
    most : int
        Most pillars in a compartment.
    """

    row: Integers
    column: Integers
    tower: Integers
    links: Integers
    most: int

    def __len__(self) -> int:
        return len(self.row)

    @property
    def stacked(self) -> tuple[Integers, Integers]:
        """Pillars that stand directly above each other: the lower ones and the upper ones."""
        below = np.flatnonzero(self.tower[1:] == self.tower[:-1])
        return below, below + 1


def patches(around: Surroundings, layers: int) -> Integers:
    """Return the number of each pillar's patch, shape (M,), counted from 0.

    Patches fit: in their order above each other there is a layer for each.
    """
    below, above = around.stacked
    patch = np.arange(len(around))  # each by one of its pillars
    level = np.zeros(len(around), np.int8)
    undecided = np.ones(len(around), bool)
    while undecided.any():
        for number, side in enumerate(SIDES):
            _gather(around, patch, undecided & (level == number), side)
        undecided &= _is_twice(around, patch)[patch]
        undecided |= _is_misfit(patch, below, above, layers)[patch] & (level < len(SIDES) - 1)
        level[undecided] += 1
    is_first = np.zeros(len(around), bool)
    is_first[patch] = True
    numbers: Integers = (np.cumsum(is_first) - 1)[patch]
    return numbers


def pieces(patch: Integers, links: Integers) -> Integers:
    """Return the number of each pillar's connected piece, whatever cuts it, shape (M,)."""
    one, other, _ = bound(patch, links)
    return components(int(patch.max()) + 1, one, other)[patch]


def apart(around: Surroundings, patch: Integers, piece: Integers) -> Integers:
    """Divide patches by how many fragments stand beneath and above their pillars; return the new numbers.

    A few strays would otherwise keep a whole patch from the layer of its neighbours, where going around
    each of them costs four seams.
    """
    stray = (np.bincount(piece) < FRAGMENT)[piece]
    if not stray.any():
        return patch
    count = np.concatenate([[0], np.cumsum(stray)])
    first = np.flatnonzero(np.diff(around.tower, prepend=-1))
    last = np.append(first[1:], len(patch))
    beneath = count[:-1] - count[first][around.tower]
    above = count[last][around.tower] - count[1:]
    amid = np.flatnonzero(beneath + above)
    place = (patch[amid] * around.most + beneath[amid]) * around.most + above[amid]
    among, divided = np.unique(place, return_inverse=True)
    whole = int(patch.max()) + 1
    patch = patch.copy()
    patch[amid] = whole + divided
    used = np.bincount(patch, minlength=whole + len(among)) > 0
    numbers: Integers = (np.cumsum(used) - 1)[patch]
    return numbers


def bound(patch: Integers, links: Integers) -> tuple[Integers, Integers, Integers]:
    """Bind patches by links, shape (L, 2): return the ends of every bond and how many links it stands for."""
    count = int(patch.max()) + 1
    one, other = patch[links[:, 0]], patch[links[:, 1]]
    across = one != other
    one, other = one[across], other[across]
    linked, weight = np.unique(np.minimum(one, other) * count + np.maximum(one, other), return_counts=True)
    return linked // count, linked % count, weight


def between(around: Surroundings, patch: Integers, links: Integers) -> Ties:
    """Bind patches by some links, shape (L, 2), and by what stands above each other."""
    count = int(patch.max()) + 1
    below, above = around.stacked
    stacked = np.unique(patch[below] * count + patch[above])
    return Ties(*bound(patch, links), stacked // count, stacked % count)


def components(nodes: int, one: Integers, other: Integers) -> Integers:
    """Return the number of each node's connected component, shape (nodes,)."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    ends = np.ones(len(one), np.int8), (one.astype(np.int32), other.astype(np.int32))
    number: Integers = connected_components(csr_array(ends, shape=(nodes, nodes)), directed=False)[1]
    return number


def _gather(around: Surroundings, patch: Integers, wanted: Mask, side: int) -> None:
    """Make patches of the wanted pillars that are connected within tiles."""
    if not wanted.any():
        return
    one, other = around.links[:, 0], around.links[:, 1]
    if side > 1:
        inside = wanted[one] & wanted[other]
        for place in (around.row // side, around.column // side):
            inside &= place[one] == place[other]
        one, other = one[inside], other[inside]
    else:
        one = other = np.zeros(0, np.int64)
    patch[wanted] = np.flatnonzero(wanted)
    for first, last, some, others in _batches(around, one, other, side):
        part = components(last - first, some - first, others - first)
        leader = np.zeros(part.max() + 1, np.int64)
        leader[part[::-1]] = np.arange(last - first)[::-1]  # of each component its first pillar
        chosen = wanted[first:last]
        patch[first:last][chosen] = leader[part[chosen]] + first


def _batches(
    around: Surroundings, one: Integers, other: Integers, side: int
) -> Iterator[tuple[int, int, Integers, Integers]]:
    """Cut links within tiles into batches of whole rows of tiles: their pillars' range and their ends."""
    tiles = int(around.row[-1]) // side + 1
    together = max(1, tiles * BATCH // len(around))
    starts = np.searchsorted(around.row, np.arange(0, tiles, together) * side)
    bounds = [*starts.tolist(), len(around)]
    turn = np.flatnonzero(one[1:] < one[:-1]) + 1  # where the links from north to south begin
    halves = list(zip(np.split(one, turn), np.split(other, turn), strict=True))
    for first, last in itertools.pairwise(bounds):
        cuts = [np.s_[slice(*np.searchsorted(ends, [first, last]))] for ends, _ in halves]
        some = np.concatenate([ends[cut] for (ends, _), cut in zip(halves, cuts, strict=True)])
        others = np.concatenate([ends[cut] for (_, ends), cut in zip(halves, cuts, strict=True)])
        if len(some):
            yield first, last, some, others


def _is_twice(around: Surroundings, patch: Integers) -> Mask:
    """Whether each patch has two pillars in a compartment."""
    twice = np.zeros(len(patch), bool)
    for higher in range(1, around.most):
        same = (around.tower[higher:] == around.tower[:-higher]) & (patch[higher:] == patch[:-higher])
        twice[patch[higher:][same]] = True
    return twice


def _is_misfit(patch: Integers, below: Integers, above: Integers, layers: int) -> Mask:
    """Whether there is no layer for each patch, so many stand above each other with it, or in a circle."""
    lower, upper = patch[below], patch[above]
    misfit: Mask = lowest(len(patch), lower, upper, layers) > highest(len(patch), lower, upper, layers)
    return misfit
