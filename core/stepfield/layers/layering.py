"""Which layer each pillar belongs to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

UNASSIGNED = -1


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

    def seams(self, links: Integers) -> Integers:
        """Return the links (L, 2) whose two pillars are in different layers, shape (S, 2).

        A surface that ends at an obstacle is not cut there: the obstacle is as high.
        """
        one, other = self.layer[links[:, 0]], self.layer[links[:, 1]]
        is_cut = (one != other) & (one >= 0) & (other >= 0)
        if self.obstacles:
            is_cut &= ~np.isin(one, self.obstacles) & ~np.isin(other, self.obstacles)
        cut: Integers = links[is_cut]
        return cut

    def averages(self, elevation: Floats) -> Floats:
        """Average elevation of each layer, shape (count,); NaN for a layer without pillars."""
        return averages(elevation, self.layer, self.count)


def averages(elevation: Floats, layer: Integers, count: int) -> Floats:
    """Average elevation of each layer; NaN for an empty one."""
    assigned = layer >= 0
    if not assigned.all():
        elevation, layer = elevation[assigned], layer[assigned]
    members = np.bincount(layer, minlength=count)
    sums = np.bincount(layer, elevation, minlength=count)
    averages: Floats = np.divide(sums, members, out=np.full(count, np.nan), where=members > 0)
    return averages
