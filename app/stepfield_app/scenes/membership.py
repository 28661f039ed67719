"""Which pillar, and so which layer, a point belongs to."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.compartments import TICK_BITS
from stepfield.pillars import StepField
from stepfield.reconstruction import Reconstruction
from stepfield.scan import Scan
from stepfield_app.scenes.arrays import frozen, in_chunks
from stepfield_app.scenes.palette import UNASSIGNED_CODE, layer_codes

_BITS = np.uint64(TICK_BITS)
_HIGHEST = float(2**TICK_BITS - 1)


def point_codes(
    scan: Scan, result: Reconstruction, chosen: NDArray[np.int64] | None = None
) -> NDArray[np.uint8]:
    """Rows of a layer palette, one a point.

    A point of another scan than the result's own (before cropping, say, or all points where a preview used
    few) takes the nearest pillar of its compartment; one over no pillar counts as unassigned.

    Parameters
    ----------
    scan : Scan
    result : Reconstruction
    chosen : ndarray of shape (n,)
        Indices of the points asked for; all by default.

    Returns
    -------
    ndarray of shape (n,), uint8
    """
    field, own = result.field, scan is result.scan
    keys = _Keys(scan, field)
    pillars = None if chosen is None else _beneath(field, keys(chosen) >> _BITS)
    boundary = _boundaries(field, pillars)
    layers = result.layering.layer if pillars is None else result.layering.layer[pillars]
    codes_of = np.append(layer_codes(layers), UNASSIGNED_CODE)
    codes = np.empty(len(scan) if chosen is None else len(chosen), np.uint8)

    def fill(part: slice) -> None:
        key = keys(part if chosen is None else chosen[part])
        pillar = np.searchsorted(boundary, key, side="right") - 1
        if not own:
            pillar[~_meets(boundary, pillar, key)] = -1
        codes[part] = codes_of[pillar]

    in_chunks(len(codes), fill)
    return frozen(codes)


def _beneath(field: StepField, compartment: NDArray[np.uint64]) -> NDArray[np.int64]:
    """Indices of the pillars of compartments, ascending; a few of them are far less work than all."""
    grid = field.compartments.grid
    wanted = np.zeros(len(grid) + 1, bool)  # the last one stands for everything beyond the grid
    wanted[compartment.astype(np.int64)] = True
    return np.flatnonzero(wanted[field.compartment])


def _boundaries(field: StepField, pillars: NDArray[np.int64] | None) -> NDArray[np.uint64]:
    """Where each pillar takes over from the one below: half-way up the gap, packed with the compartment.

    Parameters
    ----------
    field : StepField
    pillars : ndarray or None
        Those of some compartments, ascending; all of them by default.
    """
    ticks = field.compartments.ticks
    some: Any = slice(None) if pillars is None else pillars
    start, end, compartment = field.start[:-1][some], field.start[1:][some], field.compartment[some]
    low, high = ticks[start].astype(np.uint64), ticks[end - 1].astype(np.uint64)
    boundary = low.copy()
    boundary[1:] = (high[:-1] + low[1:] + np.uint64(1)) // np.uint64(2)
    boundary[np.diff(compartment, prepend=-1) != 0] = 0
    packed: NDArray[np.uint64] = compartment.astype(np.uint64) << _BITS | boundary
    return packed


def _meets(
    boundary: NDArray[np.uint64], pillar: NDArray[np.int64], key: NDArray[np.uint64]
) -> NDArray[np.bool_]:
    if not len(boundary):  # all of these points lie beyond the grid
        return np.zeros(len(pillar), bool)
    same: NDArray[np.bool_] = (boundary[pillar] >> _BITS == key >> _BITS) & (pillar >= 0)
    return same


class _Keys:
    """Compartment and elevation of a scan's points, packed as the core packs them."""

    def __init__(self, scan: Scan, field: StepField) -> None:
        self.compartments = field.compartments
        self.grid = field.compartments.grid
        self.measures = [axis.measure() for axis in scan.axes]
        corner = (self.grid.west, self.grid.south, self.compartments.lowest)
        self.shifts = [axis.bounds()[0] - at for axis, at in zip(scan.axes, corner, strict=True)]

    def __call__(self, part: slice | NDArray[np.int64]) -> NDArray[np.uint64]:
        east, north, up = (
            measure(part) + shift for measure, shift in zip(self.measures, self.shifts, strict=True)
        )
        key = self.grid.compartment(east, north).astype(np.uint64)
        key[self._outside(east, north)] = len(self.grid)
        key <<= _BITS
        up /= self.compartments.tick
        np.rint(up, out=up)
        np.clip(up, 0, _HIGHEST, out=up)
        key |= up.astype(np.uint64)
        return key

    def _outside(self, east: NDArray[np.float64], north: NDArray[np.float64]) -> NDArray[np.bool_]:
        slack = self.grid.cell_size * 1e-6
        width, depth = self.grid.columns * self.grid.cell_size, self.grid.rows * self.grid.cell_size
        beyond: NDArray[np.bool_] = (east < -slack) | (north < -slack)
        beyond |= (east > width + slack) | (north > depth + slack)
        return beyond
