"""Sheets: what the firm surfaces are when nothing small is in their way, to be kept whole.

The fewest seams alone would part a floor in two at a narrow place, and call one half a higher layer, for
the sake of a handful of stray points beneath it. So the layers are found a second time: a seam is then worth
no more than a certain number of pillars in another layer than most of their sheet.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.cuts import UP, Ties, Wishes, lowest, settled
from stepfield.layers.patches import components

Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Connected pieces of fewer pillars are fragments; what is larger is firm.
FRAGMENT = 64
#: Pillars that may part from their sheet to spare a seam.
PILLARS_A_SEAM = 16


def whole(ties: Ties, layer: Integers, layers: int, size: Integers) -> tuple[Integers, Wishes]:
    """Settle nodes once more, drawn to the layer that most of their sheet is in.

    Parameters
    ----------
    ties : Ties
    layer : ndarray of shape (N,), int64
        Of the fewest seams.
    layers : int
    size : ndarray of shape (N,), int64
        Pillars of each node.

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
    votes = np.bincount(sheet * layers + layer, size, minlength=places).reshape(-1, layers)
    wishes = Wishes(np.argmax(votes, axis=1)[sheet], np.where(firm, size, 0))
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
