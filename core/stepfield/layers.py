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
    obstacles : tuple of int
        The layers of walls and columns, if these have layers of their own.
    """

    layer: Integers
    count: int
    costs: tuple[float, ...] = ()
    converged: bool = True
    obstacles: tuple[int, ...] = ()

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

    def in_obstacles(self) -> NDArray[np.bool_]:
        """Whether each pillar is in a layer of obstacles, shape (P,)."""
        kinds = np.zeros(self.count + 1, bool)  # the last one is of Unassigned
        kinds[list(self.obstacles)] = True
        among: NDArray[np.bool_] = kinds[self.layer]
        return among

    def averages(self, elevation: Floats) -> Floats:
        """Average elevation of each layer, shape (count,); NaN for a layer without pillars."""
        return _averages(elevation, self.layer, self.count)


def classify(
    field: StepField,
    method: Literal["rank", "elevation"] = "elevation",
    *,
    min_points: int = 1,
    max_layers: int | Literal["auto", "none"] = "auto",
    leaving_out: NDArray[np.bool_] | None = None,
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
    leaving_out : ndarray of shape (P,), bool, optional
        Pillars that are left unassigned as if they were not there.

    Returns
    -------
    Layering
        Layers numbered by ascending average elevation (``elevation``) or rank.
    """
    enough = field.points >= min_points
    if leaving_out is not None:
        enough &= ~leaving_out
    count = layer_count(field, enough, max_layers)
    taken = strongest(field, enough, count)
    stack = _Stack.of(field, taken)
    if method == "rank" or not count:
        layering = Layering(stack.spread(stack.ranks()), count)
    else:
        layering = _by_elevation(stack, count)
    layering.layer.flags.writeable = False
    return layering


def layer_count(
    field: StepField, enough: NDArray[np.bool_], max_layers: int | Literal["auto", "none"]
) -> int:
    """Count the layers: the most pillars in a compartment (5.3.2), or what the operator's cap leaves."""
    held = _held(field, enough)
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
    if _held(field, enough).max() <= count:
        return chosen
    compartment = field.compartment[chosen]
    order = np.lexsort((field.rank[chosen], -field.points[chosen], compartment))
    starts = np.flatnonzero(np.diff(compartment[order], prepend=-1))
    place = np.arange(len(order)) - np.repeat(starts, np.diff(np.append(starts, len(order))))
    return np.sort(chosen[order[place < count]])


def _held(field: StepField, enough: NDArray[np.bool_]) -> Integers:
    """Count the pillars with enough points in each occupied compartment."""
    if enough.all():
        return np.diff(field.first)
    held: Integers = np.add.reduceat(enough, field.first[:-1], dtype=np.int64)
    return held


@dataclass(frozen=True)
class _Stack:
    """The pillars that take part, ordered by compartment and height."""

    total: int  # pillars of the whole step-field
    chosen: Integers  # (M,) which of them take part
    elevation: Floats  # (M,)
    bottom: Integers  # (C,) where the pillars of each compartment begin
    size: Integers  # (C,) how many they are

    @classmethod
    def of(cls, field: StepField, chosen: Integers) -> _Stack:
        if len(chosen) == len(field):
            return cls(len(field), chosen, field.elevation, field.first[:-1], np.diff(field.first))
        bottom = np.flatnonzero(np.diff(field.compartment[chosen], prepend=-1))
        sizes = np.diff(np.append(bottom, len(chosen)))
        return cls(len(field), chosen, field.elevation[chosen], bottom, sizes)

    def ranks(self) -> Integers:
        """Place within the compartment among those that take part, shape (M,).

        Equal points can make a higher pillar's mean no higher than a lower one's by rounding only, so the
        order of creation is the order of height.
        """
        return np.arange(len(self.chosen)) - np.repeat(self.bottom, self.size)

    def spread(self, layer: Integers) -> Integers:
        """Layers of all pillars of the step-field, unassigned where they take no part."""
        if len(self.chosen) == self.total:
            return layer
        whole = np.full(self.total, UNASSIGNED, np.int64)
        whole[self.chosen] = layer
        return whole


@dataclass(frozen=True)
class _Choice:
    """The pillars that have a choice of layer, and what the others add to the averages.

    A compartment with as many pillars as there are layers has one in each, whatever the averages.
    """

    count: int  # layers
    rows: Integers  # (F,) which pillars of the stack have a choice
    elevation: Floats  # (F,)
    groups: tuple[Integers, ...]  # for sizes from 1 to count - 1: indices into rows, shape (m, size)
    full: int  # compartments without a choice
    sums: Floats  # (count,) elevations of their pillars in each layer, metres
    scatter: float  # of them around their own averages, m²

    @classmethod
    def of(cls, stack: _Stack, count: int) -> _Choice:
        bottoms = [stack.bottom[stack.size == size] for size in range(1, count + 1)]
        *some, full = bottoms
        members = [bottom[:, np.newaxis] + np.arange(size) for size, bottom in enumerate(some, start=1)]
        ends = np.cumsum([0, *(part.size for part in members)])
        rows = np.concatenate([np.zeros(0, np.int64), *(part.ravel() for part in members)])
        fixed = [stack.elevation[full + layer] for layer in range(count)]
        return cls(
            count,
            rows,
            stack.elevation[rows],
            tuple(
                np.arange(end - part.size, end).reshape(part.shape)
                for end, part in zip(ends[1:], members, strict=True)
            ),
            len(full),
            np.array([part.sum() for part in fixed]),
            sum(float(np.square(part - part.mean()).sum()) for part in fixed if len(part)),
        )

    def ranks(self) -> Integers:
        """Place within the compartment, shape (F,)."""
        ranks = np.empty(len(self.rows), np.int64)
        for members in self.groups:
            ranks[members] = np.arange(members.shape[1])
        return ranks

    def averages(self, layer: Integers) -> Floats:
        """Average elevation of each layer, those without a choice included; NaN for an empty one."""
        members = self.full + np.bincount(layer, minlength=self.count)
        sums = self.sums + np.bincount(layer, self.elevation, minlength=self.count)
        averages: Floats = np.divide(sums, members, out=np.full(self.count, np.nan), where=members > 0)
        return averages

    def reassigned(self, averages: Floats) -> Integers:
        """Return the cheapest layers, shape (F,)."""
        layer = np.empty(len(self.rows), np.int64)
        for members in self.groups:
            if len(members):
                layer[members] = cheapest_layers(self.elevation[members], averages)
        return layer

    def cost(self, layer: Integers, averages: Floats) -> float:
        """Sum of squared differences to the averages, those without a choice included, m²."""
        away = self.sums - self.full * averages if self.full else np.zeros(self.count)
        fixed = self.scatter + float(np.square(away).sum()) / max(self.full, 1)
        return fixed + float(np.square(self.elevation - averages[layer]).sum())


def _by_elevation(stack: _Stack, count: int) -> Layering:
    """Reassign to the averages until nothing changes (5.3.3), then number layers by average elevation."""
    choice = _Choice.of(stack, count)
    layer = choice.ranks()
    averages = choice.averages(layer)
    costs: list[float] = []
    converged = False
    while not converged and len(costs) < MOST_ROUNDS:
        number = _ascending(averages)
        averages, layer = averages[np.argsort(number)], number[layer]
        closer = choice.reassigned(averages)
        costs.append(choice.cost(closer, averages))
        converged = bool(np.array_equal(closer, layer)) and _is_ascending(number)
        layer, averages = closer, choice.averages(closer)
    whole = stack.ranks()  # right for compartments that fill every layer
    whole[choice.rows] = layer
    number = _ascending(averages)
    return Layering(
        stack.spread(whole if _is_ascending(number) else number[whole]), count, tuple(costs), converged
    )


def _averages(elevation: Floats, layer: Integers, count: int) -> Floats:
    """Average elevation of each layer; NaN for an empty one."""
    assigned = layer >= 0
    if not assigned.all():
        elevation, layer = elevation[assigned], layer[assigned]
    members = np.bincount(layer, minlength=count)
    sums = np.bincount(layer, elevation, minlength=count)
    averages: Floats = np.divide(sums, members, out=np.full(count, np.nan), where=members > 0)
    return averages


def _ascending(averages: Floats) -> Integers:
    """Return the numbers of layers by ascending average, shape (count,): what *in order of height* needs."""
    number = np.empty(len(averages), np.int64)
    number[np.argsort(averages, kind="stable")] = np.arange(len(averages))
    return number


def _is_ascending(number: Integers) -> bool:
    return bool(np.array_equal(number, np.arange(len(number))))


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
