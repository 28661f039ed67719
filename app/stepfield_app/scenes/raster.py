"""A layer seen from above, one pixel a compartment.

Row 0 is north, column 0 is west; holes are transparent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.heightmap import GrayScale
from stepfield.layers import UNASSIGNED
from stepfield.reconstruction import Reconstruction
from stepfield_app.ramps import ramp
from stepfield_app.scenes.arrays import frozen, robust_range, steps
from stepfield_app.scenes.legend import Legend
from stepfield_app.scenes.paled import paled
from stepfield_app.scenes.thinned import Pixels, filled, pixels
from stepfield_app.theme import WALL_COLOUR, rgb

Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mode = Literal["gray", "colour", "hillshade"]

#: Where the light of the hillshade comes from: the north-west, half-way up.
LIGHT = (-0.5, 0.5, 0.7071)
#: Every so manieth diagonal of a wall's pixels is hatched.
HATCH = 2
#: Light that a slope facing away still has.
AMBIENT = 0.35


@dataclass(frozen=True, eq=False)
class Raster:
    """A picture of a layer and the numbers in it.

    Attributes
    ----------
    pixels : ndarray of shape (rows, columns, 4), uint8
        Red, green, blue, opacity (0 in holes that were not filled).
    elevations : ndarray of shape (rows, columns), float32
        Scan coordinates, metres; NaN in holes.
    legend : Legend or None
        None where there is nothing to read off it.
    """

    pixels: Bytes
    elevations: Singles
    legend: Legend | None


def raster(
    result: Reconstruction,
    layer: int,
    mode: Mode = "hillshade",
    span: tuple[float, float] | None = None,
    stride: int = 1,
) -> Raster:
    """Draw a layer from above.

    Parameters
    ----------
    result : Reconstruction
    layer : int
        -1 for the pillars in no layer, the highest of each compartment.
    mode : str
        ``gray``: as the exported image, without its padding. ``colour``: by height. ``hillshade``: the same
        with light from the north-west. Walls among surfaces are hatched in both, filled holes cyan.
    span : tuple of float
        Elevations the ramp spans, scan coordinates; the layer's own by default.
    stride : int
        Every how manieth row and column is drawn; 1 for ``gray``, which is the exported image.
    """
    [part] = pixels(result, [layer], stride)
    grid, heights = part.grid, _heights(result, part)
    holes = filled(result, layer, stride)
    surface = np.fmax(heights, _heights(result, holes)) if len(holes.compartment) else heights
    if mode == "gray":
        gray = _exported(result, layer, surface)
        legend = _levels(result, "incl. filled" if len(holes.compartment) else "")
        return Raster(_opaque(np.repeat(gray[:, :, np.newaxis], 3, axis=2), surface), heights, legend)
    low, high = span or robust_range(heights)
    colours = ramp("height")[steps(surface, low, high, 256)]
    if mode == "hillshade":
        shade = hillshade(surface, grid.cell_size)
        colours = np.rint(colours * shade[:, :, np.newaxis]).astype(np.uint8)
    notes = ["red: wall"] if _hatch(colours, result, layer, part) else []
    notes += ["cyan: filled"] if _pale(colours, holes) else []
    of_heights = Legend("Elevation", "m", ramp("height"), low=low, high=high, note=", ".join(notes))
    return Raster(_opaque(colours, surface), heights, of_heights if len(part.pillars) else None)


def _pale(colours: Bytes, holes: Pixels) -> bool:
    """Make what was filled cyan, as nothing measured is, in place; tell whether there is any."""
    row, column = holes.grid.row_column(holes.compartment)
    colours[row, column] = paled(colours[row, column])
    return bool(len(holes.compartment))


def _hatch(colours: Bytes, result: Reconstruction, layer: int, part: Pixels) -> bool:
    """Hatch the walls of a layer, in place; tell whether there are any among surfaces."""
    if layer in result.layering.obstacles:
        return False
    walls = part.compartment[result.field.vertical[part.pillars]]
    row, column = part.grid.row_column(walls)
    hatched = (row + column) % HATCH == 0
    colours[row[hatched], column[hatched]] = rgb(WALL_COLOUR)
    return bool(len(walls))


def elevations(result: Reconstruction, layer: int) -> Singles:
    """Elevations of a layer, shape (rows, columns), float32, scan coordinates, metres; NaN in holes."""
    return thinned_elevations(result, layer, 1)[1]


def thinned_elevations(result: Reconstruction, layer: int, stride: int) -> tuple[Grid, Singles]:
    """Return :func:`elevations` of every ``stride``-th row and column, and the grid of these."""
    [part] = pixels(result, [layer], stride)
    return part.grid, _heights(result, part)


def _heights(result: Reconstruction, part: Pixels) -> Singles:
    heights = np.full(len(part.grid), np.nan, np.float32)
    heights[part.compartment] = part.elevation + result.field.compartments.lowest
    return frozen(heights.reshape(part.grid.rows, part.grid.columns))


def hillshade(heights: Singles, cell_size: float) -> Singles:
    """Light on a surface of elevations, shape (rows, columns), 0 to 1; level ground has 0.92.

    A hole counts as level with whatever is beside it.
    """
    east, north = _slope(heights, cell_size, axis=1), -_slope(heights, cell_size, axis=0)
    towards = np.float32(LIGHT[2]) - np.float32(LIGHT[0]) * east - np.float32(LIGHT[1]) * north
    towards /= np.sqrt(1 + np.square(east) + np.square(north))
    light = np.float32(AMBIENT) + np.float32((0.92 - AMBIENT) / LIGHT[2]) * towards
    lit: Singles = np.clip(np.nan_to_num(light, nan=1.0), AMBIENT, 1)
    return lit


def thumbnails(
    result: Reconstruction, layers: Sequence[int], side: int = 48, stride: int = 1
) -> dict[int, Bytes]:
    """Draw layers small, so that even a single pillar shows: each pixel is the highest of its compartments.

    Parameters
    ----------
    result : Reconstruction
    layers : sequence of int
        -1 for the pillars in none.
    side : int
        Pixels at most; small grids are enlarged by a whole number.
    stride : int
        Every how manieth row and column is looked at.

    Returns
    -------
    dict of int to ndarray of shape (h, w, 4), uint8
    """
    parts = pixels(result, layers, stride)
    return {layer: _thumbnail(part, side) for layer, part in zip(layers, parts, strict=True)}


def _thumbnail(part: Pixels, side: int) -> Bytes:
    small = _highest(part, side)
    colours = ramp("height")[steps(small, *robust_range(small, 0.02), 256)]
    picture, times = _opaque(colours, small), max(1, side // max(small.shape))
    return frozen(picture.repeat(times, axis=0).repeat(times, axis=1))


def _highest(part: Pixels, side: int) -> Floats:
    """Greatest elevations of squares of compartments, at most ``side`` a side; NaN without a pillar."""
    grid = part.grid
    factor = max(1, -(-max(grid.rows, grid.columns) // side))
    rows, columns = -(-grid.rows // factor), -(-grid.columns // factor)
    own = np.full(len(grid), -np.inf)
    own[part.compartment] = part.elevation  # of several in a compartment the last one stays: the highest
    whole = np.full((rows * factor, columns * factor), -np.inf)
    whole[: grid.rows, : grid.columns] = own.reshape(grid.rows, grid.columns)
    strips = whole.reshape(rows, factor, columns * factor).max(axis=1)  # one axis at a time is quicker
    small: Floats = strips.reshape(rows, columns, factor).max(axis=2)
    small[np.isneginf(small)] = np.nan
    return small


def _exported(result: Reconstruction, layer: int, heights: Singles) -> Bytes:
    """Gray levels as the exported image has them, in 8 bits."""
    if layer == UNASSIGNED:  # which is not exported
        scale = GrayScale(result.max_height, 8)
        above = np.nan_to_num(heights.astype(np.float64) - result.base_elevation)
        return np.clip(scale.encode(np.clip(above, 0, result.max_height)), 0, 255).astype(np.uint8)
    frame, shape = result.frame, heights.shape
    gray = result.height_map(result.layers[layer]).gray
    gray = gray[frame.row : frame.row + shape[0], frame.column : frame.column + shape[1]]
    return (gray >> 8).astype(np.uint8) if gray.dtype == np.uint16 else gray.astype(np.uint8)


def _levels(result: Reconstruction, note: str) -> Legend:
    """Legend of the exported grays: from the base plane to white."""
    base = result.base_elevation
    return Legend("Elevation", "m", ramp("intensity"), low=base, high=base + result.max_height, note=note)


def _opaque(colours: Bytes, heights: NDArray[np.floating]) -> Bytes:
    """Add opacity: none in holes, where the colour is black too."""
    pixels = np.empty((*heights.shape, 4), np.uint8)
    pixels[:, :, :3] = colours
    pixels[:, :, 3] = 255
    pixels[np.isnan(heights)] = 0
    return frozen(pixels)


def _slope(heights: Singles, cell_size: float, axis: int) -> Singles:
    """Rise towards higher indices along an axis, over the neighbours there are."""
    before, after = np.roll(heights, 1, axis), np.roll(heights, -1, axis)
    edge: list[slice | int] = [slice(None), slice(None)]
    edge[axis] = 0
    before[tuple(edge)] = np.nan
    edge[axis] = -1
    after[tuple(edge)] = np.nan
    no_before, no_after = np.isnan(before), np.isnan(after)
    np.copyto(before, heights, where=no_before)
    np.copyto(after, heights, where=no_after)
    apart = 2.0 - no_before - no_after
    slope: Singles = ((after - before) / (np.maximum(apart, 1) * cell_size)).astype(np.float32)
    return slope
