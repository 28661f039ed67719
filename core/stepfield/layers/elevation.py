"""Classification by average elevation, the paper's (5.3.3).

From the order of creation pillars move to the layer whose average elevation they are close to, round after
round, until nothing changes. Here each round solves, for every compartment, the assignment exactly: pillars
in order of height, one to a layer, least sum of squared differences to the averages. Neither the
reassignment nor the new averages can raise that sum, so it ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.layering import Layering
from stepfield.layers.towers import Towers

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: The cost cannot cycle, but a huge step-field may creep; then the result says it has not converged.
MOST_ROUNDS = 100


def by_elevation(towers: Towers, count: int) -> Layering:
    """Reassign to the averages until nothing changes (5.3.3), then number layers by average elevation."""
    choice = _Choice.of(towers, count)
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
    whole = towers.ranks()  # right for compartments that fill every layer
    whole[choice.rows] = layer
    number = _ascending(averages)
    return Layering(
        towers.spread(whole if _is_ascending(number) else number[whole]), count, tuple(costs), converged
    )


@dataclass(frozen=True)
class _Choice:
    """The pillars that have a choice of layer, and what the others add to the averages.

    A compartment with as many pillars as there are layers has one in each, whatever the averages.
    """

    count: int  # layers
    rows: Integers  # (F,) which pillars of the towers have a choice
    elevation: Floats  # (F,)
    groups: tuple[Integers, ...]  # for sizes from 1 to count - 1: indices into rows, shape (m, size)
    full: int  # compartments without a choice
    sums: Floats  # (count,) elevations of their pillars in each layer, metres
    scatter: float  # of them around their own averages, m²

    @classmethod
    def of(cls, towers: Towers, count: int) -> _Choice:
        bottoms = [towers.bottom[towers.size == size] for size in range(1, count + 1)]
        *some, full = bottoms
        members = [bottom[:, np.newaxis] + np.arange(size) for size, bottom in enumerate(some, start=1)]
        ends = np.cumsum([0, *(part.size for part in members)])
        rows = np.concatenate([np.zeros(0, np.int64), *(part.ravel() for part in members)])
        fixed = [towers.elevation[full + layer] for layer in range(count)]
        return cls(
            count,
            rows,
            towers.elevation[rows],
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
