"""A route for a stack of which nothing is known: the longest straight way over what lies highest."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from stepfield.errors import SimulationError
from stepfield.simulate.ground import STEP, height_near, topmost
from stepfield.simulate.robot import HALF_LENGTH, HALF_WIDTH, WHEEL_RADIUS, Place
from stepfield.simulate.route import DROP, Command, Route
from stepfield.targets.terrain import Terrain

#: Metres a second, and the longest and shortest way that is chosen, metres.
SPEED, LONGEST, SHORTEST = 0.8, 20.0, 1.0
#: What a way may rise between compartments where that is more than a step, degrees.
SLOPE = 25.0


def longest_way(terrain: Terrain) -> Route:
    """Choose the longest straight way, eastwards or southwards, that is even enough for the robot.

    Raises
    ------
    SimulationError
        When there is none a metre long.
    """
    cell, top = terrain.cell_size, topmost(terrain)
    east, south = _longest(top, cell), _longest(top.T, cell)
    southward = south[2] > east[2]
    line, first, steps = south if southward else east
    length = min(steps * cell - 2 * HALF_LENGTH, LONGEST)
    if length < SHORTEST:
        raise SimulationError("no straight metre is even enough for the robot; give --start and --commands")
    along, across = first * cell + HALF_LENGTH, line * cell
    x, y = terrain.west + (across if southward else along), terrain.north - (along if southward else across)
    ground = height_near(terrain, x, y) or 0.0  # there is some: the way was chosen for it
    start = Place(x, y, ground + WHEEL_RADIUS + DROP, -90.0 if southward else 0.0)
    return Route(start, (Command(length / SPEED, SPEED, 0.0),))


def _longest(top: NDArray[np.float64], cell_size: float) -> tuple[int, int, int]:
    """Return row, first column and number of steps of the longest even band along the rows."""
    even = _even(top, cell_size)
    band = math.ceil(HALF_WIDTH / cell_size)
    best = (0, 0, 0)
    if len(even) <= 2 * band:
        return best
    wide = np.all(np.lib.stride_tricks.sliding_window_view(even, 2 * band + 1, axis=0), axis=-1)
    run = np.zeros(len(wide), np.int64)
    for column in range(even.shape[1]):
        run = np.where(wide[:, column], run + 1, 0)
        row = int(run.argmax())
        if run[row] > best[2]:
            best = (row + band, column + 1 - int(run[row]), int(run[row]))
    return best


def _even(top: NDArray[np.float64], cell_size: float) -> NDArray[np.bool_]:
    """Where neither the next column nor the next row is a step away, shape (rows - 1, columns - 1)."""
    step = max(STEP, math.tan(math.radians(SLOPE)) * cell_size)
    along, across = np.abs(np.diff(top, axis=1))[:-1], np.abs(np.diff(top, axis=0))[:, :-1]
    return np.asarray((along <= step) & (across <= step))  # NaN is never even
