"""The layers at which links cost least: a minimum cut.

Nodes are pillars, or patches of them that stay together. A node above another in some compartment needs a
higher layer; every link costs the difference of its ends' layers, which is what a seam costs where these
are neighbours in number. That cost is a discrete convex (L-natural) function of the layers: as long as it
is not the least, it falls when some set of nodes goes up, or down, by one layer, and the best such set is
a minimum cut (Murota, *Discrete Convex Analysis*, 2003). From the lowest layers possible, going up
only, one cut a layer ends at the least cost and, among all layerings of that cost, at the lowest.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Costs more than all links together: what must not happen.
NEVER = 1 << 28
UP, DOWN = 1, -1


@dataclass(frozen=True, eq=False)
class Ties:
    """What binds the layers of nodes to each other.

    Attributes
    ----------
    one, other : ndarray of shape (L,), int64
        Ends of the links.
    weight : ndarray of shape (L,), int64
        How many links each stands for.
    below, above : ndarray of shape (S,), int64
        Nodes that stand above each other, each pair once.
    """

    one: Integers
    other: Integers
    weight: Integers
    below: Integers
    above: Integers


@dataclass(frozen=True, eq=False)
class Wishes:
    """Layers that nodes are drawn to.

    Attributes
    ----------
    layer : ndarray of shape (N,), int64
    weight : ndarray of shape (N,), int64
        What each layer away from it costs.
    """

    layer: Integers
    weight: Integers

    def of(self, nodes: Integers) -> Wishes:
        """Return the wishes of some nodes, or of the nodes that each of others belongs to."""
        return Wishes(self.layer[nodes], self.weight[nodes])

    def without(self, nodes: Mask) -> Wishes:
        """Return the wishes of all nodes but some."""
        return Wishes(self.layer, np.where(nodes, 0, self.weight))

    def times(self, size: Integers) -> Wishes:
        """Return the same wishes, of nodes that stand for so many."""
        return Wishes(self.layer, self.weight * size)


def lowest(nodes: int, below: Integers, above: Integers, layers: int) -> Integers:
    """Return the lowest layer of each node that those beneath it allow, shape (nodes,).

    A node with ``layers`` or more beneath it, or in a circle, gets ``layers``: there is no place for it.
    """
    least = np.zeros(nodes, np.int64)
    for _ in range(layers):
        needed = least[below] + 1
        if (needed <= least[above]).all():
            break
        np.maximum.at(least, above, needed)
        np.minimum(least, layers, out=least)
    return least


def highest(nodes: int, below: Integers, above: Integers, layers: int) -> Integers:
    """Return the highest layer of each node that those above it allow, shape (nodes,); -1 for no place."""
    return layers - 1 - lowest(nodes, above, below, layers)


def cost(ties: Ties, layer: Integers, wishes: Sequence[Wishes] = ()) -> int:
    """Return what the links cost, and what is away from the wishes."""
    of_links = ties.weight * np.abs(layer[ties.one] - layer[ties.other])
    of_wishes = (wish.weight * np.abs(wish.layer - layer) for wish in wishes)
    return int(of_links.sum()) + sum(int(each.sum()) for each in of_wishes)


def settled(
    ties: Ties,
    layer: Integers,
    layers: int,
    directions: Sequence[int] = (UP, DOWN),
    *,
    wishes: Sequence[Wishes] = (),
    free: Mask | None = None,
) -> Integers:
    """Move sets of nodes by a layer as long as that makes the links, and the wishes, cheaper.

    Parameters
    ----------
    ties : Ties
    layer : ndarray of shape (N,), int64
        To begin with; nodes that stand above each other are in ascending layers.
    layers : int
        How many there are.
    directions : sequence of int
        Of ``UP`` and ``DOWN``, the first to begin with; ends when the last that was tried found nothing.
    wishes : sequence of Wishes
        All of them count.
    free : ndarray of shape (N,), bool, optional
        Nodes that may move; all of them by default.
    """
    for tried, way in enumerate(itertools.cycle(directions), 1):
        moving = _cheapest_set(ties, layer, layers, way, wishes, free)
        if moving is not None:
            layer = layer + way * moving
        elif tried >= len(directions):
            break
    return layer


def _cheapest_set(
    ties: Ties, layer: Integers, layers: int, way: int, wishes: Sequence[Wishes], free: Mask | None
) -> Mask | None:
    """Find the smallest set of nodes that is best moved by one layer; None if none gains by it."""
    nodes = len(layer)
    leaning = np.sign(layer[ties.other] - layer[ties.one]) * (way * ties.weight)
    gain = np.bincount(ties.one, leaning, nodes) - np.bincount(ties.other, leaning, nodes)
    gain = gain.astype(np.int64)
    for wish in wishes:
        gain += np.where((wish.layer - layer) * way > 0, wish.weight, -wish.weight)
    held = layer == (layers - 1 if way == UP else 0)
    if free is not None:
        held |= ~free
    joined = layer[ties.one] == layer[ties.other]
    links = ties.one[joined], ties.other[joined], ties.weight[joined]
    pushing = layer[ties.above] == layer[ties.below] + 1
    first, second = ties.below[pushing], ties.above[pushing]
    if way == DOWN:
        first, second = second, first
    while (stopped := held[second] & ~held[first]).any():
        held[first[stopped]] = True
    return _best_of(~held, gain, links, (first, second))


def _best_of(
    movable: Mask,
    gain: Integers,
    links: tuple[Integers, Integers, Integers],
    pushes: tuple[Integers, Integers],
) -> Mask | None:
    """Leave out what cannot move, which is mostly much: links to it are lost by whoever moves."""
    one, other, cost = links
    stays = movable[one] != movable[other]
    leaving = np.where(movable[one], one, other)[stays]
    gain = gain - np.bincount(leaving, cost[stays], len(gain)).astype(np.int64)
    number = np.cumsum(movable) - 1
    inside = movable[one] & movable[other]
    pushed = movable[pushes[0]]
    side = _source_side(
        gain[movable],
        (number[one[inside]], number[other[inside]], cost[inside]),
        (number[pushes[0][pushed]], number[pushes[1][pushed]]),
    )
    if side is None:
        return None
    moving = movable.copy()
    moving[movable] = side
    return moving


def _source_side(
    gain: Integers, links: tuple[Integers, Integers, Integers], pushes: tuple[Integers, Integers]
) -> Mask | None:
    """Cut the nodes in two at the least cost; None if nothing is to be gained by it.

    Parameters
    ----------
    gain : ndarray of shape (N,)
        What moving a node gains; what it costs, where negative.
    links : tuple of ndarray
        Ends and costs of what is lost if only one of the two moves.
    pushes : tuple of ndarray
        Nodes that cannot move unless the second moves too.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import breadth_first_order, maximum_flow

    nodes = len(gain)
    source, sink = nodes, nodes + 1
    (one, other, cost), (first, second) = links, pushes
    eager, loath = np.flatnonzero(gain > 0), np.flatnonzero(gain < 0)
    if not len(eager):
        return None
    rows = np.concatenate([np.full(len(eager), source), loath, one, other, first])
    columns = np.concatenate([eager, np.full(len(loath), sink), other, one, second])
    capacity = np.concatenate([gain[eager], -gain[loath], cost, cost, np.full(len(first), NEVER)])
    network = csr_array(
        (capacity.astype(np.int32), (rows.astype(np.int32), columns.astype(np.int32))),
        shape=(nodes + 2, nodes + 2),
    )
    flow = maximum_flow(network, source, sink)
    if flow.flow_value == gain[eager].sum():
        return None
    left = network - flow.flow
    left.data = (left.data > 0).astype(np.int8)
    left.eliminate_zeros()
    reached = breadth_first_order(left, source, return_predecessors=False)
    side = np.zeros(nodes + 2, bool)
    side[reached] = True
    return side[:nodes]
