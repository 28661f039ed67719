"""Selections: masks over the pillars of a reconstruction, and how one becomes another.

A selection is a read-only mask of shape (P,). Surfaces are followed along links: those among the exported
pillars (``result.links``), and for pillars in no layer those among themselves.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import UNASSIGNED
from stepfield.links import link
from stepfield.moves import pillars_in
from stepfield.reconstruction import Reconstruction

Mask = NDArray[np.bool_]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Reach:
    """What a selection may take hold of; nothing else is touched by it.

    Attributes
    ----------
    layer : int, optional
        Only pillars of this layer, -1 for those in none; every layer by default.
    low, high : float, optional
        Only pillars whose elevation is not below or above, scan coordinates, metres.
    """

    layer: int | None = None
    low: float | None = None
    high: float | None = None

    def mask(self, result: Reconstruction) -> Mask:
        """Mask of the pillars within reach, shape (P,)."""
        field = result.field
        lowest = field.compartments.lowest
        within = np.ones(len(field), bool)
        if self.layer is not None:
            within &= result.layering.layer == self.layer
        if self.low is not None:
            within &= field.elevation >= self.low - lowest
        if self.high is not None:
            within &= field.elevation <= self.high - lowest
        return _frozen(within)


EVERYTHING = Reach()


def of_layer(result: Reconstruction, layer: int) -> Mask:
    """Mask of all pillars of a layer, -1 for those in none."""
    return Reach(layer).mask(result)


def inverted(result: Reconstruction, mask: Mask, reach: Reach = EVERYTHING) -> Mask:
    """Mask with everything within reach the other way round."""
    return _frozen(mask ^ reach.mask(result))


def grown(result: Reconstruction, mask: Mask, reach: Reach = EVERYTHING) -> Mask:
    """Mask with the pillars within reach that are linked to selected ones added."""
    near = mask.copy()
    for one, other in _surfaces(result):
        near[other[mask[one]]] = True
        near[one[mask[other]]] = True
    near &= reach.mask(result)
    return _frozen(near | mask)


def shrunk(result: Reconstruction, mask: Mask) -> Mask:
    """Mask without the pillars that are not surrounded: linked to a selected one on all four sides."""
    sides = np.zeros(len(mask), np.int8)
    for one, other in _surfaces(result):
        both = mask[one] & mask[other]
        for end in (one[both], other[both]):
            sides += np.bincount(end, minlength=len(mask)).astype(np.int8)
    return _frozen(sides == 4)


def connected(result: Reconstruction, seed: Mask, reach: Reach = EVERYTHING) -> Mask:
    """Mask of a seed and of all that chains of links within reach connect it to."""
    taken, free = seed.copy(), reach.mask(result) & ~seed
    neighbours, newest = _neighbours(result, free | seed), np.flatnonzero(seed)
    # Step by step outwards: scipy's connected components would hold up all other threads meanwhile.
    mark = np.zeros(len(free), np.int32)
    while len(newest):
        around = neighbours[newest].reshape(-1)
        around = around[(around >= 0) & free[around]]
        free[around] = False
        turn = np.arange(len(around), dtype=np.int32)
        mark[around] = turn
        newest = around[mark[around] == turn]  # each of them once
        taken[newest] = True
    return _frozen(taken)


def carried(before: Reconstruction, after: Reconstruction, mask: Mask) -> Mask:
    """Mask over another result of the pillars at the same places, as edits follow them."""
    if after.field is before.field:
        return mask
    return at_places(after, places(before, mask))


def places(result: Reconstruction, mask: Mask) -> Floats:
    """Return where the selected pillars are: boxes in scan coordinates, shape (n, 6), metres."""
    return result.field.boxes(np.flatnonzero(mask))


def at_places(result: Reconstruction, boxes: Floats) -> Mask:
    """Mask of the pillars at places: see :func:`stepfield.moves.pillars_in`."""
    mask = np.zeros(len(result.field), bool)
    if len(boxes):
        mask[pillars_in(result.field, boxes, one_only=False)] = True
    return _frozen(mask)


def nothing(result: Reconstruction) -> Mask:
    """Mask of no pillar."""
    return _frozen(np.zeros(len(result.field), bool))


def _surfaces(result: Reconstruction) -> Iterator[tuple[Integers, Integers]]:
    """Both ends of the links, of the exported pillars and of the others."""
    yield result.links[:, 0], result.links[:, 1]
    unassigned = result.layering.layer == UNASSIGNED
    if unassigned.any():
        pairs = link(result.field, unassigned, result.linked.link_step)
        yield pairs[:, 0], pairs[:, 1]


def _neighbours(result: Reconstruction, allowed: Mask) -> NDArray[np.int32]:
    """Pillars that each is linked to among the allowed ones, one a side, shape (P, 4); -1 for none."""
    compartment = result.field.compartment
    neighbours = np.full((len(allowed), 4), -1, np.int32)
    for one, other in _surfaces(result):
        kept = allowed[one] & allowed[other]
        one, other = one[kept], other[kept]
        east = compartment[other] - compartment[one] == 1
        for side, there in ((0, east), (2, ~east)):
            neighbours[one[there], side] = other[there]
            neighbours[other[there], side + 1] = one[there]
    return neighbours


def _frozen(mask: Mask) -> Mask:
    mask.flags.writeable = False
    return mask
