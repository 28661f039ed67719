"""Sheets: firm surfaces, kept whole and in the layer that their elevation speaks for.

The fewest seams alone would part level ground at a narrow place, and lift one half of it together with a slab
that a heap leads up to, or for the sake of a handful of stray points beneath. So the paper's classification
(5.3.3) is asked too, not for every pillar but for every sheet: the layer that most of its pillars would have
by elevation. A seam is then worth no more than a certain number of pillars in another layer than that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.cuts import UP, Ties, Wishes, lowest, settled
from stepfield.layers.patches import components

Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Connected pieces of fewer pillars are fragments; what is larger is firm.
FRAGMENT = 64
#: Pillars that may leave the layer of their sheet to spare a seam.
PILLARS_A_SEAM = 64


@dataclass(frozen=True, eq=False)
class Votes:
    """What some pillars say of the layers of their nodes.

    Attributes
    ----------
    node, layer : ndarray of shape (V,), int64
    """

    node: Integers
    layer: Integers


def whole(ties: Ties, layer: Integers, layers: int, size: Integers, votes: Votes) -> tuple[Integers, Wishes]:
    """Settle nodes once more, drawn to the layer that most of their sheet votes for.

    Parameters
    ----------
    ties : Ties
    layer : ndarray of shape (N,), int64
        Of the fewest seams.
    layers : int
    size : ndarray of shape (N,), int64
        Pillars of each node.
    votes : Votes

    Returns
    -------
    layer : ndarray of shape (N,), int64
    wishes : Wishes
        What drew each node, a pillar of it weighing 1.
    """
    piece = components(len(layer), ties.one, ties.other)
    firm = np.bincount(piece, size)[piece] >= FRAGMENT
    sheet = _sheets(_among(ties, firm), len(layer), layers)
    places = (int(sheet.max()) + 1) * layers
    cast = np.bincount(sheet[votes.node] * layers + votes.layer, minlength=places).reshape(-1, layers)
    voted: Mask = cast.sum(axis=1) > 0
    firm &= voted[sheet]
    wishes = Wishes(np.argmax(cast, axis=1)[sheet], np.where(firm, size, 0))
    dear = Ties(ties.one, ties.other, ties.weight * PILLARS_A_SEAM, ties.below, ties.above)
    return settled(dear, layer, layers, wishes=wishes), wishes


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


def _sheets(ties: Ties, nodes: int, layers: int) -> Integers:
    """Return the number of each node's sheet when only these ties bind: what stays connected in a layer."""
    layer = settled(ties, lowest(nodes, ties.below, ties.above, layers), layers, (UP,))
    joined = layer[ties.one] == layer[ties.other]
    return components(nodes, ties.one[joined], ties.other[joined])
