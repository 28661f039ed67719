"""Points against a surface: all of them, or an even draw, a batch of points a thread."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.compartments import WORKERS
from stepfield.fidelity.surface import Surface
from stepfield.progress import Progress, silent
from stepfield.scan import Scan

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Integers = NDArray[np.int64]
#: Coordinates of a slice of points: x, y, z, metres.
Places = Callable[[slice], tuple[Floats, Floats, Floats]]

#: Points one thread takes at a time: sorted by their squares, they find their triangles in the cache.
BATCH = 1 << 18
#: Points whose pairs are looked at at once: what they need stays in the cache.
BLOCK = 1 << 13


@dataclass(frozen=True, eq=False)
class Measured:
    """Distances of points, in their order; read-only.

    Attributes
    ----------
    up : ndarray of shape (n,), float32
        How far each point is above what of the surface is vertically nearest, metres, negative below;
        infinite where there is none at its place.
    nearest : ndarray of shape (n,), float32
        Distance from the nearest place of the surface; infinite where none was found.
    part : ndarray of shape (n,), int16
        Which layer ``up`` is from; -1 for none.
    """

    up: Singles
    nearest: Singles
    part: NDArray[np.int16]

    def __len__(self) -> int:
        return len(self.up)


def measure(points: Scan | Floats, surface: Surface, progress: Progress = silent) -> Measured:
    """Measure how far points are from a surface.

    Parameters
    ----------
    points : Scan or ndarray of shape (n, 3)
        Scan coordinates, metres.
    surface : Surface
    progress : Progress
        Called between batches; may raise Cancelled.
    """
    count = len(points)
    up, nearest, part = np.empty(count, np.float32), np.empty(count, np.float32), np.empty(count, np.int16)
    places = _places(points, surface.origin)

    def fill(first: int) -> int:
        batch = slice(first, first + BATCH)
        up[batch], nearest[batch], part[batch] = _batch(surface, *places(batch))
        return min(first + BATCH, count)

    with ThreadPoolExecutor(WORKERS) as pool:
        progress(0.0, "comparing with the scan")
        try:
            for done in pool.map(fill, range(0, count, BATCH)):
                progress(done / count, "comparing with the scan")
        finally:
            pool.shutdown(cancel_futures=True)  # when stopped, nobody waits for the other batches
    for array in (up, nearest, part):
        array.flags.writeable = False
    return Measured(up, nearest, part)


def _places(points: Scan | Floats, origin: Floats) -> Places:
    """Return a function of a slice giving local coordinates."""
    if isinstance(points, Scan):
        x, y, z = (axis.values for axis in points.axes)
        return lambda batch: (x(batch) - origin[0], y(batch) - origin[1], z(batch) - origin[2])
    array = points
    return lambda batch: _columns(array[batch] - origin)


def _columns(array: Floats) -> tuple[Floats, Floats, Floats]:
    x, y, z = array.T.copy()
    return x, y, z


def _batch(surface: Surface, x: Floats, y: Floats, z: Floats) -> tuple[Floats, Floats, Integers]:
    """Measure some points, those of a square after each other."""
    key = surface.buckets.grid.compartment(x, y) << 32
    key |= np.arange(len(x))
    key.sort()
    order = key & 0xFFFFFFFF
    up, nearest, part = np.empty(len(x)), np.empty(len(x)), np.empty(len(x), np.int64)
    for first in range(0, len(x), BLOCK):
        chosen = order[first : first + BLOCK]
        place = x[chosen], y[chosen], z[chosen]
        up[chosen], part[chosen] = above, _ = surface.above(*place)
        nearest[chosen] = surface.nearest(*place, np.abs(above))
    return up, nearest, part
