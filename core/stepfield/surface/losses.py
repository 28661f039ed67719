"""What a vertex a pixel costs: the area and the surfaces that a simulator's reconstruction loses (6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.links import linked
from stepfield.surface.simulator import simulator_quads

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Loss:
    """What becomes of one layer.

    Attributes
    ----------
    occupied_area : float
        Of the compartments of its pillars: what a true surface covers; square metres, as all areas.
    edges_area : float
        What the `edges` reconstruction covers.
    simulator_area : float
        What a simulator draws of the height-map: a vertex a pixel.
    surfaces : int
        Connected surfaces of the layer: pillars linked with neighbours of the same layer.
    vanished : int
        Those of which a simulator draws nothing.
    """

    occupied_area: float
    edges_area: float
    simulator_area: float
    surfaces: int
    vanished: int


def losses(grid: Grid, layers: Sequence[tuple[Integers, Floats]], link_step: float) -> list[Loss]:
    """Tell what the reconstructions of layers cover.

    Parameters
    ----------
    grid : Grid
    layers : sequence of tuple of ndarray
        Compartments, ascending, and elevations (metres) of each layer's pillars.
    link_step : float
        Greatest difference in elevation of two neighbours that continue each other, metres.

    Returns
    -------
    list of Loss
        One a layer.
    """
    return [_loss(grid, compartment, top, link_step) for compartment, top in layers]


def _loss(grid: Grid, compartment: Integers, top: Floats, link_step: float) -> Loss:
    square = grid.cell_size**2
    quads = simulator_quads(grid, compartment)
    surface = _surfaces(grid, compartment, top, link_step)
    count = int(surface.max(initial=-1)) + 1
    seen = np.zeros(count, bool)
    seen[surface[quads.ravel()]] = True
    covered = len(compartment) * square  # a square a compartment, which the tests hold the mesh against
    return Loss(covered, covered, len(quads) * square, count, count - int(seen.sum()))


def _surfaces(grid: Grid, compartment: Integers, top: Floats, link_step: float) -> Integers:
    """Number the connected surfaces of a layer, one a pillar."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not len(top):
        return np.zeros(0, np.int64)
    one, other = np.concatenate(linked(grid, compartment, top - top.min(), link_step)).T
    graph = coo_array((np.ones(len(one), np.int8), (one, other)), shape=(len(top), len(top)))
    surface: Integers = connected_components(graph, directed=False)[1].astype(np.int64)
    return surface
