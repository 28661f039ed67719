"""The surface over exactly the compartments of a layer's pillars: nothing cut, nothing vanishes (6)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.surface.corners import NORTH_EAST, NORTH_WEST, SOUTH_EAST, SOUTH_WEST
from stepfield.surface.mesh import Mesh
from stepfield.surface.sheets import Sheet, sheets

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Which of its lines a compartment's corners are on: north-west, south-west, south-east, north-east.
_EAST, _NORTH = np.array([0, 0, 1, 1]), np.array([1, 0, 0, 1])


def as_edges(grid: Grid, layers: Sequence[tuple[Integers, Floats]], link_step: float) -> list[Mesh]:
    """Cover exactly the compartments of each layer's pillars.

    Every compartment is four triangles around its middle, which has the elevation of the pillar. Steps
    within a layer are closed by vertical triangles; where two layers continue each other, they meet in the
    very same places.

    Parameters
    ----------
    grid : Grid
    layers : sequence of tuple of ndarray
        Compartments, ascending, and elevations (metres) of each layer's pillars; all layers of a
        step-field together, as they decide what continues what.
    link_step : float
        Greatest difference in elevation of two neighbours that continue each other, metres.

    Returns
    -------
    list of Mesh
        One a layer, in the coordinates of the grid.
    """
    return [mesh_of(sheet) for sheet in sheets(grid, layers, link_step)]


def mesh_of(sheet: Sheet) -> Mesh:
    """Return a sheet as triangles: the compartments in order, then the risers."""
    vertices, number = vertices_of(sheet)
    fans = fans_of(sheet, number, np.arange(len(sheet.compartment)))
    return Mesh(vertices, np.concatenate([fans, risers_of(sheet, number)]))


def vertices_of(sheet: Sheet) -> tuple[Floats, Integers]:
    """Return the places of a sheet's corners, then of the middles of its compartments.

    Returns
    -------
    ndarray of shape (V + n, 3)
        Metres.
    ndarray of shape (n, 4)
        Numbers of the corners of each compartment.
    """
    number, first = _numbered(sheet.vertex)
    x, y = sheet.grid.lines(sheet.compartment)
    pillar, corner = np.divmod(first, 4)
    vertices = np.empty((len(first) + len(sheet.top), 3))
    corners, middles = vertices[: len(first)], vertices[len(first) :]
    corners[:, 0], corners[:, 1] = x[pillar, _EAST[corner]], y[pillar, _NORTH[corner]]
    corners[:, 2] = sheet.corner.ravel()[first]
    middles[:, 0], middles[:, 1] = (x[:, 0] + x[:, 1]) / 2, (y[:, 0] + y[:, 1]) / 2
    middles[:, 2] = sheet.top
    return vertices, number


def fans_of(sheet: Sheet, number: Integers, pillars: Integers) -> Integers:
    """Return four triangles each around the middles of some pillars, which are numbered after the corners."""
    fans = np.empty((len(pillars), 4, 3), np.int64)
    fans[:, :, 0] = (number.max(initial=-1) + 1 + pillars)[:, np.newaxis]
    fans[:, :, 1] = number[pillars]
    fans[:, :3, 2], fans[:, 3, 2] = fans[:, 1:, 1], fans[:, 0, 1]
    return fans.reshape(-1, 3)


def risers_of(sheet: Sheet, number: Integers) -> Integers:
    """Close the steps of a sheet by vertical triangles between its vertices of the given numbers.

    Counter-clockwise seen from the lower side; a step that ends in a shared corner is one triangle.
    """
    (west, east), (north, south) = sheet.east.T, sheet.south.T
    quads = np.concatenate(
        [
            np.column_stack(
                [number[west][:, [NORTH_EAST, SOUTH_EAST]], number[east][:, [SOUTH_WEST, NORTH_WEST]]]
            ),
            np.column_stack(
                [number[north][:, [SOUTH_EAST, SOUTH_WEST]], number[south][:, [NORTH_WEST, NORTH_EAST]]]
            ),
        ]
    )
    one, other = quads[quads[:, 1] != quads[:, 2]], quads[quads[:, 0] != quads[:, 3]]
    return np.concatenate([one[:, [0, 1, 2]], other[:, [0, 2, 3]]])


def _numbered(vertex: Integers) -> tuple[Integers, Integers]:
    """Number the vertices of a sheet from 0; return the numbers and a place in the array of each."""
    flat = vertex.ravel()
    lowest = flat.min(initial=0)
    place = np.zeros(flat.max(initial=0) - lowest + 1, np.int64)
    place[flat - lowest] = np.arange(len(flat))
    own = place[flat - lowest]
    is_first = own == np.arange(len(flat))
    number: Integers = (np.cumsum(is_first) - 1)[own]
    return number.reshape(vertex.shape), np.flatnonzero(is_first)
