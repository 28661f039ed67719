"""The layers of a result as surfaces to measure from: flat pillars, a simulator's, or with their edges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.fidelity.surface import Surface
from stepfield.grid import Grid
from stepfield.parameters import Parameters
from stepfield.reconstruction import Reconstruction
from stepfield.surface import Mesh, as_edges, as_pillars, as_simulator

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Compartments, ascending, and elevations (scan coordinates, metres) of the pillars of each layer.
Layers = Sequence[tuple[Integers, Floats]]
#: Elevations at which the pillars of some layers begin, by their place: those of obstacles, which are solid.
Bottoms = Mapping[int, Floats]
NO_BOTTOMS: Bottoms = MappingProxyType({})
#: ``pillars``: a flat square a compartment. ``simulator``: a vertex a pixel, two triangles where four are
#: occupied. ``edges``: exactly the compartments, sharing corners where pillars continue each other.
Way = Literal["pillars", "simulator", "edges"]


def layers_of(result: Reconstruction) -> Layers:
    """Return the exported pillars of a result, layer by layer."""
    field = result.field
    return [
        (field.compartment[layer.pillars], layer.elevation + field.compartments.lowest)
        for layer in result.layers
    ]


def chosen_way(parameters: Parameters) -> Way:
    """Return the way of reconstruction that parameters ask for."""
    return parameters.reconstruction


def bottoms_of(result: Reconstruction) -> Bottoms:
    """Return where the pillars of a result's obstacles begin."""
    field = result.field
    return {
        layer.index: field.lows(layer.pillars) + field.compartments.lowest
        for layer in result.layers
        if layer.is_obstacles
    }


def meshes_of(
    grid: Grid, layers: Layers, way: Way, link_step: float, bottoms: Bottoms = NO_BOTTOMS
) -> list[Mesh]:
    """Make one mesh a layer.

    Parameters
    ----------
    grid : Grid
    layers : sequence of tuple of ndarray
        All layers of a step-field together.
    way : str
        How they are reconstructed.
    link_step : float
        Greatest difference in elevation of two neighbours that continue each other, metres.
    bottoms : mapping of int to ndarray
        Elevations at which the pillars of layers of obstacles begin: these are blocks.
    """
    surfaces = [layer for number, layer in enumerate(layers) if number not in bottoms]
    if way == "edges":
        drawn = iter(as_edges(grid, surfaces, link_step))
    else:
        make = _flat if way == "pillars" else as_simulator
        drawn = iter([make(grid, *layer) for layer in surfaces])
    return [
        as_pillars(grid, *layer, bottoms[number]) if number in bottoms else next(drawn)
        for number, layer in enumerate(layers)
    ]


def surface_of(
    grid: Grid,
    layers: Layers,
    way: Way,
    link_step: float,
    bottoms: Bottoms = NO_BOTTOMS,
    besides: Sequence[Mesh] = (),
) -> Surface:
    """Make the surface of layers, as :func:`meshes_of` does, to measure from.

    Its parts are the layers, then the meshes ``besides``: those of complex parts.
    """
    meshes = [*meshes_of(grid, layers, way, link_step, bottoms), *besides]
    if way != "simulator":
        return Surface.of(meshes, grid)
    half = grid.cell_size / 2  # between four pixels lies one square
    columns, rows = (max(count - 1, 1) for count in (grid.columns, grid.rows))
    return Surface.of(meshes, Grid(grid.west + half, grid.south + half, grid.cell_size, columns, rows))


def _flat(grid: Grid, compartment: Integers, top: Floats) -> Mesh:
    """Level squares at the pillars' tops."""
    x, y = grid.lines(compartment)
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = np.stack([np.column_stack([x[:, i], y[:, j], top]) for i, j in ring], axis=1)
    first = np.arange(len(compartment))[:, np.newaxis] * 4
    triangles = (first + np.array([0, 1, 2, 0, 2, 3])).reshape(-1, 3)
    return Mesh(corners.reshape(-1, 3), triangles)
