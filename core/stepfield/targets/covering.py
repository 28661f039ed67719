"""The `edges` surface of a layer with fewer triangles: nowhere further from it than a tolerance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Mesh, Sheet
from stepfield.surface.edges import fans_of, risers_of, vertices_of
from stepfield.targets.decimation import covering, diagonals

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


def covered(sheet: Sheet, tolerance: float) -> Mesh:
    """Cover exactly the compartments of a sheet.

    Compartments at a step keep their triangles and the step its risers; what it is that is covered, and
    where two sheets meet at a step, is as in the whole surface.

    Parameters
    ----------
    sheet : Sheet
    tolerance : float
        Greatest vertical distance from the whole surface, metres.
    """
    vertices, number = vertices_of(sheet)
    lattice = _lattice(sheet)
    numbers = np.zeros((sheet.grid.rows + 1) * (sheet.grid.columns + 1), np.int64)
    numbers[lattice] = number
    parted = np.zeros(len(numbers), bool)
    parted[lattice[numbers[lattice] != number]] = True
    heights = np.full(len(numbers), np.nan)
    heights[lattice] = sheet.corner
    shape = (sheet.grid.rows, sheet.grid.columns)
    at_step: Flags = np.logical_or.reduce(parted[lattice], axis=1)
    errors = _errors(sheet, shape, at_step)
    coarse, fans = covering(heights.reshape(shape[0] + 1, shape[1] + 1), errors, tolerance)
    kept = np.flatnonzero(fans.ravel()[sheet.compartment])
    triangles = [numbers[coarse], fans_of(sheet, number, kept), risers_of(sheet, number)]
    return _compact(vertices, np.concatenate(triangles))


def _lattice(sheet: Sheet) -> Integers:
    """Number the corners of the grid that each compartment has, shape (n, 4)."""
    row, column = sheet.grid.row_column(sheet.compartment)
    north_west = row * (sheet.grid.columns + 1) + column
    below = sheet.grid.columns + 1
    return np.column_stack([north_west, north_west + below, north_west + below + 1, north_west + 1])


def _errors(sheet: Sheet, shape: tuple[int, int], is_parted: Flags) -> Floats:
    """How far two triangles a compartment would be from its four, infinite at steps, NaN in holes."""
    north_west, south_west, south_east, north_east = sheet.corner.T
    falls = diagonals(shape).ravel()[sheet.compartment]
    cut = np.where(falls, north_west + south_east, south_west + north_east) / 2
    errors = np.full(shape[0] * shape[1], np.nan)
    errors[sheet.compartment] = np.where(is_parted, np.inf, np.abs(sheet.top - cut))
    return errors.reshape(shape)


def _compact(vertices: Floats, triangles: Integers) -> Mesh:
    """Leave out the vertices that no triangle has."""
    used = np.zeros(len(vertices), bool)
    used[triangles] = True
    return Mesh(vertices[used], (np.cumsum(used) - 1)[triangles])
