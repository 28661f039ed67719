"""From a shape drawn over a view to the pillars it takes: in a 3-D view, on the map, in the profile."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield.selecting import Mask, Reach, connected
from stepfield_app.render.camera import Camera, Point, Size
from stepfield_app.scenes.arrays import frozen
from stepfield_app.scenes.lens import Lens, Outlook, visible_mask
from stepfield_app.scenes.readout import compartment_at
from stepfield_app.scenes.shapes import Kind as Kind
from stepfield_app.scenes.shapes import Shape as Shape
from stepfield_app.scenes.slices import Slices

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Place = tuple[float, float]

#: What is out of reach must be nearer than what is within by this share of a cell to be what was meant.
SLACK = 0.5


@dataclass(frozen=True, eq=False)
class InView:
    """A shape over a 3-D view.

    A pillar is taken when the middle of its top is in the shape; by a brush when that touches its top.

    Attributes
    ----------
    camera : Camera
    size : tuple of int
        Width and height of the picture, device pixels.
    origin : ndarray of shape (3,)
        Of local coordinates, scan coordinates, metres.
    visible : tuple of int
        Layers that are shown, -1 for Unassigned.
    shape : Shape
        In device pixels.
    place : tuple of 3 floats, optional
        Where a click or surface points at, local coordinates; None points at nothing.
    lens : Lens, optional
        One for all dabs of a stroke.
    """

    camera: Camera
    size: Size
    origin: Floats
    visible: tuple[int, ...]
    shape: Shape
    place: Point | None = None
    lens: Lens | None = None


@dataclass(frozen=True, eq=False)
class OnMap:
    """A shape over the map.

    A compartment is taken when its middle is in the shape; by a brush when that touches it; by a click when
    it contains it. All of its pillars within reach are.

    Attributes
    ----------
    shape : Shape
        Scan coordinates, metres.
    layer : int
        What the map shows: where a surface starts when the reach leaves a choice.
    """

    shape: Shape
    layer: int


@dataclass(frozen=True, eq=False)
class InSection:
    """A shape over the profile.

    It takes pillars that the line passes over or whose middle is within the band, when the middle of their
    top is in the shape; by a brush when that touches them between their lowest point and their top.

    Attributes
    ----------
    start, end : tuple of float
        Ends of the line, x and y in scan coordinates, metres.
    width : float
        Of the band, metres.
    shape : Shape
        Metres along the line and elevation; a brush is round where a metre up is ``exaggeration`` as long.
    visible : tuple of int
        Layers that are shown, -1 for Unassigned.
    exaggeration : float
        How much longer a metre is upwards than across; the radius of a brush is of the metre across.
    """

    start: Place
    end: Place
    width: float
    shape: Shape
    visible: tuple[int, ...]
    exaggeration: float = 1.0


Pick = InView | OnMap | InSection


def picked(result: Reconstruction, pick: Pick, reach: Reach) -> Mask:
    """Tell which pillars a shape takes.

    Parameters
    ----------
    result : Reconstruction
    pick : InView, OnMap or InSection
    reach : Reach
        Nothing beyond it is taken; a click on what is not within reach takes nothing.

    Returns
    -------
    ndarray of shape (P,), bool
        Read-only.
    """
    if pick.shape.is_pointing:
        seed = _mask(result, _pointed_at(result, pick, reach))
        return connected(result, seed, reach) if pick.shape.kind == "surface" and seed.any() else seed
    match pick:
        case InView():
            return _mask(result, _in_view(result, pick, reach))
        case OnMap():
            return _on_map(result, pick, reach)
        case InSection():
            return _mask(result, _in_section(result, pick, reach))


def _mask(result: Reconstruction, chosen: Integers) -> Mask:
    mask = np.zeros(len(result.field), bool)
    mask[chosen] = True
    return frozen(mask)


def _pointed_at(result: Reconstruction, pick: Pick, reach: Reach) -> Integers:
    """Pillars that a click means: none or one, on the map all of the compartment within reach."""
    match pick:
        case InView():
            return _block_at(result, pick, reach)
        case OnMap():
            return _stack_at(result, pick, reach)
        case InSection():
            return _slice_at(result, pick, reach)


def _block_at(result: Reconstruction, pick: InView, reach: Reach) -> Integers:
    """Return the pillar whose block is nearest to a place, of the compartment there and those around it."""
    if pick.place is None:
        return np.zeros(0, np.int64)
    place = np.asarray(pick.place) + pick.origin
    field, grid = result.field, result.field.compartments.grid
    around = grid.cell_size * (np.mgrid[-1:2, -1:2].reshape(2, -1).T) + place[:2]
    pillars = np.unique(np.concatenate([_standing_at(result, x, y) for x, y in around]))
    pillars = pillars[visible_mask(result, pick.visible)[pillars]]
    low, high = field.low[pillars], np.maximum(field.high[pillars], field.elevation[pillars])
    low[np.diff(field.compartment[pillars], prepend=-1) != 0] = -np.inf  # down to the base plane
    up = place[2] - field.compartments.lowest
    aside = np.abs(grid.centres(field.compartment[pillars]) - place[:2]) - grid.cell_size / 2
    beyond = np.column_stack([aside, low - up, up - high])
    distance = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return _nearest(pillars, distance, reach.mask(result)[pillars], SLACK * grid.cell_size)


def _stack_at(result: Reconstruction, pick: OnMap, reach: Reach) -> Integers:
    """Return the pillars of a compartment; for a surface the one of the layer shown, else the highest."""
    x, y = pick.shape.path[-1]
    pillars = _standing_at(result, x, y)
    pillars = pillars[reach.mask(result)[pillars]]
    if pick.shape.kind == "click":
        return pillars
    shown = pillars[result.layering.layer[pillars] == pick.layer]
    return shown if len(shown) == 1 else pillars[-1:]


def _slice_at(result: Reconstruction, pick: InSection, reach: Reach) -> Integers:
    """Return the pillar under the line whose slice is nearest to a place of the profile."""
    slices = Slices.under(result, pick.start, pick.end)
    distance = np.hypot(*np.maximum(np.abs(slices.middle - pick.shape.path[-1]) - slices.half, 0).T)
    slack = SLACK * result.field.compartments.grid.cell_size
    near = (distance <= slack) & visible_mask(result, pick.visible)[slices.pillar]
    pillars = slices.pillar[near]
    return _nearest(pillars, distance[near], reach.mask(result)[pillars], slack)


def _nearest(pillars: Integers, distance: Floats, within: Mask, slack: float) -> Integers:
    """Return the nearest pillar within reach, unless one beyond it is nearer by more than the slack."""
    if not within.any():
        return np.zeros(0, np.int64)
    chosen = np.argmin(np.where(within, distance, np.inf))
    return pillars[[chosen]] if distance[chosen] <= distance.min() + slack else np.zeros(0, np.int64)


def _in_view(result: Reconstruction, pick: InView, reach: Reach) -> Integers:
    """Pillars whose top the picture shows in the shape, whether or not something stands before it."""
    outlook = Outlook(pick.camera, pick.size, pick.origin, pick.visible, reach)
    return (pick.lens or Lens()).covered(result, outlook, pick.shape)


def _on_map(result: Reconstruction, pick: OnMap, reach: Reach) -> Mask:
    field = result.field
    cells = field.compartments
    taken = pick.shape.touches(cells.grid.centres(cells.occupied), cells.grid.cell_size / 2)
    return frozen(np.repeat(taken, np.diff(field.first)) & reach.mask(result))


def _in_section(result: Reconstruction, pick: InSection, reach: Reach) -> Integers:
    slices, shape = Slices.near(result, pick.start, pick.end, pick.width), pick.shape
    if shape.kind == "brush":
        stretch = np.array([1.0, pick.exaggeration])
        round_there = replace(shape, path=shape.path * stretch)
        taken = round_there.touches(slices.middle * stretch, slices.half * stretch)
    else:
        taken = shape.covers(slices.top)
    pillars = slices.pillar[taken]
    return pillars[(reach.mask(result) & visible_mask(result, pick.visible))[pillars]]


def _standing_at(result: Reconstruction, x: float, y: float) -> Integers:
    """Pillars of the compartment at a place in scan coordinates, from the lowest up."""
    place, field = compartment_at(result, x, y), result.field
    if place is None:
        return np.zeros(0, np.int64)
    occupied = field.compartments.occupied
    number = place[0] * field.compartments.grid.columns + place[1]
    at = int(np.searchsorted(occupied, number))
    if at == len(occupied) or occupied[at] != number:
        return np.zeros(0, np.int64)
    return np.arange(field.first[at], field.first[at + 1])
