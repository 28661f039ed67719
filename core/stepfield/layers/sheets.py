"""Sheets: firm surfaces, kept whole and near the layer that their elevation speaks for.

The fewest seams alone would part level ground at a narrow place, and lift one half of it together with a slab
that a heap leads up to; or lift all of it for the sake of a few stray points beneath. So two wishes are
weighed against seams. Every sheet, bound by gentle links only, has a layer by elevation: the one that the
paper's classification (5.3.3) has for most of its pillars. And it has a layer of its own, where most of it
is: what is elsewhere is parted from the rest, and weighs more. A surface that winds over itself is no such
sheet: it has to be cut, and no place of it is better than the one where that is cheapest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter
from typing import Self

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.cuts import UP, Ties, Wishes, cost, lowest, settled
from stepfield.layers.patches import FRAGMENT, components

Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Pillars that may be parted from the rest of their sheet to spare a seam.
PARTED_A_SEAM = 16
#: Pillars that may be out of the layer by elevation to spare a seam.
AWAY_A_SEAM = 256
#: Sheets of more than one in so many pillars are tried in either layer, whatever becomes of the others.
LARGE = 16
#: A surface is wound over itself if letting go of it spares seams, this share of them gentle links at least.
SPARED_GENTLE = 0.75
#: Times that sheets are settled and asked where most of them is: mostly one, seldom four.
MOST_ROUNDS = 8


@dataclass(frozen=True, eq=False)
class Votes:
    """What some pillars say of the layers of their nodes.

    Attributes
    ----------
    node, layer : ndarray of shape (V,), int64
    """

    node: Integers
    layer: Integers


@dataclass(frozen=True, eq=False)
class Found:
    """Layers of nodes, what drew them there, and what all of it costs where a seam is ``AWAY_A_SEAM``.

    Attributes
    ----------
    layer : ndarray of shape (N,), int64
    by_elevation, own : Wishes
        Of the pillars of each node: the layer by elevation of its sheet, and where most of that sheet is.
    cost : int
    """

    layer: Integers
    by_elevation: Wishes
    own: Wishes
    cost: int


def whole(ties: Ties, gentle: Ties, layer: Integers, layers: int, size: Integers, votes: Votes) -> Found:
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
    """
    sheets = Sheets.of(gentle, size, layers)
    voted, heard = sheets.most(votes.node, votes.layer)
    by_elevation = Wishes(voted, (sheets.firm & heard).astype(np.int64))
    dear = Ties(ties.one, ties.other, ties.weight * AWAY_A_SEAM, ties.below, ties.above)
    fewest = layer
    layer = settled(dear, layer, layers, wishes=(by_elevation.times(size),))
    drawn = partial(_drawn, dear, layer, sheets, by_elevation)
    here = sheets.own(layer)
    there = np.where(heard, voted, here)
    best = drawn(here)
    if not np.array_equal(there, here):  # as they are where surfaces are plain
        best = min(best, drawn(there), key=attrgetter("cost"))
    for large in sheets.larger_than(size.sum() / LARGE):
        own = best.own.layer
        other = np.where(sheets.number == large, np.where(own == here, there, here), own)
        if not np.array_equal(other, own):
            best = min(best, drawn(other), key=attrgetter("cost"))
    return _unwound(dear, gentle, sheets, best, fewest, layer)


def _unwound(
    dear: Ties, gentle: Ties, sheets: Sheets, best: Found, fewest: Integers, drawn: Integers
) -> Found:
    """Let go of what winds over itself, first of its layer by elevation too, where that spares cutting it.

    What leads from one sheet to another need not be wound: letting go of level ground that heaps join to
    slabs spares links of the heaps, and cuts more of the ground's own.

    Parameters
    ----------
    dear, gentle : Ties
    sheets : Sheets
    best : Found
    fewest, drawn : ndarray of shape (N,), int64
        Layers of the fewest seams, and of those drawn by elevation only.
    """
    for piece in sheets.cut(sheets.size.sum() / LARGE):
        within = sheets.piece == piece
        if not _spares_gentle(dear, gentle, best.layer, drawn, within):
            continue
        loose = replace(sheets, firm=sheets.firm & ~within)
        for wishes in (best.by_elevation.without(within), best.by_elevation):
            found = _drawn(dear, fewest, loose, wishes, best.own.layer)
            if _spares_gentle(dear, gentle, best.layer, found.layer):
                best, sheets = found, loose
                break
    return best


def _spares_gentle(
    dear: Ties, gentle: Ties, before: Integers, after: Integers, within: Mask | None = None
) -> bool:
    """Whether other layers spare seams (that touch some nodes), for the most part gentle links."""
    spared = []
    for ties in (dear, gentle):
        fewer = np.abs(before[ties.one] - before[ties.other]) - np.abs(after[ties.one] - after[ties.other])
        if within is not None:
            fewer = fewer * (within[ties.one] | within[ties.other])
        spared.append(int((ties.weight * fewer).sum()))
    seams, of_gentle = spared[0] / AWAY_A_SEAM, spared[1]
    return seams > 0 and of_gentle >= SPARED_GENTLE * seams


def _drawn(dear: Ties, layer: Integers, sheets: Sheets, by_elevation: Wishes, own: Integers) -> Found:
    """Settle with each sheet drawn to a layer of its own, then to where most of it went, until it stays."""
    size = sheets.size
    for _ in range(MOST_ROUNDS):
        wishes = by_elevation, Wishes(own, sheets.firm * (AWAY_A_SEAM // PARTED_A_SEAM))
        wished = [wish.times(size) for wish in wishes]
        layer = settled(dear, layer, sheets.layers, wishes=wished)
        own, before = sheets.own(layer), own
        if np.array_equal(own, before):
            break
    return Found(layer, *wishes, cost(dear, layer, wished))


@dataclass(frozen=True, eq=False)
class Sheets:
    """What stays connected when only the gentle links of firm pieces bind, and the fewest of them are cut.

    Attributes
    ----------
    number : ndarray of shape (N,), int64
        Of each node's sheet.
    firm : ndarray of shape (N,), bool
        Whether that is more than a fragment.
    size : ndarray of shape (N,), int64
        Pillars of each node.
    layers : int
    piece : ndarray of shape (N,), int64
        What would be connected if none of the gentle links were cut.
    """

    number: Integers
    firm: Mask
    size: Integers
    layers: int
    piece: Integers

    @classmethod
    def of(cls, gentle: Ties, size: Integers, layers: int) -> Self:
        """Find them, of so many layers at most."""
        nodes = len(size)
        piece = components(nodes, gentle.one, gentle.other)
        firm: Mask = np.bincount(piece, size)[piece] >= FRAGMENT
        ties = _among(gentle, firm)
        layer = settled(ties, lowest(nodes, ties.below, ties.above, layers), layers, (UP,))
        joined = layer[ties.one] == layer[ties.other]
        number = components(nodes, ties.one[joined], ties.other[joined])
        firm &= np.bincount(number, size)[number] >= FRAGMENT
        return cls(number, firm, size, layers, piece)

    def most(
        self, voters: Integers, votes: Integers, weight: Integers | None = None
    ) -> tuple[Integers, Mask]:
        """Return the layer most votes are for in each node's sheet, and whether it has any, shape (N,) both.

        Parameters
        ----------
        voters, votes, weight : ndarray of shape (V,)
            Nodes, the layers they vote for, and how many votes each is.
        """
        ballots = (int(self.number.max()) + 1) * self.layers
        cast = np.bincount(self.number[voters] * self.layers + votes, weight, ballots)
        cast = cast.reshape(-1, self.layers)
        heard: Mask = cast.sum(axis=1) > 0
        return np.argmax(cast, axis=1)[self.number], heard[self.number]

    def own(self, layer: Integers) -> Integers:
        """Return the layer where most of each node's sheet is, shape (N,)."""
        return self.most(np.arange(len(layer)), layer, self.size)[0]

    def larger_than(self, pillars: float) -> Integers:
        """Return the numbers of the firm sheets of more pillars."""
        large: Integers = np.flatnonzero(np.bincount(self.number, self.size * self.firm) > pillars)
        return large

    def cut(self, pillars: float) -> Integers:
        """Return the numbers of the pieces of more pillars that are parted in several firm sheets."""
        _, first = np.unique(self.number[self.firm], return_index=True)
        sheets = np.bincount(self.piece[self.firm][first], minlength=len(self.size))
        large = np.bincount(self.piece, self.size, len(self.size)) > pillars
        return np.flatnonzero((sheets > 1) & large)


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
