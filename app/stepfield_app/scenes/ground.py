"""The ground grid under a scene, and boxes drawn as lines."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepfield_app.render.scene import Lines
from stepfield_app.scenes.arrays import frozen
from stepfield_app.scenes.units import nice_step
from stepfield_app.theme import Theme, rgb

Floats = NDArray[np.float64]

#: Every so manieth line is a little stronger.
STRONGER = 5
#: Crosses at most: more would hide what they mark.
MOST_CROSSES = 20_000
#: Share of the theme's muted text colour in a stronger line.
STRENGTH = 0.35


def ground(low: ArrayLike, high: ArrayLike, theme: Theme, origin: ArrayLike = (0, 0, 0)) -> Lines:
    """Lay a grid under a box, at round coordinates and reaching a little beyond it.

    Parameters
    ----------
    low, high : array_like of shape (3,)
        The box in local coordinates, metres; the grid lies at its bottom.
    theme : Theme
    origin : array_like of shape (3,)
        So that lines lie at round scan coordinates; metres.
    """
    low, high, origin = (np.asarray(corner, np.float64) for corner in (low, high, origin))
    step = nice_step(float((high - low)[:2].max()))
    x, y = (_lines(low[i] + origin[i], high[i] + origin[i], step) for i in (0, 1))
    across, along = x * step - origin[0], y * step - origin[1]
    ends = np.empty((len(x) + len(y), 2, 3))
    ends[: len(x), :, 0], ends[: len(x), :, 1] = across[:, np.newaxis], along[[0, -1]]
    ends[len(x) :, :, 0], ends[len(x) :, :, 1] = across[[0, -1]], along[:, np.newaxis]
    ends[:, :, 2] = low[2]
    weak, muted = np.array(rgb(theme.line), float), np.array(rgb(theme.muted), float)
    strong = weak + STRENGTH * (muted - weak)
    marked = np.concatenate([x, y]) % STRONGER == 0
    colours = np.where(marked[:, np.newaxis], strong, weak)
    return Lines(frozen(ends.astype(np.float32)), frozen(np.rint(colours).astype(np.uint8)))


def crosses(places: ArrayLike, size: float, colour: str, most: int = MOST_CROSSES) -> Lines:
    """Mark places with crosses that show from every side.

    Parameters
    ----------
    places : array_like of shape (n, 3)
        Local coordinates, metres.
    size : float
        Length of an arm, metres.
    colour : str
        As #rrggbb.
    most : int
        Crosses at most; of more places an even part is marked.
    """
    points = np.asarray(places, np.float32).reshape(-1, 3)
    points = points[:: max(1, -(-len(points) // most))]
    arms = np.float32(size) * np.stack([-np.eye(3), np.eye(3)], axis=1).astype(np.float32)  # (axis, end, xyz)
    ends = (points[:, np.newaxis, np.newaxis] + arms).reshape(-1, 2, 3)
    return Lines(frozen(ends), frozen(np.tile(np.array(rgb(colour), np.uint8), (len(ends), 1))))


def _lines(low: float, high: float, step: float) -> Floats:
    """Whole multiples of ``step`` from the last one below ``low`` to the first above ``high``."""
    first = math.floor(low / step + 1e-9)
    return np.arange(first, max(math.ceil(high / step - 1e-9), first + 1) + 1, dtype=np.float64)
