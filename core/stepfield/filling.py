"""Filling holes of layers: what is filled is kept apart from what was measured.

A hole is a connected region of empty compartments within a layer: it shares no side with the outside of the
grid, and is no longer than a size. Regions that meet in a corner only are two holes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.holes import Holes, holes
from stepfield.inpainting import inpainted
from stepfield.progress import Progress, part, silent

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]
Method = Literal["nearest", "linear", "inpaint"]


@dataclass(frozen=True, eq=False)
class Filled:
    """What was filled in a layer.

    Attributes
    ----------
    compartment : ndarray of shape (n,), int64, read-only
        Ascending; none of them holds a pillar of the layer.
    elevation : ndarray of shape (n,), float64, read-only
        As those of the layer's pillars, metres.
    left : int
        Compartments of holes that stay empty: the surface would cross another layer or come too near to it.
    """

    compartment: Integers
    elevation: Floats
    left: int = 0

    def __post_init__(self) -> None:
        for array in (self.compartment, self.elevation):
            array.flags.writeable = False


#: What is filled where nothing is to be.
NOTHING = Filled(np.zeros(0, np.int64), np.zeros(0))


@dataclass(frozen=True, eq=False)
class Ground:
    """A layer whose holes may be filled, or one that is in the way.

    Attributes
    ----------
    compartment : ndarray of shape (n,), int64
        Ascending.
    bottom, top : ndarray of shape (n,), float64
        Between which nothing else may be, metres; the same of a surface.
    is_filled : bool
        Whether its holes are to be filled.
    """

    compartment: Integers
    bottom: Floats
    top: Floats
    is_filled: bool = True


def fill(
    grid: Grid,
    layers: Sequence[Ground],
    method: Method,
    size: float,
    clearance: float,
    progress: Progress = silent,
) -> tuple[Filled, ...]:
    """Fill the holes of layers, the lowest layer first.

    Parameters
    ----------
    grid : Grid
    layers : sequence of Ground
    method : str
        ``nearest`` takes the nearest pillar's elevation, ``linear`` spans rows and columns between the
        pillars around a hole, ``inpaint`` continues their slopes (biharmonic, Damelin and Hoang, 2018);
        none goes beyond the elevations that the layer has.
    size : float
        Longest side of the holes that are filled, metres.
    clearance : float
        Least vertical distance from what other layers have in the same compartment, metres. Layers stay in
        order: what is filled lies above all that lower layers have there, and below the higher ones.
    progress : Progress
        Asked between layers, and between the holes of one where they take long.

    Returns
    -------
    tuple of Filled
        One a layer.
    """
    made: list[Filled] = []
    for index, layer in enumerate(layers):
        own = part(progress, index / len(layers), (index + 1) / len(layers))
        own(0.0, "filling holes")
        hole = (
            _short(grid, holes(grid, layer.compartment), size) if layer.is_filled else np.zeros(0, np.int64)
        )
        if not len(hole):
            made.append(NOTHING)
            continue
        elevation = elevations_in(grid, layer, hole, method, own)
        fits = fitting(layers, index, hole, elevation, clearance)
        for filled in made:
            lower = Ground(filled.compartment, filled.elevation, filled.elevation)
            fits &= _fits(hole, elevation, lower, 1, clearance)
        made.append(Filled(hole[fits], elevation[fits], int(np.count_nonzero(~fits))))
    return tuple(made)


def elevations_in(
    grid: Grid, layer: Ground, hole: Integers, method: Method, progress: Progress = silent
) -> Floats:
    """Return what a method makes of the compartments of a layer's holes, whatever other layers have there."""
    made = (
        _inpaint(grid, layer, hole, progress) if method == "inpaint" else _METHODS[method](grid, layer, hole)
    )
    elevation: Floats = np.clip(made, layer.top.min(), layer.top.max())
    return elevation


def fitting(
    layers: Sequence[Ground], index: int, hole: Integers, elevation: Floats, clearance: float
) -> Flags:
    """Tell which elevations in holes of a layer are free of what the others have in the same compartments."""
    fits = np.ones(len(hole), bool)
    for other, ground in enumerate(layers):
        if other != index:
            fits &= _fits(hole, elevation, ground, index - other, clearance)
    return fits


def _fits(hole: Integers, elevation: Floats, ground: Ground, order: int, clearance: float) -> Flags:
    """Tell which places are free of another layer: above it if ``order`` is above 0, else below it."""
    if not len(ground.compartment):
        return np.ones(len(hole), bool)
    found = np.minimum(np.searchsorted(ground.compartment, hole), len(ground.compartment) - 1)
    is_alone: Flags = ground.compartment[found] != hole
    is_above: Flags = elevation >= ground.top[found] + clearance
    is_below: Flags = elevation <= ground.bottom[found] - clearance
    if not ground.is_filled:  # an obstacle may stand anywhere among the layers
        return is_alone | is_above | is_below
    return is_alone | (is_above if order > 0 else is_below)


def _short(grid: Grid, found: Holes, size: float) -> Integers:
    """Return the compartments of the holes that are no longer than ``size``, ascending."""
    longest = np.zeros(found.count, np.int64)
    for at in grid.row_column(found.compartment):
        first, last = np.full(found.count, len(grid)), np.zeros(found.count, np.int64)
        np.minimum.at(first, found.region, at)
        np.maximum.at(last, found.region, at)
        longest = np.maximum(longest, last - first + 1)
    is_short = longest * grid.cell_size <= size * (1 + 1e-9)
    return found.compartment[is_short[found.region]]


def _raster(grid: Grid, layer: Ground) -> Floats:
    raster = np.full((grid.rows, grid.columns), np.nan)
    raster.ravel()[layer.compartment] = layer.top
    return raster


def _everywhere(raster: Floats) -> Floats:
    """Give every empty compartment the elevation of the nearest pillar."""
    from scipy.ndimage import distance_transform_edt

    row, column = distance_transform_edt(np.isnan(raster), return_distances=False, return_indices=True)
    filled: Floats = raster[row, column]
    return filled


def _nearest(grid: Grid, layer: Ground, hole: Integers) -> Floats:
    return _everywhere(_raster(grid, layer)).ravel()[hole]


def _linear(grid: Grid, layer: Ground, hole: Integers) -> Floats:
    """Span every row and column of a hole from pillar to pillar; the shorter of the two counts more."""
    raster = _raster(grid, layer)
    row, column = grid.row_column(hole)
    along, length = _spanned(raster, row, column)
    across, depth = _spanned(raster.T, column, row)
    elevation: Floats = (along * depth + across * length) / (length + depth)
    return elevation


def _spanned(raster: Floats, row: Integers, column: Integers) -> tuple[Floats, Integers]:
    """Interpolate along rows, and say how far apart the pillars are; a hole has one at both ends of each."""
    count = raster.shape[1]
    place = np.where(np.isnan(raster), -1, np.arange(count, dtype=np.int32))
    before = np.maximum.accumulate(place, axis=1)[row, column]
    place[place < 0] = count
    after = np.minimum.accumulate(place[:, ::-1], axis=1)[:, ::-1][row, column]
    share = (column - before) / (after - before)
    spanned: Floats = raster[row, before] * (1 - share) + raster[row, after] * share
    return spanned, after - before


def _inpaint(grid: Grid, layer: Ground, hole: Integers, progress: Progress) -> Floats:
    """Continue slopes; what is empty beyond a hole counts as high as the nearest pillar."""
    raster, is_hole = _everywhere(_raster(grid, layer)), np.zeros((grid.rows, grid.columns), bool)
    is_hole.ravel()[hole] = True
    return inpainted(raster, is_hole, progress).ravel()[hole]


_METHODS = {"nearest": _nearest, "linear": _linear}
