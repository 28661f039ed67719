"""First values for cell size, tolerance and alpha, picked from the scan itself.

Cell size: the scan's plan is measured in small squares; the typical density of the occupied ones says how
large a compartment must be to hold about ``POINTS_A_COMPARTMENT`` points. Rounded to 1, 2, 3 or 5 times a
power of ten and kept so that the longer side has between ``FEWEST_ALONG`` and ``MOST_ALONG`` compartments.

Tolerance: three cell sizes, for a surface as steep as a stair stays one pillar and a table stays apart from
the floor; at most an eighth of the usual elevation range, so that storeys of a wide, coarse tile still part.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from stepfield.scan import Scan

POINTS_A_COMPARTMENT = 10
FEWEST_ALONG, MOST_ALONG = 32, 1024
TOLERANCE_IN_CELLS = 3.0
TOLERANCE_IN_RANGES = 1 / 8
#: Shares of the points between which the usual elevations lie: a stray bird must not widen them.
USUAL = (0.005, 0.995)
#: Points looked at: more would not change a value rounded so coarsely.
SAMPLE = 2_000_000
SQUARES_ALONG = 256


def cell_size(scan: Scan) -> float:
    """Side of a compartment, metres, that suits the density of the scan."""
    part = _sample(scan)
    east, north = scan.x.measure()(part), scan.y.measure()(part)
    longest = _usual_length(east, north)
    if longest == 0:
        return 1.0
    square = longest / SQUARES_ALONG
    held = _held(east, north, square)
    density = np.median(np.repeat(held, held)) * (len(scan) / len(east)) / square**2
    side = math.sqrt(POINTS_A_COMPARTMENT / density)
    return rounded(min(max(side, longest / MOST_ALONG), longest / FEWEST_ALONG))


def layer_tolerance(scan: Scan, cell: float) -> float:
    """Vertical gap, metres, that parts two pillars."""
    usual = np.quantile(scan.z.measure()(_sample(scan)), USUAL)
    reach = float(usual[1] - usual[0]) * TOLERANCE_IN_RANGES
    wished = TOLERANCE_IN_CELLS * cell
    return rounded(min(wished, reach) if reach > 0 else wished)


def alpha(cell: float, elevation_range: float) -> float:
    """Distance of the base plane below the scan (Eq. 1), metres."""
    return max(cell / 2, elevation_range / 100)


def rounded(value: float) -> float:
    """Nearest of 1, 2, 3 or 5 times a power of ten, by ratio."""
    power = 10.0 ** math.floor(math.log10(value))
    nearest = min((1, 2, 3, 5, 10), key=lambda step: abs(math.log(value / (step * power))))
    return float(f"{nearest * power:.6g}")


def _sample(scan: Scan) -> slice:
    return slice(None, None, max(1, len(scan) // SAMPLE))


def _usual_length(east: NDArray[np.float64], north: NDArray[np.float64]) -> float:
    """Longer side of the plan without the last half per cent of points at each end."""
    sides = [np.subtract(*np.quantile(side, USUAL[::-1])) for side in (east, north)]
    return float(max(sides)) or float(max(east.max(), north.max()))


def _held(east: NDArray[np.float64], north: NDArray[np.float64], square: float) -> NDArray[np.int64]:
    """Points in each occupied square of the plan."""
    column, row = (np.floor(side / square).astype(np.int64) for side in (east, north))
    return np.unique(row * (column.max() + 1) + column, return_counts=True)[1]
