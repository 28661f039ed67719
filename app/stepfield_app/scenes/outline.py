"""Outlines of chosen pillars in 3-D: where the chosen ones end, at the height of their tops.

A side of a top belongs to the outline when no chosen pillar of the neighbouring compartment is near in
height. Where two such sides meet, a line goes down as far as the block can be seen to go.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import UNASSIGNED
from stepfield.pillars import StepField
from stepfield.reconstruction import Reconstruction
from stepfield_app.scenes.arrays import frozen, in_chunks
from stepfield_app.scenes.stacks import THINNEST

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]
Singles = NDArray[np.float32]

#: More segments than this say nothing more: steps within the selection go first, then part of the rest.
MOST_SEGMENTS = 200_000
#: Sides of a compartment in the order of their ends: row and column steps to the neighbour.
NORTH, EAST, SOUTH, WEST = range(4)
STEPS = ((-1, 0), (0, 1), (1, 0), (0, -1))
#: Corners of a top, as steps of columns and rows from its north-west one; side i goes from corner i to i + 1.
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
#: Whole steps that elevations are told apart by, over the range of a scan.
FINE = 2**31 - 1


@dataclass(frozen=True, eq=False)
class Rim:
    """The outline of chosen pillars, local coordinates in metres, read-only.

    Attributes
    ----------
    edges : ndarray of shape (n, 2, 3), float32
        Sides of tops.
    corners : ndarray of shape (m, 2, 3), float32
        Lines down from them: only where blocks are drawn do they mean anything.
    cell_size : float
        Side of a compartment, metres.
    """

    edges: Singles
    corners: Singles
    cell_size: float

    @cached_property
    def whole(self) -> Singles:
        """Edges and corners, shape (n + m, 2, 3)."""
        return frozen(np.concatenate([self.edges, self.corners]))


def rim(
    result: Reconstruction,
    mask: Mask,
    origin: Floats,
    visible: tuple[int, ...] | None = None,
    most: int = MOST_SEGMENTS,
) -> Rim:
    """Return the outline of chosen pillars.

    Parameters
    ----------
    result : Reconstruction
    mask : ndarray of shape (P,), bool
        The chosen pillars.
    origin : ndarray of shape (3,)
        Scan coordinates of the local origin, metres.
    visible : tuple of int, optional
        Layers that are shown, -1 for Unassigned; pillars of others get no outline. All by default.
    most : int
        Edges at most, and as many corners.
    """
    tops = _Tops.of(result, np.flatnonzero(_shown(result, mask, visible)))
    ends = tops.ends(float(result.parameters.link_step))
    if np.count_nonzero(ends) > most:
        ends = tops.ends(np.inf)
    ground = _Ground(result)
    meets = [np.flatnonzero(ends[corner] & ends[corner - 1]) for corner in range(4)]
    edges = [tops.side(side, np.flatnonzero(ends[side])) for side in range(4)]
    corners = [tops.corner(corner, meets[corner], ground) for corner in range(4)]
    shift = _corner_of(result) - origin
    cell_size = result.field.compartments.grid.cell_size
    return Rim(_thinned(edges, shift, most), _thinned(corners, shift, most), cell_size)


def _thinned(parts: list[Floats], shift: Floats, most: int) -> Singles:
    made = np.concatenate(parts)
    made = made[:: max(1, -(-len(made) // most))]
    return frozen((made + shift).astype(np.float32))


def _shown(result: Reconstruction, mask: Mask, visible: tuple[int, ...] | None) -> Mask:
    layers = range(UNASSIGNED, len(result.layers))
    if visible is None or set(layers) <= set(visible):
        return mask
    is_shown = np.array([layer in visible for layer in (*layers[1:], UNASSIGNED)])  # row -1 is Unassigned
    shown: Mask = mask & is_shown[result.layering.layer]
    return shown


def _corner_of(result: Reconstruction) -> Floats:
    """South-west corner of the grid at the lowest point, scan coordinates: what heights are counted from."""
    compartments = result.field.compartments
    return np.array([compartments.grid.west, compartments.grid.south, compartments.lowest])


@dataclass(frozen=True, eq=False)
class _Tops:
    """Tops of the chosen pillars, ordered by compartment and, within it, from the lowest up.

    Attributes
    ----------
    field : StepField
    pillar, row, column : ndarray of shape (n,), int64
    key : ndarray of shape (n,), int64
        Compartment and elevation in one ascending number.
    elevation : ndarray of shape (n,), float64
        Metres above the lowest point.
    """

    field: StepField
    pillar: Integers
    row: Integers
    column: Integers
    key: Integers
    elevation: Floats
    per_metre: float

    @classmethod
    def of(cls, result: Reconstruction, pillar: Integers) -> _Tops:
        field = result.field
        compartment, elevation = field.compartment[pillar], field.elevation[pillar]
        per_metre = FINE / max(float(elevation.max(initial=0.0)), 1e-30)
        key = (compartment << 32) + (elevation * per_metre).astype(np.int64)
        row, column = field.compartments.grid.row_column(compartment)
        return cls(field, pillar, row, column, key, elevation, per_metre)

    def ends(self, step: float) -> Mask:
        """Sides on which no chosen pillar of the neighbouring compartment is within ``step``; (4, n)."""
        ends = np.ones((4, len(self.pillar)), bool)
        reach = int(min(step * self.per_metre * (1 + 1e-9), FINE)) + 1

        def look(part: slice) -> None:
            for side in range(4):
                ends[side, part] = self._ends(side, part, reach)

        in_chunks(len(self.pillar), look)
        return ends

    def _ends(self, side: int, part: slice, reach: int) -> Mask:
        down, right = STEPS[side]
        grid = self.field.compartments.grid
        row, column = self.row[part] + down, self.column[part] + right
        there = (row * grid.columns + column) << 32
        height = self.key[part] & np.int64(0xFFFFFFFF)
        first = np.searchsorted(self.key, there + np.maximum(height - reach, 0))
        found = self.key[np.minimum(first, len(self.key) - 1)]
        is_near = (first < len(self.key)) & (found <= there + np.minimum(height + reach, FINE))
        ends: Mask = ~is_near | (column < 0) | (column >= grid.columns)
        return ends

    def side(self, side: int, chosen: Integers) -> Floats:
        """Return one side of some of the tops, shape (m, 2, 3), metres from the grid's corner."""
        made = np.empty((len(chosen), 2, 3))
        for end in range(2):
            self._place(made[:, end], (side + end) % 4, chosen)
            made[:, end, 2] = self.elevation[chosen]
        return made

    def corner(self, corner: int, chosen: Integers, ground: _Ground) -> Floats:
        """Return lines down from a corner of some of the tops."""
        made = np.empty((len(chosen), 2, 3))
        for end in range(2):
            self._place(made[:, end], corner, chosen)
        made[:, 0, 2] = self.elevation[chosen]
        sides = [
            (self.row[chosen] + STEPS[i][0], self.column[chosen] + STEPS[i][1]) for i in (corner, corner - 1)
        ]
        made[:, 1, 2] = ground.foot(self.pillar[chosen], self.elevation[chosen], sides)
        return made[made[:, 1, 2] < made[:, 0, 2]]

    def _place(self, places: Floats, corner: int, chosen: Integers) -> None:
        grid, (right, down) = self.field.compartments.grid, CORNERS[corner]
        places[:, 0] = (self.column[chosen] + right) * grid.cell_size
        places[:, 1] = (grid.rows - self.row[chosen] - down) * grid.cell_size


class _Ground:
    """How far down a block can be seen: to its own bottom, or to what stands lower beside it."""

    def __init__(self, result: Reconstruction) -> None:
        self._field = result.field
        self._base = result.base_elevation - result.field.compartments.lowest

    def foot(self, pillar: Integers, top: Floats, sides: list[tuple[Integers, Integers]]) -> Floats:
        """Elevations at which lines down from ``top`` end."""
        field = self._field
        bottom = np.minimum(field.low[pillar], top - THINNEST * field.compartments.grid.cell_size)
        bottom[self._is_lowest(pillar)] = self._base
        beside = np.minimum(*(self._standing(row, column) for row, column in sides))
        return np.maximum(bottom, np.minimum(beside, top))

    def _is_lowest(self, pillar: Integers) -> Mask:
        field = self._field
        is_lowest: Mask = (pillar == 0) | (field.compartment[pillar] != field.compartment[pillar - 1])
        return is_lowest

    def _standing(self, row: Integers, column: Integers) -> Floats:
        """Elevation of the lowest pillar of compartments; that of the base plane where there is none."""
        field = self._field
        grid, occupied = field.compartments.grid, field.compartments.occupied
        compartment = row * grid.columns + column
        place = np.minimum(np.searchsorted(occupied, compartment), len(occupied) - 1)
        there = (occupied[place] == compartment) & (column >= 0) & (column < grid.columns)
        return np.where(there, field.elevation[field.first[place]], self._base)
