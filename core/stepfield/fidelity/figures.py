"""Distances in figures."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.fidelity.measure import Measured

Singles = NDArray[np.float32]


@dataclass(frozen=True)
class Distances:
    """Distances in four figures, metres; infinite where none is known.

    Attributes
    ----------
    rmse, median, p95, max : float
        Root of the mean square, middle one, the one that 95 % are within, greatest; of the distances that
        are finite.
    missing : int
        Points without a distance: no surface above or below, or none within reach.
    explained : float
        Share of all points, those without a distance included, that are within the tolerance.
    """

    rmse: float
    median: float
    p95: float
    max: float
    missing: int
    explained: float

    @classmethod
    def of(cls, distances: Singles, tolerance: float) -> Distances:
        """Summarise distances, shape (n,), not negative, infinite where unknown."""
        known = distances[np.isfinite(distances)]
        if not len(known):
            return cls(np.inf, np.inf, np.inf, np.inf, len(distances), 0.0)
        middle, high = _quantiles(known, (0.5, 0.95))
        return cls(
            rmse=float(np.sqrt(np.mean(np.square(known, dtype=np.float64)))),
            median=middle,
            p95=high,
            max=float(known.max()),
            missing=len(distances) - len(known),
            explained=float(np.count_nonzero(known <= tolerance) / len(distances)),
        )

    def as_dict(self) -> dict[str, float | None]:
        """Return the figures by name; None for those that nothing could tell, as JSON has no infinity."""
        return {name: value if np.isfinite(value) else None for name, value in asdict(self).items()}


@dataclass(frozen=True)
class Fidelity:
    """How true a reconstruction is to points.

    Attributes
    ----------
    points : int
        Points that were compared.
    of : int
        Points that there are: more than were compared when these are an even draw.
    tolerance : float
        Metres within which a point counts as explained.
    vertical : Distances
        Straight up or down to the surface.
    nearest : Distances
        To the nearest place of the surface, exact up to ``reach``.
    reach : float
        Metres; a point with no surface so near has the vertical distance, which is no less.
    """

    points: int
    of: int
    tolerance: float
    vertical: Distances
    nearest: Distances
    reach: float

    @classmethod
    def of_measured(cls, measured: Measured, of: int, tolerance: float, reach: float) -> Fidelity:
        """Summarise what was measured of some of the points."""
        vertical = Distances.of(np.abs(measured.up), tolerance)
        nearest = Distances.of(measured.nearest, tolerance)
        return cls(len(measured), of, tolerance, vertical, nearest, reach)

    @property
    def is_drawn(self) -> bool:
        """Whether only some of the points were compared."""
        return self.points < self.of

    @property
    def explained(self) -> float:
        """Share of the points that are vertically within the tolerance of the surface."""
        return self.vertical.explained

    def as_dict(self) -> dict[str, object]:
        """Return the figures by name, ready for JSON."""
        return {
            "points": self.points,
            "tolerance": self.tolerance if np.isfinite(self.tolerance) else None,
            "explained": self.explained,
            "vertical": self.vertical.as_dict(),
            "nearest": self.nearest.as_dict(),
            "nearest_reach": self.reach,
        }


def _quantiles(values: Singles, shares: tuple[float, ...]) -> list[float]:
    """Quantiles interpolated between the two nearest values; quicker than numpy's for many values."""
    places = [share * (len(values) - 1) for share in shares]
    below = [int(place) for place in places]
    wanted = sorted({*below, *(min(at + 1, len(values) - 1) for at in below)})
    parted = np.partition(values, wanted)
    ends = [(float(parted[at]), float(parted[min(at + 1, len(values) - 1)])) for at in below]
    return [
        low + (high - low) * (place - at) for (low, high), place, at in zip(ends, places, below, strict=True)
    ]
