"""What of a stack a robot may stand on."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from stepfield.simulate.robot import WHEEL_RADIUS
from stepfield.targets.terrain import Terrain

#: A step that the robot takes, metres.
STEP = 0.5 * WHEEL_RADIUS


def topmost(terrain: Terrain) -> NDArray[np.float64]:
    """Elevation of whatever lies highest, shape (rows, columns), NaN where nothing does."""
    top = np.full((terrain.rows, terrain.columns), np.nan)
    for layer in terrain.layers:
        top = np.fmax(top, layer.elevations)
    return top


def height_near(terrain: Terrain, x: float, y: float, below: float = math.inf) -> float | None:
    """Elevation of the highest of the samples around a place that is not a step above ``below``."""
    row, column = (terrain.north - y) / terrain.cell_size, (x - terrain.west) / terrain.cell_size
    if not (-1 < row < terrain.rows and -1 < column < terrain.columns):
        return None
    rows, columns = (slice(math.floor(max(0, at)), math.ceil(at) + 1) for at in (row, column))
    around = np.concatenate([layer.elevations[rows, columns].ravel() for layer in terrain.layers])
    found = around[around <= below + STEP]  # NaN is not
    return float(found.max()) if found.size else None
