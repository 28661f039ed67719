"""The compartments of a layer as rectangles without holes or steps, each a raster of heights.

As :mod:`stepfield.targets.tiles`, for the surface that covers exactly the compartments of its pillars: a
rectangle also ends at a step, and is as thick as the step is high where there is room for it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Sheet
from stepfield.surface.corners import NORTH_EAST, NORTH_WEST, SOUTH_EAST, SOUTH_WEST
from stepfield.targets.terrain import Raster, Terrain
from stepfield.targets.tiles import LEAST_GAP, SHARE, SLAB, SLAB_SHARE, Bounds, Flags, Tile, rectangles

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: A middle that is no further than this from the diagonal of its corners is left out, metres.
CLOSE = 1e-3


def squares(terrain: Terrain, index: int) -> Iterator[tuple[Tile, Raster]]:
    """Cover every compartment of a layer once.

    Parameters
    ----------
    terrain : Terrain
    index : int
        Of the layer.

    Yields
    ------
    tuple of Tile and ndarray
        Compartments, and heights at their corners; where they bend also in their middles and half-way along
        their sides.
    """
    sheet = terrain.sheets[index]
    shape = (terrain.rows, terrain.columns)
    number = np.full(shape, -1, np.int64)
    number.ravel()[sheet.compartment] = np.arange(len(sheet.compartment))
    low, beneath = _raster(_lowest(sheet), sheet, shape), _beneath(terrain, index, shape)
    bounds = Bounds(low, low - SHARE * beneath, np.minimum(SLAB, SLAB_SHARE * beneath))
    foot = _feet(sheet, shape)
    joined = (_joined(sheet, number, axis) for axis in (1, 0))
    for tile in rectangles(number >= 0, bounds, *joined):
        part = np.s_[tile.row : tile.row + tile.rows, tile.column : tile.column + tile.columns]
        lowest = float(low[part].min())
        room = lowest - float(bounds.floor[part].max())
        slab = max(tile.slab, min(lowest - float(foot[part].min()), room))
        yield replace(tile, slab=slab), heights(sheet, number[part])


def heights(sheet: Sheet, number: Integers) -> Raster:
    """Return the heights of a rectangle of compartments, given by number, shape (rows + 1, columns + 1).

    Where a middle is not where the diagonal from north-west to south-east is, there are twice as many:
    the middles and the sides' middles are in between.
    """
    corner, top = sheet.corner[number], sheet.top[number]
    corners = np.empty((number.shape[0] + 1, number.shape[1] + 1))
    corners[:-1, :-1], corners[1:, :-1] = corner[..., NORTH_WEST], corner[..., SOUTH_WEST]
    corners[1:, 1:], corners[:-1, 1:] = corner[..., SOUTH_EAST], corner[..., NORTH_EAST]
    if np.abs(top - (corner[..., NORTH_WEST] + corner[..., SOUTH_EAST]) / 2).max() <= CLOSE:
        return corners.astype(np.float32)
    doubled = np.empty((2 * number.shape[0] + 1, 2 * number.shape[1] + 1), np.float32)
    doubled[::2, ::2], doubled[1::2, 1::2] = corners, top
    doubled[1::2, ::2] = (corners[:-1] + corners[1:]) / 2
    doubled[::2, 1::2] = (corners[:, :-1] + corners[:, 1:]) / 2
    return doubled


def _raster(values: Floats, sheet: Sheet, shape: tuple[int, int], missing: float = np.nan) -> Floats:
    raster = np.full(shape, missing)
    raster.ravel()[sheet.compartment] = values
    return raster


def _lowest(sheet: Sheet) -> Floats:
    lowest: Floats = np.minimum(sheet.corner.min(axis=1, initial=np.inf), sheet.top)
    return lowest


def _highest(sheet: Sheet) -> Floats:
    highest: Floats = np.maximum(sheet.corner.max(axis=1, initial=-np.inf), sheet.top)
    return highest


def _joined(sheet: Sheet, number: Integers, axis: int) -> Flags:
    """Whether a compartment shares both corners with the one to its east (axis 1) or south (axis 0)."""
    ends, beyond = (
        ((NORTH_EAST, SOUTH_EAST), (NORTH_WEST, SOUTH_WEST))
        if axis
        else ((SOUTH_WEST, SOUTH_EAST), (NORTH_WEST, NORTH_EAST))
    )
    joined = np.zeros(number.shape, bool)
    before, after = (np.s_[:, :-1], np.s_[:, 1:]) if axis else (np.s_[:-1], np.s_[1:])
    one, other = number[before], number[after]
    both = (one >= 0) & (other >= 0)
    one, other = one[both], other[both]
    joined[before][both] = (sheet.vertex[one][:, ends] == sheet.vertex[other][:, beyond]).all(axis=1)
    return joined


def _beneath(terrain: Terrain, index: int, shape: tuple[int, int]) -> Floats:
    """Free height under each compartment of a layer: to what lies next below it, metres.

    Where nothing lies below, the lowest layer is ground however deep, and any other is free to the base.
    """
    sheet = terrain.sheets[index]
    low = _raster(_lowest(sheet), sheet, shape)
    gap = np.full(shape, np.inf) if index == 0 else low - terrain.base_elevation
    own = _raster(sheet.top, sheet, shape)
    for other in terrain.sheets[:index] + terrain.sheets[index + 1 :]:
        is_below = own > _raster(other.top, other, shape, np.inf)
        gap = np.where(is_below, np.fmin(gap, low - _raster(_highest(other), other, shape, np.inf)), gap)
    return np.fmax(gap, LEAST_GAP)


def _feet(sheet: Sheet, shape: tuple[int, int]) -> Floats:
    """Where the risers of each compartment begin that stands above another, infinite for none; metres."""
    foot = np.full(len(sheet.top), np.inf)
    for pairs, ends, beyond in (
        (sheet.east, (NORTH_EAST, SOUTH_EAST), (NORTH_WEST, SOUTH_WEST)),
        (sheet.south, (SOUTH_WEST, SOUTH_EAST), (NORTH_WEST, NORTH_EAST)),
    ):
        one, other = pairs.T
        np.minimum.at(foot, one, sheet.corner[other][:, beyond].min(axis=1, initial=np.inf))
        np.minimum.at(foot, other, sheet.corner[one][:, ends].min(axis=1, initial=np.inf))
    return _raster(foot, sheet, shape, np.inf)
