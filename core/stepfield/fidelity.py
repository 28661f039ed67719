"""How true a stack is: every point of the scan against the nearest layer above or below it."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.scan import Scan

Floats = NDArray[np.float64]
#: Points handled at once; bounds the memory whatever the scan's size.
CHUNK = 1 << 20


@dataclass(frozen=True)
class Fidelity:
    """Vertical distances, metres, from the points of a scan to the nearest layer of their compartment.

    Attributes
    ----------
    points : int
        Points that lie in a compartment with at least one pillar; the others are ``outside``.
    rmse, median, p95, max : float
        Of the distances.
    explained : float
        Share of all points that lie within the tolerance of a layer.
    """

    points: int
    outside: int
    rmse: float
    median: float
    p95: float
    max: float
    explained: float

    def as_dict(self) -> dict[str, float]:
        """Return the figures by name."""
        return asdict(self)


def vertical(scan: Scan, grid: Grid, layers: Floats, tolerance: float) -> Fidelity:
    """Compare a scan with layers of elevations.

    Parameters
    ----------
    scan : Scan
    grid : Grid
    layers : ndarray of shape (L, rows, columns)
        Elevations in scan coordinates, metres; NaN in holes.
    tolerance : float
        Metres within which a point counts as explained.
    """
    flat = layers.reshape(len(layers), -1)
    parts = [
        _distances(scan, slice(start, start + CHUNK), grid, flat) for start in range(0, len(scan), CHUNK)
    ]
    distance = np.concatenate(parts)
    known = distance[np.isfinite(distance)]
    if not len(known):
        return Fidelity(0, len(scan), np.inf, np.inf, np.inf, np.inf, 0.0)
    return Fidelity(
        points=len(known),
        outside=len(distance) - len(known),
        rmse=float(np.sqrt(np.mean(np.square(known)))),
        median=float(np.median(known)),
        p95=float(np.quantile(known, 0.95)),
        max=float(known.max()),
        explained=float(np.count_nonzero(known <= tolerance) / len(distance)),
    )


def _distances(scan: Scan, part: slice, grid: Grid, flat: Floats) -> Floats:
    """Distance of each point of a part to its nearest layer; infinite where there is none."""
    east, north = scan.x.values(part) - grid.west, scan.y.values(part) - grid.south
    at = grid.compartment(east, north)
    z = scan.z.values(part)
    nearest = np.full(len(z), np.inf)
    for layer in flat:
        np.fmin(nearest, np.abs(z - layer[at]), out=nearest)
    side = grid.cell_size * 1e-6
    width, depth = grid.columns * grid.cell_size, grid.rows * grid.cell_size
    beyond = (east < -side) | (north < -side) | (east > width + side) | (north > depth + side)
    nearest[beyond] = np.inf
    return nearest
