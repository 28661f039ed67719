"""The points of a scan, sorted by compartment and elevation: the one costly step, done once a cell size.

Elevations become whole *ticks* above the lowest point. For a LAS file a tick is its own scale, so its
integers pass through untouched; otherwise it is the power of two that spreads the elevation range over
31 bits (a nanometre for a room, under a micrometre for a mountain). Whole numbers make sums exact, so the
order of the points cannot matter, and let compartment and elevation share one 64-bit key to sort by.
"""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.parts import Parts, learnt_threshold, part
from stepfield.progress import Progress, silent
from stepfield.progress import part as share
from stepfield.scan import Axis, Scan
from stepfield.scan.cloud import CHUNK

TICK_BITS = 32
#: Tolerances finer than this share of the cell size are rare enough to cost a pass over the points.
FINEST_SHARE = 4
#: Points one thread takes at a time, in chunks that fit its cache.
BATCH = 16 * CHUNK
WORKERS = min(os.cpu_count() or 1, 8)


@dataclass(frozen=True)
class Compartments:
    """Sorted elevations of all points over one grid.

    Attributes
    ----------
    grid : Grid
    lowest : float
        Elevation of the lowest point (Z_min of Eq. 1), scan coordinates, metres.
    tick : float
        Metres in one tick.
    ticks : ndarray of shape (N,), uint32
        Elevations above ``lowest``, ascending within each compartment.
    occupied : ndarray of shape (C,), int64
        Numbers of the compartments that hold points, ascending.
    start : ndarray of shape (C + 1,), int64
        Where each occupied compartment's points begin in ``ticks``; the last entry is N.
    parts : Parts
        The points of each compartment parted at all but the finest gaps.
    """

    grid: Grid
    lowest: float
    tick: float
    ticks: NDArray[np.uint32]
    occupied: NDArray[np.int64]
    start: NDArray[np.int64]
    parts: Parts

    def parts_for(self, gap: int) -> Parts:
        """Parts fine enough to find every gap wider than ``gap`` ticks."""
        if gap >= self.parts.finest:
            return self.parts
        with ThreadPoolExecutor(WORKERS) as pool:
            return part(self.ticks, self.start, gap, pool)


def sort_into_compartments(scan: Scan, cell_size: float, progress: Progress = silent) -> Compartments:
    """Lay the grid under the scan (5.1) and sort its points by compartment, then elevation.

    Parameters
    ----------
    scan : Scan
        At least one point.
    cell_size : float
        Side of a compartment, metres.
    progress : Progress

    Raises
    ------
    GridError
        When the cell size makes an absurd number of compartments.
    """
    with ThreadPoolExecutor(WORKERS) as pool:
        list(pool.map(Axis.span, scan.axes))  # remembered by the axes
        grid, tick = grid_under(scan, cell_size), tick_of(scan.z)
        keys = _keys(scan, grid, tick, pool, share(progress, 0, 0.5))
        _sort(keys, pool, share(progress, 0.5, 0.9))
        ticks, first = _unpacked(keys, pool)
        start = np.append(first, len(keys))
        occupied = (keys[first] >> np.uint64(TICK_BITS)).astype(np.int64)
        del keys
        parts = part(ticks, start, learnt_threshold(ticks, start, cell_size / FINEST_SHARE / tick), pool)
    for array in (ticks, occupied, start):
        array.flags.writeable = False
    return Compartments(grid, scan.z.bounds()[0], tick, ticks, occupied, start, parts)


def grid_under(scan: Scan, cell_size: float) -> Grid:
    """Lay the grid that the scan bounds (5.1)."""
    west, south = scan.x.bounds()[0], scan.y.bounds()[0]
    return Grid.over(west, south, scan.x.span(), scan.y.span(), cell_size)


def tick_of(z: Axis) -> float:
    """Metres in one tick: the file's own step for integers, else a power of two that fits the range."""
    if z.raw.dtype.kind in "iu" and z.span() / abs(z.scale) < 2**TICK_BITS:
        return abs(z.scale)
    return 2.0 ** (math.frexp(max(z.span(), 1e-30))[1] - TICK_BITS + 1)


def _keys(
    scan: Scan, grid: Grid, tick: float, pool: ThreadPoolExecutor, progress: Progress
) -> NDArray[np.uint64]:
    """Pack each point's compartment (high bits) and elevation in ticks (low bits) into one key."""
    keys = np.empty(len(scan), np.uint64)
    east, north, up = (axis.measure() for axis in scan.axes)

    def fill(first: int) -> int:
        for at in range(first, min(first + BATCH, len(keys)), CHUNK):
            chunk = slice(at, at + CHUNK)
            key = grid.compartment(east(chunk), north(chunk)).astype(np.uint64)
            key <<= np.uint64(TICK_BITS)
            elevation = up(chunk)
            elevation /= tick
            np.rint(elevation, out=elevation)
            key |= elevation.astype(np.uint64)
            keys[chunk] = key
        return first

    for first in pool.map(fill, range(0, len(keys), BATCH)):
        progress(first / len(keys), "sorting points into compartments")
    return keys


def _sort(keys: NDArray[np.uint64], pool: ThreadPoolExecutor, progress: Progress) -> None:
    """Sort in place with all cores: halves that do not overlap can be sorted side by side."""
    progress(0.0, "sorting points into compartments")
    cuts = [len(keys) * i // WORKERS for i in range(WORKERS + 1)]
    if len(keys) > BATCH:
        keys.partition(cuts[1:-1])
        list(pool.map(lambda low, high: keys[low:high].sort(), cuts[:-1], cuts[1:]))
    else:
        keys.sort()
    progress(1.0, "sorting points into compartments")


def _unpacked(
    keys: NDArray[np.uint64], pool: ThreadPoolExecutor
) -> tuple[NDArray[np.uint32], NDArray[np.int64]]:
    """Elevations of sorted keys, and where each compartment's run begins."""
    ticks = np.empty(len(keys), np.uint32)

    def unpack(first: int) -> NDArray[np.int64]:
        found = []
        for at in range(first, min(first + BATCH, len(keys)), CHUNK):
            ticks[at : at + CHUNK] = keys[at : at + CHUNK]
            compartment = (keys[max(at - 1, 0) : at + CHUNK] >> np.uint64(TICK_BITS)).astype(np.uint32)
            found.append(np.flatnonzero(compartment[1:] != compartment[:-1]) + max(at, 1))
        return np.concatenate(found)

    starts = list(pool.map(unpack, range(0, len(keys), BATCH)))
    return ticks, np.concatenate([[0], *starts]).astype(np.int64)
