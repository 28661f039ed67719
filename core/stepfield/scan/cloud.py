"""What a reader hands over: the points of one file, in the file's own unit and axes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from stepfield.progress import Progress, silent

Numbers = NDArray[Any]
Floats = NDArray[np.float64]


#: Points handled at once: small enough for the processor's cache.
CHUNK = 1 << 15
#: Greater numbers count as infinite: they are what damage makes of others, and their squares would be.
GREATEST = 1e150


@dataclass(frozen=True)
class Axis:
    """One coordinate of every point, kept as the file stores it so that nothing is rounded.

    The coordinate is ``raw * scale + offset``. LAS integers stay integers and float32 stays
    float32; arithmetic happens in float64 after the smallest raw value is subtracted.

    Attributes
    ----------
    raw : ndarray of shape (N,)
        Integers or floats; may be a strided view. All finite.
    scale, offset : float
        Of the file's unit until a :class:`~stepfield.scan.Scan` applies its unit factor.
    """

    raw: Numbers
    scale: float = 1.0
    offset: float = 0.0

    def __len__(self) -> int:
        return len(self.raw)

    def values(self, part: slice | Numbers = slice(None)) -> Floats:
        """Coordinates of the chosen points, float64."""
        return self.raw[part] * np.float64(self.scale) + self.offset

    @cached_property
    def _ends(self) -> Floats:
        """Smallest and greatest raw value; looked up once, as clouds are large and often strided."""
        chunks = (np.ascontiguousarray(self.raw[at : at + CHUNK]) for at in range(0, len(self.raw), CHUNK))
        lows, highs = zip(*((chunk.min(), chunk.max()) for chunk in chunks), strict=True)
        with np.errstate(invalid="ignore"):  # a NaN of the signalling kind, which only damage makes
            return np.array([np.min(lows), np.max(highs)], np.float64)

    @property
    def is_finite(self) -> bool:
        """Whether no value is NaN, infinite or near it: each would show in the smallest or the greatest."""
        return not len(self) or bool((np.abs(self._ends) <= GREATEST).all())

    def bounds(self) -> tuple[float, float]:
        """Smallest and greatest coordinate; the points must be at least one."""
        ends = self._ends * self.scale + self.offset
        return float(ends.min()), float(ends.max())

    def span(self) -> float:
        """Distance between the smallest and the greatest coordinate, exact for stored integers."""
        return float((self._ends[1] - self._ends[0]) * abs(self.scale))

    def measure(self) -> Callable[[slice | Numbers], Floats]:
        """Return a function of points giving their distances from the smallest coordinate of all.

        The smallest raw value is subtracted before anything is scaled or rounded: for the stored
        integers of a LAS file the result is the same wherever the file places its offset.
        """
        base = self._ends[0 if self.scale > 0 else 1]

        def distances(part: slice | Numbers) -> Floats:
            distance = self.raw[part].astype(np.float64)
            distance -= base
            if self.scale != 1:
                distance *= self.scale
            return distance

        return distances

    def above_lowest(self) -> Floats:
        """Distances of all points from the smallest coordinate."""
        return self.measure()(slice(None))

    def take(self, keep: Numbers) -> Axis:
        """The coordinates of the points that ``keep`` (a mask or indices) chooses."""
        return Axis(self.raw[keep], self.scale, self.offset)


@dataclass(frozen=True)
class Cloud:
    """The finite points of one file, with the attributes this program has a use for.

    Attributes
    ----------
    axes : tuple of three Axis
        x, y, z as the file names them, in the file's unit.
    attributes : mapping
        Any of ``rgb`` (N, 3) uint8, ``intensity`` (N,) and ``classification`` (N,) uint8.
    unit : str or None
        The unit the file declares (``m``, ``cm``, ``mm``, ``ft``, ``us-ft``), if it does.
    crs : str or None
        Well-known text (WKT) of the coordinate reference system, if the file carries one.
    not_finite : int
        Points dropped because a coordinate was NaN, infinite or beyond :data:`GREATEST`.
    organised : bool
        True for a depth-camera frame (a full image of points), whose up axis is rarely z.
    warnings : tuple of str
        What the reader noticed and the operator should know, one sentence each.
    """

    axes: tuple[Axis, Axis, Axis]
    attributes: Mapping[str, Numbers] = field(default_factory=dict)
    unit: str | None = None
    crs: str | None = None
    not_finite: int = 0
    organised: bool = False
    warnings: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.axes[0])


class Reader(Protocol):
    """What every format module offers as ``read``."""

    def __call__(self, path: Path, progress: Progress = silent) -> Cloud:
        """Read a file, raising ScanError in one sentence; formats read at one go report no progress."""


def finite_cloud(
    coordinates: tuple[Numbers, Numbers, Numbers],
    attributes: Mapping[str, Numbers] | None = None,
    **facts: Any,
) -> Cloud:
    """Make a Cloud of float or integer columns, dropping and counting points that are not finite."""
    attributes = dict(attributes or {})
    x, y, z = (Axis(column) for column in coordinates)
    if x.is_finite and y.is_finite and z.is_finite:
        return Cloud((x, y, z), attributes, **facts)
    with np.errstate(invalid="ignore"):  # as above
        keep = np.logical_and.reduce([np.abs(column) <= np.float64(GREATEST) for column in coordinates])
    attributes = {name: values[keep] for name, values in attributes.items()}
    dropped = int(len(keep) - np.count_nonzero(keep))
    return Cloud((x.take(keep), y.take(keep), z.take(keep)), attributes, not_finite=dropped, **facts)
