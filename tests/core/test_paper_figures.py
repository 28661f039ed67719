"""The four scenes of the paper's section 6 behave as its figures 3 to 6 show."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray
from tests.conftest import scan_of

from stepfield.compartments import sort_into_compartments
from stepfield.layers import Layering, classify
from stepfield.links import link
from stepfield.pillars import StepField, build_pillars
from stepfield.surface import as_simulator
from stepfield.synth import synthesise

CELL, TOLERANCE = 0.1, 0.3


@functools.cache
def figure(scene: str) -> tuple[StepField, Layering, NDArray[np.int64], dict[str, int]]:
    """Reconstruct a scene; the true surface of each pillar is that of the nearest points."""
    made = synthesise(scene, noise=0.003, seed=7)
    scan = scan_of(made.points)
    field = build_pillars(sort_into_compartments(scan, CELL), TOLERANCE)
    names = {name: number for number, name in enumerate(made.names)}
    return field, classify(field), true_surface(field, made.points, made.surface), names


def true_surface(
    field: StepField, points: NDArray[np.float64], surface: NDArray[np.int32]
) -> NDArray[np.int64]:
    """Surface of each pillar's points; -1 where they come from several."""
    low = points.min(axis=0)
    at = field.compartments.grid.compartment(points[:, 0] - low[0], points[:, 1] - low[1])
    order = np.lexsort((points[:, 2], at))
    first = np.minimum.reduceat(surface[order], field.start[:-1])
    last = np.maximum.reduceat(surface[order], field.start[:-1])
    return np.where(first == last, first, -1)


def layers_of(layering: Layering, chosen: NDArray[np.bool_]) -> dict[int, float]:
    """Share of the chosen pillars in each layer that holds more than 2 % of them."""
    shares = np.bincount(layering.layer[chosen], minlength=layering.count) / np.count_nonzero(chosen)
    return {layer: float(share) for layer, share in enumerate(shares) if share > 0.02}


def test_figure_3_three_planes_are_three_homogeneous_layers() -> None:
    field, layering, surface, names = figure("three-planes")
    assert layering.count == 3
    for name, number in names.items():
        assert list(layers_of(layering, surface == number)) == [number], name
        spread = np.ptp(field.elevation[layering.layer == number])
        assert spread < 0.03, f"the layer of the {name} is not flat"
    assert len(layering.seams(link(field, layering.layer >= 0, TOLERANCE))) == 0


def test_figure_4_the_inclined_plane_splits_over_the_three_layers_it_crosses() -> None:
    field, layering, surface, names = figure("inclined-plane")
    inclined = surface == names["inclined plane"]
    crossed = layers_of(layering, inclined)
    assert len(crossed) == 3, "the paper's inclined plane is reconstructed with three layers"
    for name in ("lowest plane", "middle plane", "highest plane"):
        assert len(layers_of(layering, surface == names[name])) == 1, (
            f"the {name} is not reconstructed correctly"
        )
    means = [field.elevation[inclined & (layering.layer == layer)].mean() for layer in crossed]
    assert np.all(np.diff(means) > 0), "the pieces are not classified by elevation"


def test_figure_4_the_cuts_are_holes_in_the_simulators_surface() -> None:
    field, layering, surface, names = figure("inclined-plane")
    inclined = surface == names["inclined plane"]
    grid = field.compartments.grid
    pieces = 0.0
    for layer in range(layering.count):
        chosen = np.flatnonzero(inclined & (layering.layer == layer))
        if len(chosen):
            pieces += as_simulator(grid, field.compartment[chosen], field.elevation[chosen]).plan_area
    whole = np.flatnonzero(inclined)
    uncut = as_simulator(grid, field.compartment[whole], field.elevation[whole]).plan_area
    width = np.ptp(grid.centres(field.compartment[whole])[:, 1])
    assert uncut - pieces > 1.5 * width * CELL, "two cuts, each a compartment wide, must be missing"
    assert uncut - pieces < 4 * width * CELL, "the holes have the size of the pillars"
    assert len(layering.seams(link(field, layering.layer >= 0, TOLERANCE))) > 2 * 0.8 * width / CELL


def test_figure_5_where_the_inclined_plane_crosses_another_both_are_built_of_several_layers() -> None:
    field, layering, surface, names = figure("crossing-plane")
    assert len(layers_of(layering, surface == names["inclined plane"])) >= 3
    shares = [
        layers_of(layering, surface == names[f"{which} plane"]) for which in ("lowest", "middle", "highest")
    ]
    assert [len(share) for share in shares] == [1, 1, 2], "the crossed plane too is built with several layers"
    assert layering.unassigned <= 0.005 * len(field), "no data are lost"


def test_figure_6_the_cylinder_is_cut_into_a_lower_and_an_upper_half() -> None:
    field, layering, surface, names = figure("cylinder")
    cylinder = surface == names["cylinder"]
    assert len(layers_of(layering, cylinder)) == 2
    doubled = np.flatnonzero(cylinder & (field.rank > 0))
    below = doubled[np.isin(doubled - 1, np.flatnonzero(cylinder))] - 1
    above = below + 1
    assert len(below) > 100
    assert np.all(layering.layer[above] > layering.layer[below]), "one half is not above the other"
    for half in (below, above):
        fullest = np.bincount(layering.layer[half]).max()
        assert fullest >= 0.98 * len(half), "a half is scattered over several layers"


def test_a_table_stands_above_its_floor() -> None:
    field, layering, surface, names = figure("table")
    assert layering.count == 2
    assert layers_of(layering, surface == names["floor"]) == {0: 1.0}
    assert layers_of(layering, surface == names["table top"]) == {1: 1.0}
    under = np.isin(field.compartment, field.compartment[surface == names["table top"]])
    assert np.any(under & (layering.layer == 0)), "the floor under the table is missing"
