"""Filled holes in figures: how much of a layer nobody measured, and how far it may be trusted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stepfield.fidelity.figures import Distances
from stepfield.fidelity.hidden import Hidden, hidden_errors
from stepfield.fidelity.measure import measure
from stepfield.fidelity.reconstructions import Bottoms, Layers, bottoms_of, layers_of
from stepfield.fidelity.surface import Surface
from stepfield.filling import Filled, Ground, Method
from stepfield.grid import Grid
from stepfield.holes import holes
from stepfield.reconstruction import Reconstruction


@dataclass(frozen=True, eq=False)
class FilledFigures:
    """What was filled in a layer; areas in square metres.

    Attributes
    ----------
    pixels : int
        Compartments that have a height nobody measured.
    area : float
    holes : int
        Holes of the layer that were filled.
    open, open_area : int, float
        Holes that are left open at least in part, and how much of them.
    hidden : Hidden or None
        How far off the filled heights are likely to be; None where too little was measured to tell.
    truth : Distances or None
        How far off they are, straight up or down to the true surface, where that is known.
    """

    pixels: int
    area: float
    holes: int
    open: int
    open_area: float
    hidden: Hidden | None
    truth: Distances | None = None

    def as_dict(self) -> dict[str, Any]:
        """Return the figures by name, ready for JSON."""
        return {
            "pixels": self.pixels,
            "area": self.area,
            "holes": self.holes,
            "open": self.open,
            "open_area": self.open_area,
            "estimate": self.hidden and self.hidden.as_dict(),
            "truth": self.truth and self.truth.as_dict(),
        }


#: Of obstacles: between walls nothing is left open that could be ground.
NO_FIGURES = FilledFigures(0, 0.0, 0, 0, 0.0, None)


def filled_figures(
    grid: Grid,
    layers: Layers,
    bottoms: Bottoms,
    filled: Sequence[Filled],
    method: Method,
    clearance: float,
) -> tuple[FilledFigures, ...]:
    """Tell what was filled, and how far off that is likely to be; one a layer.

    Parameters
    ----------
    grid : Grid
    layers : sequence of tuple of ndarray
        Compartments, ascending, and elevations of each layer's pillars, metres.
    bottoms : mapping of int to ndarray
        Where the pillars of layers of obstacles begin.
    filled : sequence of Filled
        In each layer, elevations as those of the pillars.
    method : str
        How.
    clearance : float
        Least vertical distance from other layers that they were filled with, metres.
    """
    grounds = [
        Ground(compartment, bottoms.get(number, elevation), elevation, is_filled=number not in bottoms)
        for number, (compartment, elevation) in enumerate(layers)
    ]
    return tuple(
        _figures(grid, grounds, number, filled[number], method, clearance) for number in range(len(grounds))
    )


def result_filled_figures(result: Reconstruction) -> tuple[FilledFigures, ...]:
    """Tell what was filled in the layers of a result; nothing if holes were not to be filled."""
    chosen, compartments = result.parameters, result.field.compartments
    if chosen.fill == "none":
        return ()
    return filled_figures(
        compartments.grid,
        layers_of(result),
        bottoms_of(result),
        [
            Filled(layer.filled.compartment, layer.filled.elevation + compartments.lowest)
            for layer in result.layers
        ],
        chosen.fill,
        float(chosen.layer_tolerance),
    )


def with_truth(
    figures: FilledFigures, grid: Grid, filled: Filled, truth: Surface, tolerance: float
) -> FilledFigures:
    """Add how far what was filled is from the true surface that is nearest above or beneath."""
    if not len(filled.compartment):
        return figures
    x, y = (np.mean(lines, axis=1) for lines in grid.lines(filled.compartment))
    up = measure(np.column_stack([x, y, filled.elevation]), truth).up
    return replace(figures, truth=Distances.of(np.abs(up), tolerance))


def _figures(
    grid: Grid, layers: list[Ground], number: int, filled: Filled, method: Method, clearance: float
) -> FilledFigures:
    if not layers[number].is_filled:
        return NO_FIGURES
    found, cell = holes(grid, layers[number].compartment), grid.cell_size**2
    is_left = np.isin(found.compartment, filled.compartment, assume_unique=True, invert=True)
    left, pixels, hidden = len(np.unique(found.region[is_left])), len(filled.compartment), None
    if pixels:
        hidden = hidden_errors(grid, layers, number, found, filled, method, clearance)
    return FilledFigures(
        pixels=pixels,
        area=pixels * cell,
        holes=found.count - left,
        open=left,
        open_area=int(np.count_nonzero(is_left)) * cell,
        hidden=hidden,
    )
