"""Obstacles as boxes: solid from their lower ends to their tops, neighbours of about one height in one box.

A box has the highest top and the lowest bottom of its pillars, so that no wall is lower than it was seen to
be; neither is further from any of its pillars than a bound.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Mesh
from stepfield.targets.terrain import Raster, Terrain, TerrainLayer

#: The least height of a box, metres: simulators refuse flat ones.
LEAST = 1e-3
#: Compartments along a side of a box: looking for the end of one stays cheap.
LONGEST = 256
#: Corners of a box, lower then upper ones anticlockwise from the south-west; its six faces seen from outside.
_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


@dataclass(frozen=True, slots=True)
class Box:
    """A box along the axes; local coordinates, metres."""

    west: float
    south: float
    bottom: float
    east: float
    north: float
    top: float

    @property
    def middle(self) -> tuple[float, float, float]:
        """Its centre."""
        return (self.west + self.east) / 2, (self.south + self.north) / 2, (self.bottom + self.top) / 2

    @property
    def half(self) -> tuple[float, float, float]:
        """Half its extent along x, y and z."""
        return (self.east - self.west) / 2, (self.north - self.south) / 2, (self.top - self.bottom) / 2


def boxes(terrain: Terrain, layer: TerrainLayer, bound: float | None = None) -> Iterator[Box]:
    """Cover every pillar of a layer of obstacles once, greedily: from the north-west, first east, then south.

    Parameters
    ----------
    terrain : Terrain
    layer : TerrainLayer
        Of obstacles.
    bound : float, optional
        How far tops and bottoms of a box's pillars may lie apart, metres; a quarter of a compartment.
    """
    limit = terrain.cell_size / 4 if bound is None else bound
    lower, upper, free = feet(terrain, layer), layer.elevations, layer.occupied
    for row, column in np.argwhere(free).tolist():
        if free[row, column]:
            rest = np.s_[row : row + LONGEST, column : column + LONGEST]
            rows, columns = _extent(lower[rest], upper[rest], free[rest], limit)
            block = np.s_[row : row + rows, column : column + columns]
            free[block] = False
            yield _box(terrain, block, float(lower[block].min()), float(upper[block].max()))


def as_boxes(terrain: Terrain, layer: TerrainLayer, bound: float | None = None) -> Mesh:
    """Return a layer of obstacles as closed boxes of triangles; see :func:`boxes`."""
    made = list(boxes(terrain, layer, bound))
    corners = [[(b.west, b.south), (b.east, b.south), (b.east, b.north), (b.west, b.north)] for b in made]
    plan = np.array(corners, np.float64).reshape(-1, 4, 2)
    levels = np.array([(b.bottom, b.top) for b in made], np.float64).reshape(-1, 2)
    vertices = np.concatenate([np.tile(plan, (1, 2, 1)), levels.repeat(4, axis=1)[:, :, np.newaxis]], axis=2)
    block = np.array(_FACES)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    triangles = (np.arange(len(made))[:, np.newaxis, np.newaxis] * 8 + block).reshape(-1, 3)
    return Mesh(vertices.reshape(-1, 3), triangles)


def feet(terrain: Terrain, layer: TerrainLayer) -> Raster:
    """Lower ends of the obstacles, shape (rows, columns), NaN where there are none.

    A wall whose foot was hidden must not be one to slip under: where nothing was seen beneath an obstacle,
    it goes down to the lowest of the next surfaces around, unless more is missing than was seen of it. So a
    door stays one whose threshold nobody saw.
    """
    bottom = layer.elevations if layer.bottoms is None else layer.bottoms
    around = np.full(bottom.shape, np.inf, np.float32)
    for down, right in product((-1, 0, 1), repeat=2):
        if down or right:
            beneath = _beneath(terrain, layer, bottom, down, right)
            around = np.fmin(around, np.where(np.isneginf(beneath), np.inf, beneath))
    is_free = ~np.isneginf(_beneath(terrain, layer, bottom, 0, 0))
    is_free |= bottom - around > layer.elevations - bottom
    return np.where(is_free, bottom, np.minimum(bottom, around))


def _beneath(terrain: Terrain, layer: TerrainLayer, bottom: Raster, down: int, right: int) -> Raster:
    """Return the highest there is, below every bottom, so many rows and columns away; -inf for nothing."""
    beneath = np.full(bottom.shape, -np.inf, np.float32)
    for other in terrain.layers:
        is_surface = not other.is_obstacles
        if other is not layer and (is_surface or not (down or right)):
            there = _shifted(other.elevations, down, right)
            beneath = np.fmax(beneath, np.where(there <= bottom, there, -np.inf))
    return beneath


def _shifted(raster: Raster, down: int, right: int) -> Raster:
    """Return at every place what lies so many rows and columns from it; NaN beyond the edge."""
    rows, columns = raster.shape
    wide = np.pad(raster, 1, constant_values=np.nan)
    return wide[1 + down : 1 + down + rows, 1 + right : 1 + right + columns]


def _extent(lower: Raster, upper: Raster, free: NDArray[np.bool_], limit: float) -> tuple[int, int]:
    """Count the rows and columns, from the first place on, that one box holds."""
    columns = _alike(lower[:1], upper[:1], free[:1], limit, axis=0)
    east = np.s_[:, :columns]
    return _alike(lower[east], upper[east], free[east], limit, axis=1), columns


def _alike(lower: Raster, upper: Raster, free: NDArray[np.bool_], limit: float, axis: int) -> int:
    """Count the first rows (axis 1) or columns (axis 0) that are free and about as high."""
    whole: NDArray[np.bool_] = np.logical_and.reduce(free, axis=axis)
    count = len(whole) if whole.all() else int(whole.argmin())
    alike = np.ones(count, bool)
    for values in (lower, upper):
        part = values[:, :count] if axis == 0 else values[:count]
        least = np.minimum.accumulate(part.min(axis=axis))
        most = np.maximum.accumulate(part.max(axis=axis))
        alike &= most - least <= limit
    return count if alike.all() else int(alike.argmin())


def _box(terrain: Terrain, block: tuple[slice, slice], bottom: float, top: float) -> Box:
    half, cell = terrain.cell_size / 2, terrain.cell_size
    rows, columns = block
    west, north = terrain.west - half, terrain.north + half
    return Box(
        west=west + columns.start * cell,
        south=north - rows.stop * cell,
        bottom=min(bottom, top - LEAST),
        east=west + columns.stop * cell,
        north=north - rows.start * cell,
        top=top,
    )
