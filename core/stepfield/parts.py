"""The finest parts of a scan's columns of points, so that a moved tolerance slider need not look at points.

Once, the sorted elevations are parted wherever a gap is wider than a fine threshold, learnt from the gaps
themselves so that parts are far fewer than points. Pillars of any wider tolerance are then runs of parts;
only a tolerance finer than the threshold goes back to the points.
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Ticks = NDArray[np.uint32]
Integers = NDArray[np.int64]

#: At most about one part in this many points.
POINTS_A_PART = 16
#: Gaps looked at to learn the threshold.
SAMPLE = 100_000
#: Points one thread takes at a time.
BATCH = 1 << 19
#: The gap noted below the lowest part of a compartment: wider than any other.
BOTTOM = np.uint64(2**33)


@dataclass(frozen=True)
class Parts:
    """Runs of sorted points without a gap wider than ``finest``.

    Attributes
    ----------
    finest : int
        Widest gap, in ticks, that does not part.
    start : ndarray of shape (F + 1,), int64
        Where each part's points begin; the last entry is the number of points.
    gap : ndarray of shape (F,), uint64
        Gap below each part in ticks; ``BOTTOM`` for the lowest of a compartment.
    below : ndarray of shape (F + 1,), uint64
        Sum of the ticks of all parts before each part; the last entry is the sum of all. Below 2^64 for
        four thousand million points.
    """

    finest: int
    start: Integers
    gap: NDArray[np.uint64]
    below: NDArray[np.uint64]

    def wider_than(self, gap: int) -> Integers:
        """Indices of the parts that begin a pillar when only gaps wider than ``gap`` ticks part."""
        return np.flatnonzero(self.gap > np.uint64(gap))


def learnt_threshold(ticks: Ticks, bottoms: Integers, widest: float) -> int:
    """Gap within a compartment that only about one in ``POINTS_A_PART`` exceeds, ``widest`` at most."""
    at = np.arange(1, len(ticks), max(1, len(ticks) // SAMPLE))
    within = at[bottoms[np.searchsorted(bottoms, at)] != at]
    if not len(within):
        return 0
    gaps, place = ticks[within] - ticks[within - 1], len(within) - 1 - len(within) // POINTS_A_PART
    return int(min(np.partition(gaps, place)[place], widest))


def part(ticks: Ticks, bottoms: Integers, finest: int, pool: Executor) -> Parts:
    """Part sorted elevations at every gap wider than ``finest``.

    Parameters
    ----------
    ticks : ndarray of shape (N,), uint32
        Ascending within each compartment.
    bottoms : ndarray of shape (C + 1,), int64
        Where each compartment's points begin; the last entry is N.
    finest : int
        Ticks.
    pool : Executor
        Threads to share the work.
    """

    def starts(first: int) -> Integers:
        batch = ticks[first : first + BATCH]
        parted = np.empty(len(batch), bool)
        parted[0] = first == 0 or int(batch[0]) - int(ticks[first - 1]) > finest
        np.greater(batch[1:] - batch[:-1], finest, out=parted[1:])
        inside = bottoms[slice(*np.searchsorted(bottoms, [first, first + len(batch)]))]
        parted[inside - first] = True  # where gaps wrap round from one compartment to the next
        return np.flatnonzero(parted) + first

    start = np.concatenate(list(pool.map(starts, range(0, len(ticks), BATCH))))
    gap = (ticks[start] - ticks[start - 1]).astype(np.uint64)
    gap[np.searchsorted(start, bottoms[:-1])] = BOTTOM
    cuts = [*range(0, len(start), BATCH // POINTS_A_PART), len(start)]
    ends = np.append(start, len(ticks))

    def sums(low: int, high: int) -> NDArray[np.uint64]:
        mine = ticks[ends[low] : ends[high]]
        return np.add.reduceat(mine, start[low:high] - start[low], dtype=np.uint64)

    below = np.cumsum(np.concatenate([[np.uint64(0)], *pool.map(sums, cuts[:-1], cuts[1:])]))
    return Parts(finest, ends, gap, below)
