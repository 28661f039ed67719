"""Where a reconstruction is off, and which way: the mean error of every pillar."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.compartments import WORKERS
from stepfield.fidelity.measure import BATCH, Measured
from stepfield.fidelity.reconstructions import Layers
from stepfield.grid import Grid
from stepfield.scan import Scan

Singles = NDArray[np.float32]
Integers = NDArray[np.int64]


def mean_errors(scan: Scan, measured: Measured, grid: Grid, layers: Layers) -> tuple[Singles, ...]:
    """Average how far the points of each pillar's compartment are above its layer's surface.

    A point belongs to the layer that is vertically nearest to it.

    Returns
    -------
    tuple of ndarray of shape (pillars of the layer,), float32, read-only
        Metres, positive where the points are above the surface; NaN where no point belongs to it.
    """
    where = _compartments(scan, grid)
    made = []
    for number, (compartment, _) in enumerate(layers):
        own = np.flatnonzero(measured.part == number)
        at = where[own]
        count = np.bincount(at, minlength=len(grid))[compartment]
        total = np.bincount(at, measured.up[own], minlength=len(grid))[compartment]
        mean = np.full(len(compartment), np.nan, np.float32)
        np.divide(total, count, out=mean, where=count > 0, casting="same_kind")
        mean.flags.writeable = False
        made.append(mean)
    return tuple(made)


def _compartments(scan: Scan, grid: Grid) -> NDArray[np.int32]:
    """Compartments of all points."""
    from concurrent.futures import ThreadPoolExecutor

    where = np.empty(len(scan), np.int32)

    def fill(first: int) -> None:
        batch = slice(first, first + BATCH)
        east, north = scan.x.values(batch) - grid.west, scan.y.values(batch) - grid.south
        where[batch] = grid.compartment(east, north)

    with ThreadPoolExecutor(WORKERS) as pool:
        list(pool.map(fill, range(0, len(scan), BATCH)))
    return where
