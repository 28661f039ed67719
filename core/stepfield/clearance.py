"""How much room there is above each pillar: whether a robot on one layer fits under the next one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import UNASSIGNED
from stepfield.pillars import StepField
from stepfield.reconstruction import Layer, Reconstruction

Floats = NDArray[np.float64]

#: Levels of a clearance image besides 0, which is for nothing above and for holes.
LEVELS = 65535


@dataclass(frozen=True, eq=False)
class ClearanceMap:
    """The room above a layer as an image.

    Attributes
    ----------
    gray : ndarray of shape (height, width), uint16
        Clearance = scale * gray, metres, and up to a level more; 0 where nothing is above, and in holes.
    scale : float
        Metres in one level.
    least, greatest : float or None
        Where something is above, metres.
    """

    gray: NDArray[np.uint16]
    scale: float
    least: float | None
    greatest: float | None


def clearance(field: StepField, layer: NDArray[np.int64]) -> Floats:
    """Measure from each exported pillar's top up to the lowest point of the next one in its compartment.

    Parameters
    ----------
    field : StepField
    layer : ndarray of shape (P,), int64
        Layer of each pillar; those in none are neither stood on nor in the way.

    Returns
    -------
    ndarray of shape (P,), float64, read-only
        Metres, at least 0; infinite where nothing is above, NaN for pillars in no layer.
    """
    chosen = np.flatnonzero(layer != UNASSIGNED)
    room = np.full(len(field), np.nan)
    room[chosen] = np.inf
    below = np.flatnonzero(np.diff(field.compartment[chosen]) == 0)
    lower, upper = chosen[below], chosen[below + 1]
    room[lower] = np.maximum(field.lows(upper) - field.elevation[lower], 0)
    room.flags.writeable = False
    return room


def draw_clearance(result: Reconstruction, layer: Layer, room: Floats) -> ClearanceMap:
    """Draw the room above a layer.

    Levels are rounded down, so that a robot that fits by the map fits: a clearance is at least what is drawn.

    Parameters
    ----------
    result : Reconstruction
    layer : Layer
    room : ndarray of shape (P,)
        As :func:`clearance` returns it.
    """
    bounded = room[np.isfinite(room)]
    scale = (float(bounded.max(initial=0.0)) or 1.0) / LEVELS  # one for all layers
    own = room[layer.pillars]
    limited = np.isfinite(own)
    level = np.zeros(len(own), np.uint16)
    level[limited] = np.clip(np.floor(own[limited] / scale * (1 + 1e-12)), 1, LEVELS).astype(np.uint16)
    frame, grid = result.frame, result.field.compartments.grid
    row, column = grid.row_column(result.field.compartment[layer.pillars])
    gray = np.zeros((frame.height, frame.width), np.uint16)
    gray[row + frame.row, column + frame.column] = level
    least, greatest = (float(f(own[limited])) if limited.any() else None for f in (np.min, np.max))
    return ClearanceMap(gray, scale, least, greatest)
