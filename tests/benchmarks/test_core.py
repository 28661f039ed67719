"""The core in memory: each stage beside the floor of what any program must do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from tests.benchmarks.conftest import POINTS, Table, seconds
from tests.conftest import scan_of

from stepfield.compartments import sort_into_compartments
from stepfield.layers import classify
from stepfield.links import link
from stepfield.parameters import Parameters
from stepfield.pillars import build_pillars
from stepfield.pipeline import Pipeline

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
    rng = np.random.default_rng(1)
    n = 500
    east, north = (a.ravel() + 0.5 for a in np.meshgrid(np.arange(n), np.arange(n)))
    stacks = [np.c_[east, north, np.full(n * n, 2.0 * k) + 0.3 * np.sin(east / 30)] for k in range(5)]
    points = np.vstack(stacks)[rng.random(5 * n * n) < 0.8]
    field = build_pillars(sort_into_compartments(scan_of(points), 1.0), 0.3)
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
