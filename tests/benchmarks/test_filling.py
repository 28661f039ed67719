"""Ways of filling holes side by side: how far off each is likely to be, and is where the truth is known.

The table is that of SURFACES.md: ``python -m pytest tests/benchmarks/test_filling.py -s`` prints it anew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from tests.benchmarks.conftest import REAL, Table, seconds

from stepfield.fidelity import Hidden, Surface, filled_figures, measure, result_filled_figures, true_mesh
from stepfield.filling import Ground, Method, fill
from stepfield.grid import Grid
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction
from stepfield.scan.write import write
from stepfield.synth import synthesise

#: Scenes of whose surfaces a scanner leaves enough unseen.
SCENES = ("table", "stairs", "cylinder", "bridge", "ramp", "rubble")
METHODS: tuple[Method, ...] = get_args(Method)
#: Longest sides of the holes that are filled, compartments.
SIZES = (5, 20)
HEAD = (
    "| scan | holes up to, cells | pixels in holes | median, cm: nearest, linear, inpaint "
    "| 95 % within, cm | RMSE, cm |\n|---|---|---|---|---|---|"
)
#: Side of the layer that is timed, compartments.
SIDE = 1000


@pytest.mark.parametrize("name", SCENES)
def test_scene(name: str, lines: list[str], tmp_path: Path) -> None:
    path = tmp_path / f"{name}.npy"
    write(path, synthesise(name, scanner=True, seed=7).points, {})
    lines += rows(f"{name}, scanned", path, Surface.of([true_mesh(name)]))


@pytest.mark.parametrize("name", REAL)
def test_real(name: str, lines: list[str], real_scan: Callable[[str], Path]) -> None:
    lines += rows(REAL[name], real_scan(name))


@pytest.mark.parametrize("method", METHODS)
def test_time(method: Method, table: Table) -> None:
    """A layer of a million pixels, an eighth of them in thousands of holes."""
    from scipy.ndimage import gaussian_filter

    random, grid = np.random.default_rng(1), Grid(0.0, 0.0, 0.1, SIDE, SIDE)
    raster = 10 * gaussian_filter(random.normal(size=(SIDE, SIDE)), 8)
    holes = gaussian_filter(random.normal(size=(SIDE, SIDE)), 2)
    raster[holes > np.quantile(holes, 7 / 8)] = np.nan
    there = np.flatnonzero(~np.isnan(raster))
    elevation = raster.ravel()[there]
    filled = fill(grid, [Ground(there, elevation, elevation)], "linear", 2.0, 0.3)
    layers = [(there, elevation)]
    took = seconds(lambda: filled_figures(grid, layers, {}, filled, method, 0.3))
    floor = seconds(lambda: fill(grid, [Ground(there, elevation, elevation)], "linear", 2.0, 0.3))
    table.add(
        f"figures of what was filled, {method}, 1 M pixels", took, "filling it, linear", floor, "< 0.3 s"
    )


def rows(name: str, path: Path, truth: Surface | None = None) -> Iterator[str]:
    """Compare the methods on one scan: what is likely, and what is true."""
    pipeline = Pipeline()
    cell = float(pipeline.run([path], Parameters()).parameters.cell_size)
    for size in SIZES:
        likely, true, pixels, holes = [], [], 0, 0
        for method in METHODS:
            result = pipeline.run([path], Parameters(fill=method, fill_size=size * cell))
            found = result_filled_figures(result)
            pixels, holes = sum(each.pixels for each in found), sum(each.holes for each in found)
            joined = Hidden.joined([each.hidden for each in found if each.hidden is not None])
            likely.append((joined.median, joined.p95, joined.rmse) if joined else (np.nan,) * 3)
            true += [] if truth is None else [against(result, truth)]
        head = f"| {name} | {size} | {pixels} in {holes}"
        yield f"{head} | {' | '.join(centimetres(*each) for each in zip(*likely, strict=True))} |"
        if true:
            cells = " | ".join(centimetres(*each) for each in zip(*true, strict=True))
            yield f"| – from the truth | {size} | | {cells} |"


def against(result: Reconstruction, truth: Surface) -> tuple[float, float, float]:
    """Median, 95 % and RMSE of all that was filled, straight up or down to the truth, metres."""
    compartments, places = result.field.compartments, []
    for layer in result.layers:
        x, y = (np.mean(lines, axis=1) for lines in compartments.grid.lines(layer.filled.compartment))
        places.append(np.column_stack([x, y, layer.filled.elevation + compartments.lowest]))
    off = np.abs(measure(np.concatenate(places), truth).up)
    off = off[np.isfinite(off)]
    return float(np.median(off)), float(np.quantile(off, 0.95)), float(np.sqrt(np.mean(np.square(off))))


def centimetres(*metres: float) -> str:
    return ", ".join(f"{100 * each:.1f}" if np.isfinite(each) else "–" for each in metres)
