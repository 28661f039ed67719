"""How far the points of every pillar are from the surface of its layer."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.complex_parts.points import Owned, owned_points
from stepfield.progress import Progress, silent
from stepfield.reconstruction import Reconstruction
from stepfield.surface import sheets

Floats = NDArray[np.float64]


def residuals(result: Reconstruction, progress: Progress = silent) -> Floats:
    """Root mean square distance of each pillar's points to the ``edges`` surface of its layer.

    The distance is taken to the plane of the triangle above or below a point, which is where rough
    ground, sparse ground on a slope and vertical faces all show: a wall stands in its compartment for half
    its height above and below any height that the compartment may have.

    Returns
    -------
    ndarray of shape (P,), float64
        Metres; NaN for pillars in no layer, and for obstacles: they are solid and have no surface.
    """
    planes, total = _planes(result), np.zeros(len(result.field))
    for owned in owned_points(result.scan, result.field, progress):
        total += np.bincount(owned.pillar, _squared_distances(result, planes, owned), len(total))
    rms: Floats = np.sqrt(total / result.field.points)
    return rms


def _planes(result: Reconstruction) -> Floats:
    """Elevations of the surface over each pillar: four corners and the middle, shape (P, 5); NaN for none."""
    field = result.field
    grid, step = field.compartments.grid, float(result.parameters.link_step)
    surfaces = [layer for layer in result.layers if not layer.is_obstacles]
    layers = [(field.compartment[layer.pillars], layer.elevation) for layer in surfaces]
    planes = np.full((len(field), 5), np.nan)
    for layer, sheet in zip(surfaces, sheets(grid, layers, step), strict=True):
        planes[layer.pillars] = np.column_stack([sheet.corner, sheet.top])
    return planes


def _squared_distances(result: Reconstruction, planes: Floats, owned: Owned) -> Floats:
    """Square of each point's distance to the triangle that is above or below it, shape (n,)."""
    grid, field = result.field.compartments.grid, result.field
    row, column = grid.row_column(field.compartment[owned.pillar])
    east = owned.places[:, 0] / grid.cell_size - column - 0.5
    north = owned.places[:, 1] / grid.cell_size - (grid.rows - 1 - row) - 0.5
    across = np.abs(north) > np.abs(east)  # in the triangle at the northern or the southern side
    north_west, south_west, south_east, north_east, middle = planes[owned.pillar].T
    side = np.where(
        across,
        np.where(north > 0, north_west + north_east, south_west + south_east),
        np.where(east > 0, north_east + south_east, north_west + south_west),
    )
    along = np.where(
        across,
        np.where(north > 0, north_east - north_west, south_east - south_west),
        np.where(east > 0, north_east - south_east, north_west - south_west),
    )
    outwards = (side / 2 - middle) * 2  # metres a compartment, away from the middle
    far, beside = np.where(across, np.abs(north), np.abs(east)), np.where(across, east, north)
    vertical = owned.places[:, 2] - (middle + outwards * far + along * beside)
    slope = (np.square(outwards) + np.square(along)) / grid.cell_size**2
    squared: Floats = np.square(vertical) / (1 + slope)
    return squared
