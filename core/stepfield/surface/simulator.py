"""What a simulator draws from a layer's height-map (6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.surface.mesh import Mesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def as_simulator(grid: Grid, compartment: Integers, top: Floats) -> Mesh:
    """Surface a simulator draws from a height-map: a vertex a pixel, a quad where all four are occupied.

    This is where section 6 loses information: the sides are cut by half a compartment, holes grow, and a
    surface one pillar thin disappears.

    Parameters
    ----------
    grid : Grid
    compartment : ndarray of shape (P,)
        Ascending.
    top : ndarray of shape (P,)
        Elevations, metres.
    """
    quads = simulator_quads(grid, compartment)
    vertices = np.column_stack([grid.centres(compartment), top])
    used = np.zeros(len(compartment), bool)
    used[quads] = True
    number = np.cumsum(used) - 1
    return Mesh(vertices[used], number[quads[:, [0, 1, 2, 0, 2, 3]]].reshape(-1, 3))


def simulator_quads(grid: Grid, compartment: Integers) -> Integers:
    """Find four neighbouring compartments that are all occupied.

    Parameters
    ----------
    grid : Grid
    compartment : ndarray of shape (P,)
        Ascending.

    Returns
    -------
    ndarray of shape (Q, 4), int64
        Indices into ``compartment``, counter-clockwise seen from above, beginning in the north-west.
    """
    _, column = grid.row_column(compartment)
    north_west = np.flatnonzero(column < grid.columns - 1)
    steps = np.array([0, grid.columns, grid.columns + 1, 1])  # anticlockwise seen from above
    wanted = compartment[north_west, np.newaxis] + steps
    found = np.minimum(np.searchsorted(compartment, wanted), len(compartment) - 1)
    whole = (compartment[found] == wanted).all(axis=1) if len(compartment) else np.zeros(0, bool)
    quads: Integers = found[whole]
    return quads
