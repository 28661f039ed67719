"""Ways of layering and of reconstructing side by side, on the paper's figures and on real scans.

The table is that of SURFACES.md: ``python -m pytest tests/benchmarks/test_surfaces.py -s`` prints it anew.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.benchmarks.conftest import REAL

from stepfield.fidelity import Way, compare_result, layer_figures, layers_of
from stepfield.layers import Method, classify
from stepfield.links import link
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction
from stepfield.scan.write import write
from stepfield.synth import synthesise

#: The paper's figures 3 to 6 and the others that have a known answer.
SCENES = ("three-planes", "inclined-plane", "crossing-plane", "cylinder", "table", "bridge", "stairs", "ramp")
METHODS: tuple[Method, ...] = ("rank", "elevation", "surface")
WAYS: tuple[Way, Way] = ("simulator", "edges")
HEAD = (
    "| scan | layering | layers | seams | RMSE, cm: simulator, edges | 95 % within, cm | lost by simulator "
    "| surfaces lost | s |\n|---|---|---|---|---|---|---|---|---|"
)


@pytest.mark.parametrize("name", SCENES)
def test_scene(name: str, lines: list[str], tmp_path: Path) -> None:
    made = synthesise(name, noise=0.003, seed=7)
    path = tmp_path / f"{name}.npy"
    write(path, made.points, {})
    lines += rows(name, path, Parameters(cell_size=0.1, layer_tolerance=0.3))


def test_rubble(lines: list[str], tmp_path: Path) -> None:
    made = synthesise("rubble", scanner=True)
    path = tmp_path / "rubble.npy"
    write(path, made.points, {})
    lines += rows("rubble, scanned", path, Parameters())


@pytest.mark.parametrize("name", REAL)
def test_real(name: str, lines: list[str], real_scan: Callable[[str], Path]) -> None:
    lines += rows(REAL[name], real_scan(name), Parameters())


def rows(name: str, path: Path, parameters: Parameters) -> Iterator[str]:
    """Compare the methods on one scan, each reconstructed both ways."""
    pipeline = Pipeline()
    for method in METHODS:
        result = pipeline.run([path], parameters.model_copy(update={"layering": method}))
        took = classified_in(result, method)
        head = f"{name} | {method} | {len(result.layers)} | {len(result.seams)}"
        yield f"| {head} | {figures(result)} | {took:.2f} |"


def classified_in(result: Reconstruction, method: Method) -> float:
    """Seconds that classification takes, links included where it needs them."""
    field, step = result.field, float(result.parameters.link_step)
    start = time.perf_counter()
    classify(field, method, linked=lambda chosen: link(field, chosen, step))
    return time.perf_counter() - start


def figures(result: Reconstruction) -> str:
    """Fidelity of both ways of reconstructing, and what a simulator's loses; edges lose nothing."""
    simulator, edges = (compare_result(result, way).fidelity.nearest for way in WAYS)
    grid, step = result.field.compartments.grid, float(result.parameters.link_step)
    layers = layer_figures(grid, layers_of(result), step)
    occupied = sum(layer.occupied_area for layer in layers)
    lost = 1 - sum(layer.simulator_area for layer in layers) / occupied
    vanished, surfaces = (sum(each) for each in zip(*((x.vanished, x.surfaces) for x in layers), strict=True))
    rmse = f"{100 * simulator.rmse:.1f}, {100 * edges.rmse:.1f}"
    most = f"{100 * simulator.p95:.1f}, {100 * edges.p95:.1f}"
    return f"{rmse} | {most} | {lost:.1%} | {vanished} of {surfaces}"
