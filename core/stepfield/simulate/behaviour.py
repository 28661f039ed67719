"""What a track says of the robot, and how two tracks of one route differ."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.simulate.drive import RATE, Track
from stepfield.simulate.route import SETTLING

Floats = NDArray[np.float64]

#: A robot told to go at least this fast is stuck, metres a second, ...
ASKED = 0.1
#: ... when within this many seconds it gets less than this share of the way.
PATIENCE, SHARE = 1.0, 0.1
#: Degrees of roll or pitch from which it lies on its back or side.
OVERTURNED = 80.0


@dataclass(frozen=True)
class Behaviour:
    """How a drive went.

    Attributes
    ----------
    seconds, distance : float
        Seconds driven, and metres gone in the plan.
    end : tuple of float
        Where the robot was last (x, y, z), metres.
    stuck : int
        How often it was stuck, ``stuck_seconds`` in all.
    greatest_pitch, greatest_roll : float
        Degrees, to either side.
    fell, overturned : bool
        Out of the world; onto its side or back.
    """

    seconds: float
    distance: float
    end: tuple[float, float, float]
    stuck: int
    stuck_seconds: float
    greatest_pitch: float
    greatest_roll: float
    fell: bool
    overturned: bool


@dataclass(frozen=True)
class Difference:
    """How a drive differs from another at equal times, as long as both lasted.

    Attributes
    ----------
    seconds : float
        Compared.
    path_rmse, path_max : float
        Distance in the plan, metres.
    height_rmse, height_max : float
        Metres.
    pitch_rmse, pitch_max, roll_rmse, roll_max : float
        Degrees.
    stuck : int
        How much more often it was stuck.
    """

    seconds: float
    path_rmse: float
    path_max: float
    height_rmse: float
    height_max: float
    pitch_rmse: float
    pitch_max: float
    roll_rmse: float
    roll_max: float
    stuck: int

    def as_dict(self) -> dict[str, Any]:
        """Return all by name."""
        return asdict(self)


def behaviour(track: Track) -> Behaviour:
    """Say how a drive went; what the robot did while it settled does not count."""
    kept = track.times > SETTLING
    positions = track.positions[kept] if kept.any() else track.positions[-1:]
    times, seconds = _stuck(track)
    pitch, roll = (float(np.abs(angle[kept]).max(initial=0)) for angle in (track.pitch, track.roll))
    return Behaviour(
        seconds=float(np.count_nonzero(kept)) / RATE,
        distance=float(np.linalg.norm(np.diff(positions[:, :2], axis=0), axis=1).sum()),
        end=(float(positions[-1, 0]), float(positions[-1, 1]), float(positions[-1, 2])),
        stuck=times,
        stuck_seconds=seconds,
        greatest_pitch=pitch,
        greatest_roll=roll,
        fell=track.fell,
        overturned=max(pitch, roll) > OVERTURNED and not track.fell,
    )


def difference(track: Track, other: Track) -> Difference:
    """Compare a drive with another of the same route."""
    count = min(len(track.times), len(other.times))
    kept = np.flatnonzero(track.times[:count] > SETTLING)
    ours, theirs = track.positions[kept], other.positions[kept]
    path = _ends(np.linalg.norm(ours[:, :2] - theirs[:, :2], axis=1))
    height = _ends(ours[:, 2] - theirs[:, 2])
    pitch, roll = (
        _ends(_turned(a[kept] - b[kept])) for a, b in ((track.pitch, other.pitch), (track.roll, other.roll))
    )
    more = _stuck(track)[0] - _stuck(other)[0]
    return Difference(len(kept) / RATE, *path, *height, *pitch, *roll, more)


def _ends(values: Floats) -> tuple[float, float]:
    """Root mean square and greatest size."""
    if not len(values):
        return 0.0, 0.0
    return float(np.sqrt(np.mean(values**2))), float(np.abs(values).max())


def _turned(angle: Floats) -> Floats:
    """Return differences of angles, the short way round."""
    return (angle + 180) % 360 - 180


def _stuck(track: Track) -> tuple[int, float]:
    """How often, and for how many seconds in all, the robot was told to go and did not."""
    window = round(PATIENCE * RATE)
    if len(track.times) <= window:
        return 0, 0.0
    gone = np.linalg.norm(track.positions[window:, :2] - track.positions[:-window, :2], axis=1)
    slowest = np.lib.stride_tricks.sliding_window_view(np.abs(track.speeds), window + 1).min(axis=-1)
    stuck = (slowest >= ASKED) & (gone < SHARE * slowest * PATIENCE)
    begins = int(np.count_nonzero(stuck[1:] & ~stuck[:-1])) + int(stuck[0])
    return begins, (np.count_nonzero(stuck) - begins) / RATE + PATIENCE * begins
