"""Blocks: what the pillars of a step-field look like (paper 5.1), before they become triangles.

The lowest pillar of a compartment is a column that stands on the base plane; one above a gap is a slab from
its lowest point to its elevation.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.layers import UNASSIGNED
from stepfield.reconstruction import Layer, Reconstruction
from stepfield_app.scenes.thinned import thinned

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: A slab is at least this share of the cell size thick, so that a sheet of points can be seen from the side.
THINNEST = 0.25


@dataclass(frozen=True, eq=False)
class Lattice:
    """Edges of the columns and rows that blocks stand in, local coordinates, metres.

    Attributes
    ----------
    across : ndarray of shape (columns + 1,)
        x of the edges, west to east.
    down : ndarray of shape (rows + 1,)
        y of the edges, north to south.
    """

    across: Floats
    down: Floats

    @classmethod
    def of(cls, grid: Grid, origin: Floats) -> Lattice:
        """Return the edges of the compartments."""
        across = (grid.west - origin[0]) + np.arange(grid.columns + 1) * grid.cell_size
        down = (grid.south - origin[1]) + np.arange(grid.rows, -1, -1) * grid.cell_size
        return cls(across, down)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.down) - 1, len(self.across) - 1

    @property
    def cell_size(self) -> float:
        """Side of a compartment."""
        return float(self.across[1] - self.across[0])

    def halved(self) -> Lattice:
        """Join compartments two by two; the last ones keep the grid's edge."""
        across, down = self.across[::2], self.down[::2]
        if len(self.across) % 2 == 0:
            across = np.append(across, self.across[-1])
        if len(self.down) % 2 == 0:
            down = np.append(down, self.down[-1])
        return Lattice(across, down)


@dataclass(frozen=True, eq=False)
class Stack:
    """Blocks, ordered by layer and, within it, by compartment.

    Attributes
    ----------
    lattice : Lattice
    layer : ndarray of shape (n,), int64
    compartment : ndarray of shape (n,), int64
        row * columns + column in the lattice; row 0 is north.
    bottom, top : ndarray of shape (n,), float64
        Local elevations, metres.
    standing : ndarray of shape (n,), bool
        Whether the block is a column on the base plane.
    vertical : ndarray of shape (n,), bool
        Whether it is a wall.
    """

    lattice: Lattice
    layer: Integers
    compartment: Integers
    bottom: Floats
    top: Floats
    standing: NDArray[np.bool_]
    vertical: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.layer)


def step_field(result: Reconstruction, origin: Floats, visible: Collection[int], stride: int = 1) -> Stack:
    """Return the blocks of the visible layers, each over its own compartment.

    Parameters
    ----------
    result : Reconstruction
    origin : ndarray of shape (3,)
        Scan coordinates, metres.
    visible : collection of int
        Layers, -1 for the pillars in none.
    stride : int
        Every how manieth row and column of compartments is drawn, as large as all of them.
    """
    field, some = result.field, thinned(result, stride)
    lattice, layer = Lattice.of(some.grid, origin), result.layering.layer[some.pillars]
    elevation = field.elevation[some.pillars]
    chosen = _ordered(layer, visible)
    shift = field.compartments.lowest - origin[2]
    standing = _standing(some.compartment, layer, hide_unassigned=UNASSIGNED not in visible)[chosen]
    top = elevation[chosen]
    bottom = np.minimum(field.lows(some.pillars[chosen]), top - THINNEST * lattice.cell_size)
    bottom = np.maximum(bottom, _ceiling_below(some.compartment, elevation)[chosen])
    bottom += shift
    bottom[standing] = result.base_elevation - origin[2]
    vertical = field.vertical[some.pillars[chosen]]
    return Stack(lattice, layer[chosen], some.compartment[chosen], bottom, top + shift, standing, vertical)


def own_columns(result: Reconstruction, layer: Layer, origin: Floats) -> Stack:
    """Return one layer's pillars, every one of them standing on the base plane."""
    compartment = result.field.compartment[layer.pillars]
    count, base = len(compartment), result.base_elevation - origin[2]
    return Stack(
        Lattice.of(result.field.compartments.grid, origin),
        np.full(count, layer.index),
        compartment,
        np.full(count, base),
        base + layer.heights,
        np.ones(count, bool),
        result.field.vertical[layer.pillars],
    )


def solids(result: Reconstruction, layer: Layer, origin: Floats) -> Stack:
    """Return the pillars of a layer of obstacles, from their lowest points up."""
    field, pillars = result.field, layer.pillars
    shift = field.compartments.lowest - origin[2]
    return Stack(
        Lattice.of(field.compartments.grid, origin),
        np.full(len(pillars), layer.index),
        field.compartment[pillars],
        field.lows(pillars) + shift,
        field.elevation[pillars] + shift,
        np.zeros(len(pillars), bool),
        field.vertical[pillars],
    )


def coarser(stack: Stack) -> Stack:
    """Join the blocks of a layer two by two compartments: the highest top, the lowest bottom."""
    _, columns = stack.lattice.shape
    lattice = stack.lattice.halved()
    row, column = np.divmod(stack.compartment, columns)
    across = lattice.shape[1]
    # Layers first, so that blocks stay in order; the numbering starts at Unassigned.
    key = ((stack.layer - UNASSIGNED) * lattice.shape[0] + row // 2) * across + column // 2
    order = np.argsort(key, kind="stable")
    key = key[order]
    starts = np.flatnonzero(np.diff(key, prepend=-1))
    if not len(starts):
        return Stack(lattice, *(getattr(stack, name) for name in _COLUMNS))
    standing = np.add.reduceat(stack.standing[order], starts, dtype=np.int64)
    mostly = standing * 2 >= np.diff(np.append(starts, len(key)))
    lowest = np.where(stack.standing & ~_spread(mostly, starts, order), stack.top, stack.bottom)
    return Stack(
        lattice,
        stack.layer[order[starts]],
        key[starts] % (lattice.shape[0] * across),
        np.minimum.reduceat(lowest[order], starts),
        np.maximum.reduceat(stack.top[order], starts),
        mostly,
        np.logical_or.reduceat(stack.vertical[order], starts),
    )


_COLUMNS = ("layer", "compartment", "bottom", "top", "standing", "vertical")


def _spread(group: NDArray[np.bool_], starts: Integers, order: Integers) -> NDArray[np.bool_]:
    """Give every block what its group has."""
    spread = np.empty(len(order), bool)
    spread[order] = np.repeat(group, np.diff(np.append(starts, len(order))))
    return spread


def _ordered(layer: Integers, visible: Collection[int]) -> Integers:
    members = [np.flatnonzero(layer == shown) for shown in sorted(set(visible))]
    return np.concatenate([np.zeros(0, np.int64), *members])


def _standing(compartment: Integers, layer: Integers, *, hide_unassigned: bool) -> NDArray[np.bool_]:
    """Mask of the lowest pillar of each compartment; one in no layer holds nothing up unless it is shown."""
    standing = _leads(compartment)
    if hide_unassigned:
        there = np.flatnonzero(layer != UNASSIGNED)
        standing[there[_leads(compartment[there])]] = True
    return standing


def _ceiling_below(compartment: Integers, elevation: Floats) -> Floats:
    """Elevation of the pillar beneath each one, above the lowest point; below everything for the lowest."""
    below = np.empty(len(elevation))
    below[1:] = elevation[:-1]
    below[_leads(compartment)] = -np.inf
    return below


def _leads(compartment: Integers) -> NDArray[np.bool_]:
    """Mask of the first of each run of the same compartment."""
    leads = np.ones(len(compartment), bool)
    np.not_equal(compartment[1:], compartment[:-1], out=leads[1:])
    return leads
