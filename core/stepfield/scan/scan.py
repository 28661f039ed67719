"""The scan: the points of one or more files, in metres with z up, as exact as the files were."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stepfield.files import Digest
from stepfield.parameters import METRES, Unit, Up
from stepfield.scan.cloud import Axis, Cloud, Floats, Numbers

#: For each up axis, which file axis and sign become x, y and z; all are proper rotations.
_TURNS: dict[Up, tuple[tuple[int, int], tuple[int, int], tuple[int, int]]] = {
    "z": ((0, 1), (1, 1), (2, 1)),
    "-z": ((0, 1), (1, -1), (2, -1)),
    "y": ((0, 1), (2, -1), (1, 1)),
    "-y": ((0, 1), (2, 1), (1, -1)),
    "x": ((2, -1), (1, 1), (0, 1)),
    "-x": ((2, 1), (1, 1), (0, -1)),
}


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file the scan came from: its name without folders, its finite points and its digest."""

    name: str
    points: int
    digest: Digest

    @property
    def sha256(self) -> str:
        """SHA-256 of the file in hexadecimal digits."""
        return self.digest.hexdigest()


@dataclass(frozen=True)
class Scan:
    """Points in metres, z up.

    Attributes
    ----------
    x, y, z : Axis
        Coordinates of the N points, exact as in the file.
    attributes : mapping
        Any of ``rgb`` (N, 3) uint8, ``intensity`` (N,), ``classification`` (N,) uint8.
    files : tuple of SourceFile
    unit : str
        The unit of the files' coordinates; ``unit_factor`` is metres in one of it.
    up : str
        The files' axis that points up.
    crs : str or None
        Well-known text (WKT) of the coordinate reference system.
    removed : mapping of str to int
        Points dropped so far, by reason.
    warnings : tuple of str
    """

    x: Axis
    y: Axis
    z: Axis
    attributes: Mapping[str, Numbers] = field(default_factory=dict)
    files: tuple[SourceFile, ...] = ()
    unit: Unit = "m"
    up: Up = "z"
    crs: str | None = None
    organised: bool = False
    removed: Mapping[str, int] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.z)

    @property
    def axes(self) -> tuple[Axis, Axis, Axis]:
        """x, y and z."""
        return self.x, self.y, self.z

    @property
    def unit_factor(self) -> float:
        """Metres in one unit of the files."""
        return METRES[self.unit]

    def points(self, part: slice | Numbers = slice(None)) -> Floats:
        """Return the chosen points as an array of shape (n, 3), metres, float64."""
        return np.column_stack([axis.values(part) for axis in self.axes])

    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest x, y, z in metres."""
        low, high = zip(*(axis.bounds() for axis in self.axes), strict=True)
        return np.array(low), np.array(high)

    def keep(self, mask: Numbers, reason: str) -> Scan:
        """Return the scan without the points where ``mask`` is False, counted under ``reason``."""
        dropped = int(len(mask) - np.count_nonzero(mask))
        removed = {**self.removed, reason: self.removed.get(reason, 0) + dropped}
        if not dropped:
            return replace(self, removed=removed)
        chosen = np.flatnonzero(mask)
        x, y, z = (axis.take(chosen) for axis in self.axes)
        attributes = {name: values[chosen] for name, values in self.attributes.items()}
        return replace(self, x=x, y=y, z=z, attributes=attributes, removed=removed)

    def thinned(self, most: int) -> Scan:
        """Return the scan with about ``most`` points, evenly chosen, its outermost ones among them.

        One point is drawn from each of ``most`` runs of equal length: a fixed step would take the same rows
        of every sweep of a scanner. The draw is the same every time.
        """
        if most >= len(self):
            return self
        drawn = (np.arange(most) + np.random.default_rng(0).random(most)) * (len(self) / most)
        outermost = [find(axis.raw) for axis in self.axes for find in (np.argmin, np.argmax)]
        chosen = np.sort(np.append(np.minimum(drawn.astype(np.int64), len(self) - 1), outermost))
        chosen = chosen[np.diff(chosen, prepend=-1) > 0]
        x, y, z = (axis.take(chosen) for axis in self.axes)
        attributes = {name: values[chosen] for name, values in self.attributes.items()}
        return replace(self, x=x, y=y, z=z, attributes=attributes)


def joined(clouds: Sequence[Cloud], files: Sequence[SourceFile], unit: Unit | None, up: Up) -> Scan:
    """Make one scan of several clouds.

    Parameters
    ----------
    clouds : sequence of Cloud
        At least one. Their units may differ when each declares its own.
    files : sequence of SourceFile
        Where each came from.
    unit : str or None
        Overrides what the files declare; None takes their word, or metres.
    up : str
        The files' axis that points up.
    """
    units: list[Unit] = [unit or _declared(cloud) for cloud in clouds]
    parts = [_turned(cloud, METRES[u], up) for cloud, u in zip(clouds, units, strict=True)]
    x, y, z = (_concatenated([part[i] for part in parts]) for i in range(3))
    return Scan(
        x=x,
        y=y,
        z=z,
        attributes=_common_attributes(clouds),
        files=tuple(files),
        unit=units[0],
        up=up,
        crs=next((cloud.crs for cloud in clouds if cloud.crs), None),
        organised=all(cloud.organised for cloud in clouds),
        removed={"not finite": sum(cloud.not_finite for cloud in clouds)},
        warnings=tuple(warning for cloud in clouds for warning in cloud.warnings) + _disagreements(clouds),
    )


def _declared(cloud: Cloud) -> Unit:
    return cloud.unit if cloud.unit in METRES else "m"


def _turned(cloud: Cloud, factor: float, up: Up) -> list[Axis]:
    """Turn the up axis to z and scale to metres: only the affine part of each axis changes."""
    axes = [(cloud.axes[source], sign * factor) for source, sign in _TURNS[up]]
    return [Axis(axis.raw, axis.scale * gain, axis.offset * gain) for axis, gain in axes]


def _concatenated(axes: Sequence[Axis]) -> Axis:
    """Join one coordinate of several files, as integers where they share one scale and offset."""
    first = axes[0]
    if len(axes) == 1:
        return first
    if all((a.scale, a.offset, a.raw.dtype) == (first.scale, first.offset, first.raw.dtype) for a in axes):
        return Axis(np.concatenate([axis.raw for axis in axes]), first.scale, first.offset)
    return Axis(np.concatenate([axis.values() for axis in axes]))


def _common_attributes(clouds: Sequence[Cloud]) -> dict[str, Numbers]:
    """Join the attributes that every file has."""
    names = [name for name in clouds[0].attributes if all(name in cloud.attributes for cloud in clouds)]
    if len(clouds) == 1:
        return dict(clouds[0].attributes)
    return {name: np.concatenate([cloud.attributes[name] for cloud in clouds]) for name in names}


def _disagreements(clouds: Sequence[Cloud]) -> tuple[str, ...]:
    """Warn when the files name different reference systems: they may not lie side by side."""
    if len({cloud.crs for cloud in clouds if cloud.crs}) > 1:
        return ("the scans name different coordinate reference systems; their places may not agree",)
    return ()
