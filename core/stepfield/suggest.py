"""First values for cell size, tolerance and alpha, picked from the scan itself.

Cell size: the points are counted in small squares, then in squares twice, four times ... as wide. The size
at which an occupied square typically holds ``POINTS_A_COMPARTMENT`` points is rounded to 1, 2, 3 or 5 times
a power of ten, and kept so that the longer side has ``FEWEST_ALONG`` to ``MOST_ALONG`` compartments. The
median over squares, not over points, counts: the floor near the scanner must not decide for the room.

Tolerance: three cell sizes, for a surface as steep as a stair stays one pillar and a table stays apart from
the floor. At least a twentieth of the usual elevation range, for the lines a scanner draws on a wall are not
storeys; at most an eighth, so that storeys of a wide, coarse tile still part.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from stepfield.scan import Scan

POINTS_A_COMPARTMENT = 8
FEWEST_ALONG, MOST_ALONG = 32, 1024
TOLERANCE_IN_CELLS = 3.0
TOLERANCE_IN_RANGES = (1 / 20, 1 / 8)
#: Shares of the points between which the usual places lie: a stray bird must not widen them.
USUAL = (0.005, 0.995)
#: Points looked at to learn what is usual.
SAMPLE = 1_000_000


def cell_size(scan: Scan) -> float:
    """Side of a compartment, metres, that suits the density of the scan."""
    east, north = (axis.above_lowest() for axis in (scan.x, scan.y))
    (west, east_end), (south, north_end) = (_usual(side) for side in (east, north))
    longest = max(east_end - west, north_end - south)
    if longest <= 0:
        return 1.0
    square = longest / MOST_ALONG
    counts = _counts((east - west) / square, (north - south) / square)
    if not counts.any():  # so few points that none is usual
        return rounded(longest / FEWEST_ALONG)
    return rounded(min(_side_holding(POINTS_A_COMPARTMENT, counts) * square, longest / FEWEST_ALONG))


def layer_tolerance(scan: Scan, cell: float) -> float:
    """Vertical gap, metres, that parts two pillars."""
    low, high = _usual(scan.z.above_lowest())
    least, most = (share * (high - low) for share in TOLERANCE_IN_RANGES)
    wished = TOLERANCE_IN_CELLS * cell
    return rounded(min(max(wished, least), most) if most > 0 else wished)


def alpha(cell: float, elevation_range: float) -> float:
    """Distance of the base plane below the scan (Eq. 1), metres."""
    return max(cell / 2, elevation_range / 100)


def complex_residual(cell: float) -> float:
    """Distance of a compartment's points from its surface beyond which a mesh serves better, metres."""
    return cell / 4


def rounded(value: float) -> float:
    """Nearest of 1, 2, 3 or 5 times a power of ten, by ratio."""
    power = 10.0 ** math.floor(math.log10(value))
    nearest = min((1, 2, 3, 5, 10), key=lambda step: abs(math.log(value / (step * power))))
    return float(f"{nearest * power:.6g}")


def _usual(values: NDArray[np.float64]) -> tuple[float, float]:
    """Ends of where the values usually lie, or of all where that is a single place."""
    low, high = np.quantile(values[:: max(1, len(values) // SAMPLE)], USUAL)
    return (float(low), float(high)) if high > low else (0.0, float(values.max()))


def _counts(column: NDArray[np.float64], row: NDArray[np.float64]) -> NDArray[np.int64]:
    """Points in each of MOST_ALONG x MOST_ALONG squares; those outside count for none."""
    inside = (column >= 0) & (row >= 0) & (column < MOST_ALONG) & (row < MOST_ALONG)
    square = row[inside].astype(np.int64) * MOST_ALONG + column[inside].astype(np.int64)
    return np.bincount(square, minlength=MOST_ALONG**2).reshape(MOST_ALONG, MOST_ALONG)


def _side_holding(points: float, counts: NDArray[np.int64]) -> float:
    """Side, in squares, at which an occupied square typically holds that many points; at least 1."""
    side, held_before = 1.0, 0.0
    while True:
        held = float(np.median(counts[counts > 0]))
        if held >= points or len(counts) == 1:
            break
        side, held_before = side * 2, held
        counts = counts[::2] + counts[1::2]
        counts = counts[:, ::2] + counts[:, 1::2]
    if not 0 < held_before < held:
        return side
    # Between the last two sizes the count grows like a power of the side.
    back = math.log(max(held / points, 1.0)) / math.log(held / held_before)
    return side * math.pow(2.0, -back)
