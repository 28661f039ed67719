"""Pictures recoloured after an edit: what changes its layer changes its colour, and stands where it stood.

Blocks and surfaces of a million pillars take most of a second to be made and drawn anew. Until they are, the
picture that is there will do: its depth tells what stands in every pixel, and what an edit has moved gets the
colour of its new layer, as bright as it was.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import UNASSIGNED
from stepfield.reconstruction import Reconstruction
from stepfield_app.render.camera import Camera
from stepfield_app.scenes.arrays import frozen

Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: A pixel belongs to what ends this many compartments above or below it: a surface is not a block.
SLACK = 0.5
#: The line of sight goes this share of a compartment into a block, to be in it and not beside it.
INTO = 0.05
#: Levels by which the colour of a pixel may differ from a darkened one; a line over it differs by more.
SAME = 10
#: Pixels looked at together: small enough for the processor's cache.
BAND = 1 << 16


@dataclass(frozen=True, eq=False)
class Coloured:
    """What a picture shows by layer.

    Attributes
    ----------
    result : Reconstruction
    colours : ndarray of shape (layers + 1, 3), uint8
        Unassigned last.
    visible : collection of int
    """

    result: Reconstruction
    colours: Bytes
    visible: Collection[int]


@dataclass(frozen=True, eq=False)
class _Part:
    """Pillars that had one colour; arrays have an entry a place of the area, row by row from the north.

    Attributes
    ----------
    was : ndarray of shape (3,), float32
        Red, green, blue.
    now : ndarray of shape (places, 3), uint8
    low, high : ndarray of shape (places,), float32
        Local elevations, metres; inf and -inf where there is none.
    """

    was: Singles
    now: Bytes
    low: Singles
    high: Singles


@dataclass(frozen=True, eq=False)
class Recolouring:
    """Where pillars have another colour now, over an area of places as large as what is drawn.

    Attributes
    ----------
    west, north, side : float
        Corner of the area and side of a place, local coordinates, metres.
    rows, columns : int
    low, high : float
        Local elevations between which something changes.
    parts : tuple
    """

    west: float
    north: float
    side: float
    rows: int
    columns: int
    low: float
    high: float
    parts: tuple[_Part, ...]

    @classmethod
    def between(cls, before: Coloured, now: Coloured, origin: Floats, joined: int = 0) -> Recolouring | None:
        """Return what changes from one picture to another; None where nothing does, or more than colours.

        Parameters
        ----------
        before, now : Coloured
        origin : ndarray of shape (3,)
            Scan coordinates of the local origin, metres.
        joined : int
            How often compartments are joined two by two in the picture.
        """
        if not _is_alike(before, now):
            return None
        old, new = before.result.layering.layer, now.result.layering.layer
        moved = np.flatnonzero(old != new)
        shown = _is_shown(before)[old[moved]] & _is_shown(now)[new[moved]]
        moved = moved[shown]
        return _over(before, now, moved, origin, joined) if len(moved) else None

    def boxes(self) -> Floats:
        """Corners of the area, shape (8, 3)."""
        across = (self.west, self.west + self.columns * self.side)
        along = (self.north - self.rows * self.side, self.north)
        return np.array(list(product(across, along, (self.low, self.high))))


def recoloured(pixels: Bytes, depth: Singles, camera: Camera, change: Recolouring) -> Bytes:
    """Return a picture with other colours.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 4), uint8
        Blue, green, red, and one more.
    depth : ndarray of shape (height, width), float32
        Metres along the view direction, 0 where nothing is drawn.
    camera : Camera
        What it was drawn with.
    change : Recolouring
    """
    made = pixels.copy()
    rows, columns = _window(depth.shape, camera, change)
    step = max(1, BAND // max(columns.stop - columns.start, 1))
    for top in range(rows.start, rows.stop, step):
        band = slice(top, min(top + step, rows.stop))
        _recolour(
            made[band, columns], depth[band, columns], (band.start, columns.start), depth, camera, change
        )
    return frozen(made)


def _is_alike(before: Coloured, now: Coloured) -> bool:
    """Whether colours are all that can differ, and a layer both have has the same one."""
    count = min(len(before.colours), len(now.colours)) - 1
    return (
        before.result.field is now.result.field
        and before.result.parameters == now.result.parameters
        and bool((before.colours[:count] == now.colours[:count]).all())
        and bool((before.colours[UNASSIGNED] == now.colours[UNASSIGNED]).all())
    )


def _is_shown(one: Coloured) -> NDArray[np.bool_]:
    """Mask over the layers, Unassigned last."""
    layers = (*range(len(one.colours) - 1), UNASSIGNED)
    return np.array([layer in one.visible for layer in layers])


def _over(before: Coloured, now: Coloured, moved: Integers, origin: Floats, joined: int) -> Recolouring:
    field = now.result.field
    grid, shift = field.compartments.grid, field.compartments.lowest - origin[2]
    row, column = (each >> joined for each in grid.row_column(field.compartment[moved]))
    north, west = int(row.min()), int(column.min())
    rows, columns = int(row.max()) - north + 1, int(column.max()) - west + 1
    place = (row - north) * columns + column - west
    top = field.elevation[moved]
    low = (np.minimum(field.lows(moved), top) + shift).astype(np.float32)
    high = (np.maximum(field.highs(moved), top) + shift).astype(np.float32)
    is_lowest = (moved == 0) | (field.compartment[moved] != field.compartment[moved - 1])
    low[is_lowest] = now.result.base_elevation - origin[2]
    old, new = before.result.layering.layer[moved], now.result.layering.layer[moved]
    parts = tuple(
        _part(
            before.colours[layer],
            now.colours[new[these]],
            place[these],
            low[these],
            high[these],
            rows * columns,
        )
        for layer in np.flatnonzero(np.bincount(old - UNASSIGNED)) + UNASSIGNED
        for these in [np.flatnonzero(old == layer)]
    )
    side = grid.cell_size * (1 << joined)
    return Recolouring(
        west=grid.west - origin[0] + west * side,
        north=grid.south - origin[1] + grid.rows * grid.cell_size - north * side,
        side=side,
        rows=rows,
        columns=columns,
        low=float(low.min()) - SLACK * side,
        high=float(high.max()) + SLACK * side,
        parts=parts,
    )


def _part(was: Bytes, now: Bytes, place: Integers, low: Singles, high: Singles, places: int) -> _Part:
    lowest, highest = np.full(places, np.inf, np.float32), np.full(places, -np.inf, np.float32)
    np.minimum.at(lowest, place, low)
    np.maximum.at(highest, place, high)
    colours = np.zeros((places, 3), np.uint8)
    colours[place] = now
    return _Part(was.astype(np.float32), colours, lowest, highest)


def _window(shape: tuple[int, ...], camera: Camera, change: Recolouring) -> tuple[slice, slice]:
    """Rows and columns of a picture in which the area can be."""
    height, width = shape
    corners, _ = camera.project(change.boxes(), (width, height))
    if np.isnan(corners).any():
        return slice(0, height), slice(0, width)
    first = np.clip(np.floor(corners.min(axis=0)) - 1, 0, (width, height)).astype(int)
    last = np.clip(np.ceil(corners.max(axis=0)) + 1, 0, (width, height)).astype(int)
    return slice(first[1], last[1]), slice(first[0], last[0])


def _recolour(
    pixels: Bytes,
    depth: Singles,
    corner: tuple[int, int],
    whole: Singles,
    camera: Camera,
    change: Recolouring,
) -> None:
    """Recolour a band in place; ``corner`` is its first row and column."""
    x, y, z = _places(depth, corner, whole.shape, camera, INTO * change.side)
    column = np.floor((x - np.float32(change.west)) / np.float32(change.side))
    row = np.floor((np.float32(change.north) - y) / np.float32(change.side))
    inside = (depth > 0) & (column >= 0) & (column < change.columns) & (row >= 0) & (row < change.rows)
    at = np.flatnonzero(inside.reshape(-1))
    row, column, height = (each.reshape(-1)[at] for each in (row, column, z))
    place = row.astype(np.int64) * change.columns + column.astype(np.int64)
    slack = np.float32(SLACK * change.side)
    rows = at // depth.shape[1]
    columns = at - rows * depth.shape[1]
    shown = pixels[rows, columns, 2::-1].astype(np.float32)
    for there, colour in _matches(change, place, height, shown, slack):
        pixels[rows[there], columns[there], 2::-1] = colour


def _matches(
    change: Recolouring, place: Integers, height: Singles, shown: Singles, slack: np.float32
) -> Iterator[tuple[Integers, Bytes]]:
    """Pixels that show something of another colour now, and that colour."""
    for part in change.parts:
        there = np.flatnonzero((height <= part.high[place] + slack) & (height >= part.low[place] - slack))
        light = shown[there] @ part.was / np.float32(max(float(part.was @ part.was), 1.0))
        error = np.abs(shown[there] - light[:, np.newaxis] * part.was).max(axis=1)
        there, light = there[error <= SAME], light[error <= SAME]
        lit = light[:, np.newaxis] * part.now[place[there]] + np.float32(0.5)
        yield there, np.minimum(lit, 255).astype(np.uint8)


def _places(
    depth: Singles, corner: tuple[int, int], shape: tuple[int, ...], camera: Camera, into: float
) -> tuple[Singles, Singles, Singles]:
    """Local coordinates of what pixels show, a little into it."""
    height, width = shape
    down = (np.arange(depth.shape[0]) + corner[0] + 0.5 - height / 2)[:, np.newaxis]
    across = np.arange(depth.shape[1]) + corner[1] + 0.5 - width / 2
    metres = camera.metres_per_pixel((width, height))
    scale = metres if camera.parallel else metres / camera.distance
    aside = [
        (across * (scale * camera.right[i]) - down * (scale * camera.up[i])).astype(np.float32)
        for i in range(3)
    ]
    deep = depth + np.float32(into)
    x, y, z = (
        np.float32(camera.eye[i])
        + (
            aside[i] + deep * np.float32(camera.forward[i])
            if camera.parallel
            else (aside[i] + np.float32(camera.forward[i])) * deep
        )
        for i in range(3)
    )
    return x, y, z
