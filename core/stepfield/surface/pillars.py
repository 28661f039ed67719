"""The pillars of a layer as blocks (5.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.surface.mesh import Mesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def as_pillars(grid: Grid, compartment: Integers, top: Floats, base: float | Floats) -> Mesh:
    """Blocks from the base plane to each pillar's top (5.1): five faces, the base is never seen.

    Parameters
    ----------
    grid : Grid
    compartment : ndarray of shape (P,)
    top : ndarray of shape (P,)
        Elevations, metres.
    base : float or ndarray of shape (P,)
        Elevation of the base plane, or of each pillar's lower end, metres.
    """
    west, south, east, north = grid.squares(compartment).T
    corners = [(west, south), (east, south), (east, north), (west, north)]
    rings = [np.stack([x, y, z], -1) for z in (np.full_like(top, base), top) for x, y in corners]
    vertices = np.stack(rings, 1).reshape(-1, 3)
    quads = np.array([[4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
    block = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    triangles = (np.arange(len(top))[:, np.newaxis, np.newaxis] * 8 + block).reshape(-1, 3)
    return Mesh(vertices, triangles)
