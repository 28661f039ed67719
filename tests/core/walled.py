"""A room whose every wall is known: a floor, a wall across it with a door, and a column."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Made for these: the wall stands in the middle of a column of compartments, the door spans five of them.
CELL, TOLERANCE = 0.2, 0.4
#: Places, metres: of the wall, of the door in it, of the column's middle; heights of wall, door, column.
WALL, DOOR, COLUMN = 3.1, (1.6, 2.6), (1.1, 1.1)
TOP, LINTEL, COLUMN_TOP = 2.5, 2.0, 1.5
_STEP = 0.05


def walled() -> Floats:
    """Return the points, shape (N, 3): 6 m by 4 m of floor at elevation 0."""
    floor = _sheet(np.arange(0, 6, _STEP), np.arange(0, 4, _STEP))
    floor = np.insert(floor, 2, 0.0, axis=1)
    y, z = _sheet(np.arange(0.025, 4, _STEP), np.arange(0, TOP + 0.001, _STEP)).T
    stands = (z >= LINTEL) | (y < DOOR[0]) | (y > DOOR[1])
    wall = np.column_stack([np.full(stands.sum(), WALL), y[stands], z[stands]])
    angle, height = _sheet(np.linspace(0, 2 * np.pi, 24), np.arange(0, COLUMN_TOP + 0.001, _STEP)).T
    column = np.column_stack([COLUMN[0] + 0.08 * np.cos(angle), COLUMN[1] + 0.08 * np.sin(angle), height])
    return np.concatenate([floor, wall, column])


def _sheet(u: Floats, v: Floats) -> Floats:
    return np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
