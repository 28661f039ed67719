"""Points of a scan evened out: one a small cube, the mean of those in it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Steps of a cube's side in which places are summed: whole numbers, so that no order matters.
STEPS = 1 << 12
#: Cubes along a side of the space that they are numbered in.
SIDE = 1 << 21


@dataclass
class Thinning:
    """Gathers points, some at a time.

    Attributes
    ----------
    side : float
        Of a cube, metres.
    """

    side: float
    _keys: list[Integers] = field(default_factory=list)
    _sums: list[Integers] = field(default_factory=list)

    def add(self, places: Floats) -> None:
        """Add points of shape (n, 3): metres from the lowest corner of all."""
        whole = np.rint(places * (STEPS / self.side)).astype(np.int64)
        cube = np.minimum(whole // STEPS, SIDE - 1)
        key = (cube[:, 2] * SIDE + cube[:, 1]) * SIDE + cube[:, 0]
        self._merge([key], [np.column_stack([whole - cube * STEPS, np.ones(len(whole), np.int64)])])

    def means(self) -> Floats:
        """Return the mean of each occupied cube, ordered by height, then north, then east; shape (n, 3)."""
        self._merge([], [])
        key, sums = self._keys[0], self._sums[0]
        cube = np.column_stack([key % SIDE, key // SIDE % SIDE, key // SIDE**2])
        means: Floats = (cube + sums[:, :3] / sums[:, 3:] / STEPS) * self.side
        return means

    def _merge(self, keys: list[Integers], sums: list[Integers]) -> None:
        """Keep one sum a cube."""
        empty = np.zeros(0, np.int64)
        every = np.concatenate([empty, *self._keys, *keys])
        parts = np.concatenate([np.zeros((0, 4), np.int64), *self._sums, *sums])
        order = np.argsort(every, kind="stable")
        every, parts = every[order], parts[order]
        first = np.flatnonzero(np.diff(every, prepend=-1))
        self._keys = [every[first]]
        self._sums = [np.add.reduceat(parts, first) if len(first) else parts]
