"""How far off filled heights are likely to be: measured ground is hidden, filled, and compared.

What was filled cannot be compared with a scan that has no points there. So patches shaped like the holes that
were filled are hidden where everything was measured, as near to those holes as they fit, and filled by the
same method. That is an estimate: ground that was seen is often easier than ground that was not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.fidelity.patches import patches_like
from stepfield.filling import Filled, Ground, Method, elevations_in, fitting
from stepfield.grid import Grid
from stepfield.holes import Holes

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: With fewer patches nothing is said.
LEAST_PATCHES = 8
#: Compartments around a patch that its filling depends on, at most.
MARGIN = 4


@dataclass(frozen=True, eq=False)
class Hidden:
    """Errors of measured heights that were hidden and filled; arrays are read-only.

    Attributes
    ----------
    patches : int
        How many were hidden.
    errors : ndarray of shape (n,), float64
        How far each filled height is from the measured one, metres, ascending.
    weights : ndarray of shape (n,), float64
        How many filled compartments each stands for.
    """

    patches: int
    errors: Floats
    weights: Floats

    @classmethod
    def of(cls, patches: int, errors: Floats, weights: Floats) -> Hidden:
        """Sort errors."""
        order = np.argsort(errors, kind="stable")
        errors, weights = errors[order], weights[order]
        for array in (errors, weights):
            array.flags.writeable = False
        return cls(patches, errors, weights)

    @classmethod
    def joined(cls, those: Sequence[Hidden]) -> Hidden | None:
        """Join those of several layers; None if there are none."""
        if not those:
            return None
        errors = np.concatenate([each.errors for each in those])
        weights = np.concatenate([each.weights for each in those])
        return cls.of(sum(each.patches for each in those), errors, weights)

    @property
    def rmse(self) -> float:
        """Root of the mean square, metres."""
        return float(np.sqrt(np.average(np.square(self.errors), weights=self.weights)))

    @property
    def median(self) -> float:
        """What half of the filled heights are likely to be within, metres."""
        return self.within(0.5)

    @property
    def p95(self) -> float:
        """What 95 of 100 filled heights are likely to be within, metres."""
        return self.within(0.95)

    def within(self, share: float) -> float:
        """Return the error that a share of the filled heights do not exceed, metres."""
        reached = np.cumsum(self.weights)
        at = np.searchsorted(reached, share * reached[-1] * (1 - 1e-12))
        return float(self.errors[min(at, len(self.errors) - 1)])

    def as_dict(self) -> dict[str, float]:
        """Return the figures by name."""
        return {
            "patches": self.patches,
            "pixels": len(self.errors),
            "rmse": self.rmse,
            "median": self.median,
            "p95": self.p95,
        }


def hidden_errors(
    grid: Grid,
    layers: Sequence[Ground],
    index: int,
    found: Holes,
    filled: Filled,
    method: Method,
    clearance: float,
) -> Hidden | None:
    """Hide patches of one layer's measured ground, fill them, and say how far off that is.

    Parameters
    ----------
    grid : Grid
    layers : sequence of Ground
        As they were filled.
    index : int
        Of the layer.
    found : Holes
        Of the layer.
    filled : Filled
        In that layer.
    method : str
    clearance : float
        Least vertical distance from other layers, metres: what comes nearer is not filled, nor counted here.

    Returns
    -------
    Hidden or None
        None where too few patches fit into what was measured to tell.
    """
    raster = np.full((grid.rows, grid.columns), np.nan)
    raster.ravel()[layers[index].compartment] = layers[index].top
    patches = patches_like(grid, raster, found, filled.compartment)
    if len(patches) < LEAST_PATCHES:
        return None
    compartment = np.concatenate([place for _, place in patches])
    weights = np.concatenate([np.full(len(place), weight) for weight, place in patches])
    measured = raster.ravel()[compartment]
    raster.ravel()[filled.compartment] = filled.elevation  # holes beside a patch are filled, too
    span = float(layers[index].top.min()), float(layers[index].top.max())
    elevation = np.concatenate([_refilled(grid, raster, place, method, span) for _, place in patches])
    fits = fitting(layers, index, compartment, elevation, clearance)
    if not fits.any():
        return None
    errors = np.abs(elevation - measured)
    weights = weights[fits] * (len(filled.compartment) / weights[fits].sum())
    return Hidden.of(len(patches), errors[fits], weights)


def _refilled(
    grid: Grid, raster: Floats, place: Integers, method: Method, span: tuple[float, float]
) -> Floats:
    """Return what a method makes of a place when it is hidden, in a layer with such a span of elevations."""
    row, column = grid.row_column(place)
    top, left = max(row.min() - MARGIN, 0), max(column.min() - MARGIN, 0)
    window = raster[top : row.max() + MARGIN + 1, left : column.max() + MARGIN + 1]
    # No method goes beyond what the layer spans: two compartments, far enough away, say how much that is.
    window = np.pad(window, ((0, MARGIN), (0, 0)), constant_values=np.nan)
    window[-1, :2] = span
    hole = (row - top) * window.shape[1] + column - left
    window.ravel()[hole] = np.nan
    known = np.flatnonzero(~np.isnan(window))
    layer = Ground(known, window.ravel()[known], window.ravel()[known])
    return elevations_in(
        Grid(0.0, 0.0, grid.cell_size, window.shape[1], window.shape[0]), layer, hole, method
    )
