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
from stepfield.progress import Progress, silent
from stepfield.scan import Axis, Scan

#: Points handled at once by one thread: small enough for the processor's cache.
CHUNK = 1 << 18
TICK_BITS = 32


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
    """

    grid: Grid
    lowest: float
    tick: float
    ticks: NDArray[np.uint32]
    occupied: NDArray[np.int64]
    start: NDArray[np.int64]


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
    grid = grid_under(scan, cell_size)
    progress(0.0, "sorting points into compartments")
    tick = tick_of(scan.z)
    keys = _keys(scan, grid, tick, progress)
    progress(0.5, "sorting points into compartments")
    keys.sort()
    ticks = keys.astype(np.uint32)
    occupied, start = _runs(keys)
    for array in (ticks, occupied, start):
        array.flags.writeable = False
    return Compartments(grid, scan.z.bounds()[0], tick, ticks, occupied, start)


def grid_under(scan: Scan, cell_size: float) -> Grid:
    """Lay the grid that the scan bounds (5.1)."""
    west, south = scan.x.bounds()[0], scan.y.bounds()[0]
    return Grid.over(west, south, scan.x.span(), scan.y.span(), cell_size)


def tick_of(z: Axis) -> float:
    """Metres in one tick: the file's own step for integers, else a power of two that fits the range."""
    if z.raw.dtype.kind in "iu" and z.span() / abs(z.scale) < 2**TICK_BITS:
        return abs(z.scale)
    return 2.0 ** (math.frexp(max(z.span(), 1e-30))[1] - TICK_BITS + 1)


def _keys(scan: Scan, grid: Grid, tick: float, progress: Progress) -> NDArray[np.uint64]:
    """Pack each point's compartment (high bits) and elevation in ticks (low bits) into one key."""
    keys = np.empty(len(scan), np.uint64)
    east, north, up = scan.x.measure(), scan.y.measure(), scan.z.measure()

    def fill(first: int) -> int:
        part = slice(first, first + CHUNK)
        compartment = grid.compartment(east(part), north(part)).astype(np.uint64)
        keys[part] = compartment << np.uint64(TICK_BITS) | np.rint(up(part) / tick).astype(np.uint64)
        return first

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for first in pool.map(fill, range(0, len(keys), CHUNK)):
            progress(0.5 * first / len(keys), "sorting points into compartments")
    return keys


def _runs(keys: NDArray[np.uint64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Occupied compartments and where each one's run of sorted keys begins."""
    compartment = (keys >> np.uint64(TICK_BITS)).astype(np.uint32)
    first = np.flatnonzero(compartment[1:] != compartment[:-1]) + 1
    start = np.concatenate([[0], first, [len(keys)]]).astype(np.int64)
    return compartment[start[:-1]].astype(np.int64), start
