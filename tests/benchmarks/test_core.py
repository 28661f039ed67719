"""The core in memory: each stage beside the floor of what any program must do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.benchmarks.conftest import POINTS, Table, seconds
from tests.conftest import scan_of

from stepfield.compartments import sort_into_compartments
from stepfield.layers import classify
from stepfield.links import link
from stepfield.parameters import Parameters
from stepfield.pillars import StepField, build_pillars
from stepfield.pipeline import Pipeline
from stepfield.synth import synthesise

CELL, TOLERANCE = 0.25, 0.3


def test_step_field(storeys: NDArray[np.float32], table: Table) -> None:
    keys = np.random.default_rng(0).integers(0, 2**62, POINTS).astype(np.uint64)
    sort = seconds(lambda: np.sort(keys))
    one_pass = seconds(lambda: storeys.sum())
    cloud = scan_of(storeys)
    built = seconds(lambda: build_pillars(sort_into_compartments(cloud, CELL), TOLERANCE))
    millions = f"{POINTS / 1e6:g} M"
    table.add(f"step-field from {millions} points", built, "numpy sort of as many uint64", sort, "<= 3")
    table.add(f"step-field from {millions} points", built, "one pass over the points", one_pass)
    compartments = sort_into_compartments(cloud, CELL)
    again = seconds(lambda: build_pillars(compartments, 0.2), 5)
    table.add("a new tolerance", again, "the build above", built, "<= 0.05")


def test_new_alpha(storeys: NDArray[np.float32], table: Table, folder: Path) -> None:
    path = folder / "storeys.npy"
    np.save(path, storeys)
    pipeline, parameters = Pipeline(), Parameters(cell_size=CELL, layer_tolerance=TOLERANCE)
    whole = seconds(lambda: pipeline.run([path], parameters), 1)
    alphas = iter(np.linspace(0.1, 1, 100))
    again = seconds(lambda: pipeline.run([path], parameters.model_copy(update={"alpha": next(alphas)})), 10)
    table.add("a new alpha through the pipeline", again, "the whole pipeline", whole, "< 0.005 s")


def test_layering_and_links(table: Table) -> None:
    field = overlaid(500)
    floor = seconds(lambda: np.sort(field.elevation))
    name = f"{len(field) / 1e6:.2f} M pillars, 5 layers"
    table.add(
        f"elevation layering, {name}",
        seconds(lambda: classify(field)),
        "sort of their heights",
        floor,
        "< 0.5 s",
    )
    everywhere = np.ones(len(field), bool)
    table.add(f"links, {name}", seconds(lambda: link(field, everywhere, 0.3)), "sort of their heights", floor)


@pytest.mark.parametrize(("side", "target"), [(224, "< 0.25 s"), (500, "< 1.5 s"), (1581, "< 16 s")])
def test_layering_by_surface(side: int, target: str, table: Table) -> None:
    """Links included, as a new tolerance needs them anew."""
    field = overlaid(side)
    floor = seconds(lambda: np.sort(field.elevation))
    name = f"surface layering with links, {len(field) / 1e6:.2f} M pillars"
    took = seconds(lambda: classify(field, "surface"), 3 if side < 1000 else 1)
    table.add(name, took, "sort of their heights", floor, target)


@pytest.mark.parametrize(("scene", "cell"), [("ramp", 0.032), ("rubble", 0.05), ("rubble", 0.035)])
def test_layering_of_a_tangle_by_surface(scene: str, cell: float, table: Table) -> None:
    """Surfaces that hang together in loops, at cells that hold few points: what takes longest to cut."""
    field = build_pillars(sort_into_compartments(scan_of(synthesise(scene, 8_000_000).points), cell), 0.3)
    floor = seconds(lambda: np.sort(field.elevation))
    name = f"surface layering, {scene}, {len(field) / 1e6:.2f} M pillars"
    table.add(
        name, seconds(lambda: classify(field, "surface"), 1), "sort of their heights", floor, "< 1.5 s/M"
    )


def overlaid(side: int) -> StepField:
    """Five undulating surfaces over each other, each seen in four compartments of five."""
    rng = np.random.default_rng(1)
    east, north = (a.ravel() + 0.5 for a in np.meshgrid(np.arange(side), np.arange(side)))
    stacks = [np.c_[east, north, np.full(side**2, 2.0 * k) + 0.3 * np.sin(east / 30)] for k in range(5)]
    points = np.vstack(stacks)[rng.random(5 * side**2) < 0.8]
    return build_pillars(sort_into_compartments(scan_of(points), 1.0), 0.3)
