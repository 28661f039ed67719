"""Layers as triangle meshes: the pillars themselves, and what a simulator draws from a height-map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Mesh:
    """Triangles in scan coordinates, counter-clockwise seen from outside.

    Attributes
    ----------
    vertices : ndarray of shape (V, 3), float64
        Metres.
    triangles : ndarray of shape (T, 3), int64
    """

    vertices: Floats
    triangles: Integers

    @property
    def plan_area(self) -> float:
        """Area the upward triangles cover in the plan, square metres."""
        a, b, c = (self.vertices[self.triangles[:, i], :2] for i in range(3))
        doubled = np.cross(np.c_[b - a, np.zeros(len(a))], np.c_[c - a, np.zeros(len(a))])[:, 2]
        return float(doubled[doubled > 0].sum() / 2)


def as_pillars(grid: Grid, compartment: Integers, top: Floats, base: float) -> Mesh:
    """Blocks from the base plane to each pillar's top (5.1): five faces, the base is never seen.

    Parameters
    ----------
    grid : Grid
    compartment : ndarray of shape (P,)
    top : ndarray of shape (P,)
        Elevations, metres.
    base : float
        Elevation of the base plane, metres.
    """
    west, south, east, north = grid.squares(compartment).T
    corners = [(west, south), (east, south), (east, north), (west, north)]
    rings = [np.stack([x, y, z], -1) for z in (np.full_like(top, base), top) for x, y in corners]
    vertices = np.stack(rings, 1).reshape(-1, 3)
    quads = np.array([[4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
    block = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    triangles = (np.arange(len(top))[:, np.newaxis, np.newaxis] * 8 + block).reshape(-1, 3)
    return Mesh(vertices, triangles)


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
    _, column = grid.row_column(compartment)
    north_west = np.flatnonzero(column < grid.columns - 1)
    steps = np.array([0, grid.columns, grid.columns + 1, 1])  # anticlockwise seen from above
    wanted = compartment[north_west, np.newaxis] + steps
    found = np.minimum(np.searchsorted(compartment, wanted), len(compartment) - 1)
    whole = (compartment[found] == wanted).all(axis=1) if len(compartment) else np.zeros(0, bool)
    quads = found[whole]
    vertices = np.column_stack([grid.centres(compartment), top])
    used = np.zeros(len(compartment), bool)
    used[quads] = True
    number = np.cumsum(used) - 1
    return Mesh(vertices[used], number[quads[:, [0, 1, 2, 0, 2, 3]]].reshape(-1, 3))
