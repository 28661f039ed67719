"""Every so manieth compartment of a step-field: all that a picture needs that is gone in a moment."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.filling import NOTHING
from stepfield.grid import Grid
from stepfield.layers import UNASSIGNED
from stepfield.reconstruction import Reconstruction

Integers = NDArray[np.int64]
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Thinned:
    """All pillars of some compartments.

    Attributes
    ----------
    grid : Grid
        Of these compartments, each as large as what it stands for, with its middle where it was.
    pillars : ndarray of shape (n,), int64
        Indices into the step-field, ascending.
    compartment : ndarray of shape (n,), int64
        In ``grid``, ascending.
    """

    grid: Grid
    pillars: Integers
    compartment: Integers


def stride_for(count: int, most: int) -> int:
    """Every how manieth row and column leaves about ``most`` of ``count``."""
    return max(1, math.ceil(math.sqrt(count / most)))


def thinned(result: Reconstruction, stride: int) -> Thinned:
    """Keep every ``stride``-th row and column of a step-field; 1 keeps all."""
    field, grid = result.field, result.field.compartments.grid
    if stride == 1:
        return Thinned(grid, np.arange(len(field)), field.compartment)
    wanted = np.zeros((grid.rows, grid.columns), bool)
    wanted[::stride, ::stride] = True
    kept = np.flatnonzero(wanted.reshape(-1)[field.compartments.occupied])
    held = field.first[kept + 1] - field.first[kept]
    row, column = grid.row_column(field.compartments.occupied[kept])
    coarse = coarse_grid(grid, stride)
    compartment = np.repeat(row // stride * coarse.columns + column // stride, held)
    nth = np.arange(len(compartment)) - np.repeat(np.cumsum(held) - held, held)
    return Thinned(coarse, np.repeat(field.first[kept], held) + nth, compartment)


@dataclass(frozen=True, eq=False)
class Pixels:
    """A layer from above.

    Attributes
    ----------
    grid : Grid
    compartment : ndarray of shape (n,), int64
        Those that are occupied, ascending.
    elevation : ndarray of shape (n,), float64
        Metres above the scan's lowest point.
    pillars : ndarray of shape (n,), int64
        Indices into the step-field; -1 where there is none, but a hole that was filled.
    """

    grid: Grid
    compartment: Integers
    elevation: Floats
    pillars: Integers


def pixels(result: Reconstruction, layers: Sequence[int], stride: int = 1) -> list[Pixels]:
    """Return every ``stride``-th row and column of layers; -1 stands for all pillars in none."""
    field, some = result.field, thinned(result, stride) if stride > 1 else None
    if some is None:
        return [_all_pixels(result, layer) for layer in layers]
    their, elevation = result.layering.layer[some.pillars], field.elevation[some.pillars]
    masks = [their == layer for layer in layers]
    return [Pixels(some.grid, some.compartment[mask], elevation[mask], some.pillars[mask]) for mask in masks]


def _all_pixels(result: Reconstruction, layer: int) -> Pixels:
    field, grid = result.field, result.field.compartments.grid
    if layer == UNASSIGNED:
        members = result.layering.members(UNASSIGNED)
        return Pixels(grid, field.compartment[members], field.elevation[members], members)
    own = result.layers[layer]
    return Pixels(grid, field.compartment[own.pillars], own.elevation, own.pillars)


def filled(result: Reconstruction, layer: int, stride: int = 1) -> Pixels:
    """Return what was filled in a layer, of every ``stride``-th row and column; -1 stands for no pillar."""
    grid = result.field.compartments.grid
    made = NOTHING if layer == UNASSIGNED else result.layers[layer].filled
    compartment, elevation = made.compartment, made.elevation
    if stride > 1:
        row, column = grid.row_column(compartment)
        kept = (row % stride == 0) & (column % stride == 0)
        coarse = coarse_grid(grid, stride)
        compartment = row[kept] // stride * coarse.columns + column[kept] // stride
        grid, elevation = coarse, elevation[kept]
    return Pixels(grid, compartment, elevation, np.full(len(compartment), -1))


def with_filled(result: Reconstruction, layers: Sequence[int], stride: int = 1) -> list[Pixels]:
    """Return :func:`pixels` of layers and what was filled in them as one ground."""
    return [
        _joined(part, filled(result, layer, stride))
        for layer, part in zip(layers, pixels(result, layers, stride), strict=True)
    ]


def _joined(part: Pixels, more: Pixels) -> Pixels:
    if not len(more.compartment):
        return part
    compartment = np.concatenate([part.compartment, more.compartment])
    order = np.argsort(compartment, kind="stable")
    elevation, pillars = (
        np.concatenate([getattr(each, name) for each in (part, more)])[order]
        for name in ("elevation", "pillars")
    )
    return Pixels(part.grid, compartment[order], elevation, pillars)


def pooled(part: Pixels, factor: int) -> Pixels:
    """Join so many by so many compartments of a layer: occupied where any is, as high as all on average.

    Of the pillars, the first of each stands for all.
    """
    grid = part.grid
    rows, columns = -(-grid.rows // factor), -(-grid.columns // factor)
    side = grid.cell_size * factor
    coarse = Grid(grid.west, grid.south + grid.rows * grid.cell_size - rows * side, side, columns, rows)
    row, column = grid.row_column(part.compartment)
    at = row // factor * columns + column // factor
    count = np.bincount(at, minlength=len(coarse))
    total = np.bincount(at, part.elevation, minlength=len(coarse))
    compartment = np.flatnonzero(count)
    first = np.zeros(len(coarse), np.int64)
    first[at[::-1]] = part.pillars[::-1]
    return Pixels(coarse, compartment, total[compartment] / count[compartment], first[compartment])


def coarse_grid(grid: Grid, stride: int) -> Grid:
    """Return the grid whose compartments have the middles of every ``stride``-th row and column."""
    rows, columns = -(-grid.rows // stride), -(-grid.columns // stride)
    side = grid.cell_size * stride
    west = grid.west + grid.cell_size / 2 - side / 2
    south = grid.south + (grid.rows - 0.5) * grid.cell_size - (rows - 0.5) * side
    return Grid(west, south, side, columns, rows)
