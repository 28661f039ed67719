"""Classification of pillars into layers (paper 5.3): one pillar a compartment a layer, always.

The number of layers is the most pillars any compartment holds (5.3.2), unless the operator caps it. From
the order of creation (*rank*) the paper's classification moves pillars to the layer whose average
elevation they are close to, round after round, until nothing changes (5.3.3). Here each round solves, for
every compartment, the assignment exactly: pillars in order of height, one to a layer, least sum of squared
differences to the averages. Neither the reassignment nor the new averages can raise that sum, so it ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.pillars import StepField

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

UNASSIGNED = -1
#: ``max_layers = auto`` never takes more layers than this ...
MOST_AUTOMATIC_LAYERS = 9
#: ... and leaves at most this share of the occupied compartments with more pillars than layers.
CROWDED_SHARE = 0.005
#: The cost cannot cycle, but a huge step-field may creep; then the result says it has not converged.
MOST_ROUNDS = 100


@dataclass(frozen=True)
class Layering:
    """Which layer each pillar belongs to.

    Attributes
    ----------
    layer : ndarray of shape (P,), int64
        Layer of each pillar, 0 the lowest; ``UNASSIGNED`` for none.
    count : int
        Number of layers.
    costs : tuple of float
        Sum of squared differences to the averages (m²) after each round, never rising.
    converged : bool
        False when the limit of rounds was hit.
    """

    layer: Integers
    count: int
    costs: tuple[float, ...] = ()
    converged: bool = True

    @property
    def rounds(self) -> int:
        """How many times the pillars were reassigned."""
        return len(self.costs)

    @property
    def unassigned(self) -> int:
        """How many pillars are in no layer."""
        return int(np.count_nonzero(self.layer == UNASSIGNED))

    def members(self, layer: int) -> Integers:
        """Indices of the pillars of one layer, in order of compartment."""
        return np.flatnonzero(self.layer == layer)

    def averages(self, elevation: Floats) -> Floats:
        """Average elevation of each layer, shape (count,); NaN for a layer without pillars."""
        return _averages(elevation, self.layer, self.count)


def classify(
    field: StepField,
    method: Literal["rank", "elevation"] = "elevation",
    *,
    min_points: int = 1,
    max_layers: int | Literal["auto", "none"] = "auto",
) -> Layering:
    """Give every pillar its layer.

    Parameters
    ----------
    field : StepField
    method : str
        ``rank``: in order of creation, from the lowest. ``elevation``: the paper's 5.3.3.
    min_points : int
        Pillars of fewer points are left unassigned.
    max_layers : int, "auto" or "none"
        At most this many layers; in a compartment with more pillars those of the fewest points
        (ties: the higher) are left unassigned. ``none`` is the paper's.

    Returns
    -------
    Layering
        Layers numbered by ascending average elevation (``elevation``) or rank.
    """
    enough = field.points >= min_points
    count = layer_count(field, enough, max_layers)
    taken = strongest(field, enough, count)
    stack = _Stack.of(field, taken)
    if method == "rank" or not count:
        layering = Layering(stack.spread(stack.rank), count)
    else:
        layering = _by_elevation(stack, count)
    layering.layer.flags.writeable = False
    return layering


def layer_count(
    field: StepField, enough: NDArray[np.bool_], max_layers: int | Literal["auto", "none"]
) -> int:
    """Count the layers: the most pillars in a compartment (5.3.2), or what the operator's cap leaves."""
    held = np.add.reduceat(enough, field.first[:-1], dtype=np.int64)
    most = int(held.max())
    if max_layers == "none":
        return most
    if max_layers != "auto":
        return min(most, max_layers)
    crowded = len(held) - np.cumsum(np.bincount(held))  # compartments that hold more than 0, 1, 2 ... pillars
    fits = np.flatnonzero(crowded < CROWDED_SHARE * np.count_nonzero(held))
    return min(int(fits[0]), most, MOST_AUTOMATIC_LAYERS) if len(fits) else most


def strongest(field: StepField, enough: NDArray[np.bool_], count: int) -> Integers:
    """Indices of the at most ``count`` pillars a compartment keeps: most points first, ties to the lower."""
    chosen = np.flatnonzero(enough)
    if np.add.reduceat(enough, field.first[:-1], dtype=np.int64).max() <= count:
        return chosen
    compartment = field.compartment[chosen]
    order = np.lexsort((field.rank[chosen], -field.points[chosen], compartment))
    starts = np.flatnonzero(np.diff(compartment[order], prepend=-1))
    place = np.arange(len(order)) - np.repeat(starts, np.diff(np.append(starts, len(order))))
    return np.sort(chosen[order[place < count]])


@dataclass(frozen=True)
class _Stack:
    """The pillars that take part, ordered by compartment and height."""

    total: int  # pillars of the whole step-field
    chosen: Integers  # (M,) which of them take part
    elevation: Floats  # (M,)
    rank: Integers  # (M,) place within the compartment among those that take part
    size: Integers  # (M,) how many of the compartment take part

    @classmethod
    def of(cls, field: StepField, chosen: Integers) -> _Stack:
        compartment = field.compartment[chosen]
        starts = np.flatnonzero(np.diff(compartment, prepend=-1))
        sizes = np.diff(np.append(starts, len(chosen)))
        rank = np.arange(len(chosen)) - np.repeat(starts, sizes)
        # Equal points can make a higher pillar's mean no higher than a lower one's by rounding only, so the
        # order of creation is the order of height.
        return cls(len(field), chosen, field.elevation[chosen], rank, np.repeat(sizes, sizes))

    def spread(self, layer: Integers) -> Integers:
        """Layers of all pillars of the step-field, unassigned where they take no part."""
        whole = np.full(self.total, UNASSIGNED, np.int64)
        whole[self.chosen] = layer
        return whole


def _by_elevation(stack: _Stack, count: int) -> Layering:
    """Reassign to the averages until nothing changes (5.3.3), then number layers by average elevation."""
    layer = stack.rank
    averages = _averages(stack.elevation, layer, count)
    groups = [np.flatnonzero((stack.size == size) & (stack.rank == 0)) for size in range(1, count)]
    costs: list[float] = []
    converged = False
    while not converged and len(costs) < MOST_ROUNDS:
        averages, layer = _ascending(averages, layer)
        closer = _reassigned(stack, layer, averages, groups)
        costs.append(float(np.square(stack.elevation - averages[closer]).sum()))
        converged = bool(np.array_equal(closer, layer))
        layer, averages = closer, _averages(stack.elevation, closer, count)
    _, layer = _ascending(averages, layer)
    return Layering(stack.spread(layer), count, tuple(costs), converged)


def _averages(elevation: Floats, layer: Integers, count: int) -> Floats:
    """Average elevation of each layer; NaN for an empty one."""
    assigned = layer >= 0
    if not assigned.all():
        elevation, layer = elevation[assigned], layer[assigned]
    members = np.bincount(layer, minlength=count)
    sums = np.bincount(layer, elevation, minlength=count)
    averages: Floats = np.divide(sums, members, out=np.full(count, np.nan), where=members > 0)
    return averages


def _ascending(averages: Floats, layer: Integers) -> tuple[Floats, Integers]:
    """Number the layers by ascending average: what *in order of height* needs."""
    order = np.argsort(averages, kind="stable")
    if np.array_equal(order, np.arange(len(order))):
        return averages, layer
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    return averages[order], number[layer]


def _reassigned(stack: _Stack, layer: Integers, averages: Floats, groups: list[Integers]) -> Integers:
    """Return the cheapest layers for every compartment; a full one has no choice."""
    closer = stack.rank.copy()  # right for compartments that fill every layer
    for size, bottoms in enumerate(groups, start=1):
        if len(bottoms):
            members = bottoms[:, np.newaxis] + np.arange(size)
            closer[members] = cheapest_layers(stack.elevation[members], averages)
    return closer


def cheapest_layers(elevation: Floats, averages: Floats) -> Integers:
    """Assign the pillars of compartments to layers, in order of height, at the least squared difference.

    Parameters
    ----------
    elevation : ndarray of shape (m, k)
        Elevations of the k pillars in each of m compartments, ascending.
    averages : ndarray of shape (n,)
        Average elevations of the layers, ascending; n >= k.

    Returns
    -------
    ndarray of shape (m, k), int64
        Strictly ascending layers in each row. Ties go to the lower layer.
    """
    m, k = elevation.shape
    n = len(averages)
    slack = n - k  # pillar i can only go to layers i .. i + slack
    best = np.zeros((slack + 1, m))  # least cost of the pillars so far, using layers up to i + s
    choice = np.empty((k, slack + 1, m), np.int16)
    for i in range(k):
        best += np.square(elevation[:, i] - averages[i : i + slack + 1, np.newaxis])
        choice[i, 0] = i
        for s in range(1, slack + 1):
            lower = best[s - 1] <= best[s]
            choice[i, s] = np.where(lower, choice[i, s - 1], i + s)
            np.minimum(best[s], best[s - 1], out=best[s])
    return _traced(choice, slack)


def _traced(choice: NDArray[np.int16], slack: int) -> Integers:
    """Follow the choices back from the top pillar to the bottom one."""
    k, _, m = choice.shape
    layers = np.empty((m, k), np.int64)
    spare = np.full(m, slack)
    for i in range(k - 1, -1, -1):
        layers[:, i] = choice[i, spare, np.arange(m)]
        spare = layers[:, i] - i
    return layers
