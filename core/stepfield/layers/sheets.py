"""Sheets: firm surfaces, kept whole and near the layer that their elevation speaks for.

The fewest seams alone would part level ground at a narrow place, and lift one half of it together with a slab
that a heap leads up to; or lift all of it for the sake of a few stray points beneath. So two wishes are
weighed against seams. Every sheet, bound by gentle links only, has a layer by elevation: the one that the
paper's classification (5.3.3) has for most of its pillars. And it has a layer of its own, where most of it
is: what is elsewhere is parted from the rest, and weighs more.
"""

from __future__ import annotations

from dataclasses import dataclass
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.cuts import UP, Ties, Wishes, cost, lowest, settled
from stepfield.layers.patches import components

Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Connected pieces of fewer pillars are fragments; what is larger is firm.
FRAGMENT = 64
#: Pillars that may be parted from the rest of their sheet to spare a seam.
PARTED_A_SEAM = 16
#: Pillars that may be out of the layer by elevation to spare a seam.
AWAY_A_SEAM = 128
#: Sheets of more than this part of all pillars are tried in either layer, whatever becomes of the others.
LARGE = 16


@dataclass(frozen=True, eq=False)
class Votes:
    """What some pillars say of the layers of their nodes.

    Attributes
    ----------
    node, layer : ndarray of shape (V,), int64
    """

    node: Integers
    layer: Integers


def whole(
    ties: Ties, gentle: Ties, layer: Integers, layers: int, size: Integers, votes: Votes
) -> tuple[Integers, tuple[Wishes, Wishes]]:
    """Settle nodes once more, their sheets kept together and drawn to the layer most of them vote for.

    Parameters
    ----------
    ties : Ties
    gentle : Ties
        Of these, what a sheet is connected by.
    layer : ndarray of shape (N,), int64
        Of the fewest seams.
    layers : int
    size : ndarray of shape (N,), int64
        Pillars of each node.
    votes : Votes

    Returns
    -------
    layer : ndarray of shape (N,), int64
    wishes : tuple of Wishes
        What drew the pillars of each node, where a seam weighs ``AWAY_A_SEAM``.
    """
    sheet, firm = _sheets(gentle, size, layers)
    dear = Ties(ties.one, ties.other, ties.weight * AWAY_A_SEAM, ties.below, ties.above)
    voted, heard = _most(sheet, layers, sheet[votes.node], votes.layer)
    by_elevation = Wishes(voted, (firm & heard).astype(np.int64))
    layer = settled(dear, layer, layers, wishes=(by_elevation.times(size),))

    def most(of: Integers) -> Wishes:
        own, _ = _most(sheet, layers, sheet, of, size)
        return Wishes(own, firm * (AWAY_A_SEAM // PARTED_A_SEAM))

    def drawn(own: Integers) -> tuple[int, Integers, tuple[Wishes, Wishes]]:
        """Settle with each sheet drawn to one layer; tell what is parted from where most of it then is."""
        wishes = by_elevation, Wishes(own, firm * (AWAY_A_SEAM // PARTED_A_SEAM))
        found = settled(dear, layer, layers, wishes=[wish.times(size) for wish in wishes])
        costs = cost(dear, found, [wish.times(size) for wish in (by_elevation, most(found))])
        return costs, found, wishes

    here = most(layer).layer
    there = np.where(heard, voted, here)
    best = drawn(here)
    if np.array_equal(there, here):  # as where surfaces are plain
        return best[1:]
    best = min(best, drawn(there), key=itemgetter(0))
    for large in np.flatnonzero(np.bincount(sheet, size * firm) > size.sum() / LARGE):
        own = best[2][1].layer
        other = np.where(sheet == large, np.where(own == here, there, here), own)
        if not np.array_equal(other, own):
            best = min(best, drawn(other), key=itemgetter(0))
    return best[1:]


def _sheets(gentle: Ties, size: Integers, layers: int) -> tuple[Integers, Mask]:
    """Return the number of each node's sheet and whether that is firm, shape (N,) both.

    A sheet is what stays connected when only the gentle links of firm pieces bind, and fewest are cut.
    """
    nodes = len(size)
    piece = components(nodes, gentle.one, gentle.other)
    firm: Mask = np.bincount(piece, size)[piece] >= FRAGMENT
    ties = _among(gentle, firm)
    layer = settled(ties, lowest(nodes, ties.below, ties.above, layers), layers, (UP,))
    joined = layer[ties.one] == layer[ties.other]
    sheet = components(nodes, ties.one[joined], ties.other[joined])
    firm &= np.bincount(sheet, size)[sheet] >= FRAGMENT
    return sheet, firm


def _among(ties: Ties, chosen: Mask) -> Ties:
    """Keep what binds chosen nodes to each other."""
    linked = chosen[ties.one] & chosen[ties.other]
    stacked = chosen[ties.below] & chosen[ties.above]
    return Ties(
        ties.one[linked],
        ties.other[linked],
        ties.weight[linked],
        ties.below[stacked],
        ties.above[stacked],
    )


def _most(
    sheet: Integers, layers: int, voters: Integers, votes: Integers, weight: Integers | None = None
) -> tuple[Integers, Mask]:
    """Return the layer that each node's sheet has most votes for, and whether it has any, shape (N,) both.

    Parameters
    ----------
    sheet : ndarray of shape (N,)
    layers : int
    voters, votes, weight : ndarray of shape (V,)
        Sheets, the layers they vote for, and how many votes each is.
    """
    cast = np.bincount(voters * layers + votes, weight, (int(sheet.max()) + 1) * layers).reshape(-1, layers)
    heard: Mask = cast.sum(axis=1) > 0
    return np.argmax(cast, axis=1)[sheet], heard[sheet]
