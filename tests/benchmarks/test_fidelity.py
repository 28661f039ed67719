"""Fidelity: vertical and nearest distances of many points beside one pass over them, and live."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from tests.benchmarks.conftest import POINTS, Table, seconds
from tests.conftest import scan_of

from stepfield.fidelity import Way, compare_result, layers_of, measure, surface_of
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.progress import silent
from stepfield.reconstruction import Reconstruction
from stepfield_app.feeds.fidelity_feed import DRAWN
from stepfield_app.scenes.fidelity import fidelity_facts

#: Of the live figures.
LIVE = 1_000_000
CELL, TOLERANCE = 0.5, 0.3


def built(points: NDArray[np.float32], folder: Path) -> Reconstruction:
    path = folder / f"storeys-{len(points)}.npy"
    np.save(path, points)
    parameters = Parameters(cell_size=CELL, layer_tolerance=TOLERANCE)
    return Pipeline().run([path], parameters)


def test_live(storeys: NDArray[np.float32], table: Table, folder: Path) -> None:
    points = storeys[:LIVE].copy()
    result = built(points, folder)
    floor = seconds(lambda: points.sum())
    name = f"{len(points) / 1e6:g} M points, {len(result.field) / 1e3:.0f} k pillars"
    live = seconds(lambda: fidelity_facts(result, DRAWN, silent), 5)
    table.add(f"fidelity live (a draw), {name}", live, "one pass over the points", floor, "< 0.4 s")
    whole = seconds(lambda: fidelity_facts(result, None, silent))
    table.add(f"fidelity of all, {name}", whole, "one pass over the points", floor)


def test_distances(storeys: NDArray[np.float32], table: Table, folder: Path) -> None:
    ways: tuple[Way, ...] = ("edges", "simulator", "pillars")
    for count in sorted({min(LIVE, POINTS), POINTS}):
        points = storeys[:count].copy()
        result, scan = built(points, folder), scan_of(points)
        floor = seconds(lambda points=points: points.sum())  # type: ignore[misc]
        for way in ways:
            surface = surface_of(result.field.compartments.grid, layers_of(result), way, TOLERANCE)
            took = seconds(lambda surface=surface, scan=scan: measure(scan, surface), 1)  # type: ignore[misc]
            name = f"vertical and nearest to {way}, {count / 1e6:g} M points"
            table.add(name, took, "one pass over the points", floor)
        took = seconds(lambda result=result: compare_result(result), 1)  # type: ignore[misc]
        table.add(f"all of a comparison, {count / 1e6:g} M points", took, "one pass over the points", floor)
