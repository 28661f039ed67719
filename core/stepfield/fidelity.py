"""How true a stack is: every point of the scan against the nearest layer above or below it."""

from __future__ import annotations

from collections.abc import Iterable
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

    def as_dict(self) -> dict[str, float | None]:
        """Return the figures by name; None for those that no point could tell, as JSON has no infinity."""
        return {name: value if np.isfinite(value) else None for name, value in asdict(self).items()}


def vertical(scan: Scan, grid: Grid, layers: Iterable[Floats], tolerance: float) -> Fidelity:
    """Compare a scan with layers of elevations.

    Parameters
    ----------
    scan : Scan
    grid : Grid
    layers : iterable of ndarray of shape (rows, columns)
        Elevations in scan coordinates, metres; NaN in holes. Taken one at a time.
    tolerance : float
        Metres within which a point counts as explained.
    """
    distance = np.full(len(scan), np.inf)
    for layer in layers:
        for start in range(0, len(scan), CHUNK):
            part = slice(start, start + CHUNK)
            np.fmin(distance[part], _distances(scan, part, grid, layer), out=distance[part])
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


def _distances(scan: Scan, part: slice, grid: Grid, layer: Floats) -> Floats:
    """Vertical distance of each point of a part to a layer; NaN where there is a hole or no grid."""
    east, north = scan.x.values(part) - grid.west, scan.y.values(part) - grid.south
    distance: Floats = np.abs(scan.z.values(part) - layer.ravel()[grid.compartment(east, north)])
    slack = grid.cell_size * 1e-6
    width, depth = grid.columns * grid.cell_size, grid.rows * grid.cell_size
    distance[(east < -slack) | (north < -slack) | (east > width + slack) | (north > depth + slack)] = np.nan
    return distance
