"""Complex parts: height-maps alone, with a mesh of what they cannot hold, and a mesh of everything.

``python -m pytest tests/benchmarks/test_complex.py -s`` prints two tables a scene: which method meshes
complex parts best, and what the hybrid comes to at a tenth of the triangles of a full mesh.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.benchmarks.full_mesh import METHODS, evened, full_ball_pivoting, invented, poisson

from stepfield.complex_parts import build_complex_parts, without
from stepfield.complex_parts.build import _gathered
from stepfield.complex_parts.detection import detect
from stepfield.complex_parts.reducing import distances, reduced
from stepfield.complex_parts.residuals import residuals
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.progress import silent
from stepfield.reconstruction import Reconstruction
from stepfield.scan.write import write
from stepfield.surface import Mesh, sheets
from stepfield.synth import synthesise
from stepfield.targets.covering import covered

Floats = NDArray[np.float64]

SCENES = ("rubble", "data__room_scan1.pcd", "pye57__pumpAVisualReferenceImage.e57")
#: Compartments a side that a full mesh's points are apart: about as near as the scan's own.
FULL = 4
#: Share of a full mesh's triangles that the hybrid is to make do with.
TENTH = 0.1


@pytest.fixture(scope="module")
def find(tmp_path_factory: pytest.TempPathFactory, real_scan: Callable[[str], Path]) -> Callable[[str], Path]:
    """Find a scan, or make the one that is synthetic."""
    folder = tmp_path_factory.mktemp("scans")

    def found(name: str) -> Path:
        if name != "rubble":
            return real_scan(name)
        path = folder / "rubble.ply"
        if not path.exists():
            write(path, synthesise("rubble", scanner=True).points, {})
        return path

    return found


def reconstructed(path: Path) -> Reconstruction:
    """Run the method with everything as it comes."""
    return Pipeline().run([path], Parameters(complex_parts="mesh"))


@pytest.mark.parametrize("scene", SCENES)
def test_methods(scene: str, find: Callable[[str], Path]) -> None:
    """Which method meshes complex parts best, before any triangle is left out."""
    result = reconstructed(find(scene))
    job = _gathered(result, detect(result, residuals(result)), silent).job
    lines = [f"\n{scene}: {len(job.points):,} points of complex parts, {job.spacing:g} m apart"]
    lines.append(
        f"{'method':16}{'RMSE':>9}{'95 %':>9}{'triangles':>11}{'invented':>10}{'same':>6}{'seconds':>9}"
    )
    for name, method in METHODS.items():
        start = time.perf_counter()
        mesh = method(job.points, job.spacing)
        took = time.perf_counter() - start
        again = method(job.points, job.spacing)
        same = "yes" if _same(mesh, again) else "no"
        rmse, high = figures(distances(job.samples, mesh))
        lines.append(
            f"{name:16}{rmse:9.4f}{high:9.4f}{len(mesh.triangles):11,}"
            f"{invented(mesh, job.points, 2 * job.spacing):10.2%}{same:>6}{took:9.2f}"
        )
    print("\n".join(lines))  # noqa: T201 - printing is what a benchmark is for


@pytest.mark.parametrize("scene", SCENES)
def test_hybrid(scene: str, find: Callable[[str], Path]) -> None:
    """What each way comes to; distances in metres, from the scan's points to the nearest surface."""
    result = reconstructed(find(scene))
    cell, points = result.field.compartments.grid.cell_size, result.scan.points()
    full: dict[str, tuple[Mesh, float]] = {}
    fine = evened(points, cell / FULL)
    for name, method in {"ball pivoting": full_ball_pivoting, "Poisson": poisson}.items():
        start = time.perf_counter()
        full[name] = method(fine, cell / FULL), time.perf_counter() - start
    start = time.perf_counter()
    parts = build_complex_parts(result)
    took = time.perf_counter() - start
    rest = height_maps(without(result, parts), cell / 8)
    together = joined([parts.mesh, rest])
    start = time.perf_counter()
    budget = TENTH * len(full["ball pivoting"][0].triangles)
    tenth = reduced(together, min(1.0, budget / len(together.triangles)))
    shown: dict[str, tuple[Mesh, float]] = {
        "height-maps alone": (height_maps(result, cell / 8), 0.0),
        "hybrid": (together, took),
        "hybrid, a tenth": (tenth, took + time.perf_counter() - start),
        **{f"full, {name}": made for name, made in full.items()},
    }
    share = f"{parts.count:,} of {len(result.field):,} pillars, {len(parts.mesh.triangles):,} triangles"
    print(f"{table(scene, result, points, shown)}\ncomplex: {share}")  # noqa: T201


def table(scene: str, result: Reconstruction, points: Floats, shown: dict[str, tuple[Mesh, float]]) -> str:
    """Say all of it; *within reach* are the points that the full mesh comes near to at all."""
    cell = result.field.compartments.grid.cell_size
    full = distances(points, shown["full, ball pivoting"][0])
    near, count = full < cell, len(shown["full, ball pivoting"][0].triangles)
    lines = [
        f"\n{scene}: {len(points):,} points, cell {cell:g} m, {near.mean():.1%} within reach of the full mesh"
    ]
    lines.append(
        f"{'':22}{'RMSE':>9}{'ratio':>7}{'95 %':>9}{'in reach':>10}{'ratio':>7}"
        f"{'triangles':>11}{'share':>7}{'seconds':>9}"
    )
    best, best_near = figures(full)[0], figures(full[near])[0]
    for name, (mesh, took) in shown.items():
        found = distances(points, mesh)
        (rmse, high), (reach, _) = figures(found), figures(found[near])
        lines.append(
            f"{name:22}{rmse:9.4f}{rmse / best:7.2f}{high:9.4f}{reach:10.4f}{reach / best_near:7.2f}"
            f"{len(mesh.triangles):11,}{len(mesh.triangles) / count:7.2f}{took:9.2f}"
        )
    return "\n".join(lines)


def height_maps(result: Reconstruction, bound: float) -> Mesh:
    """Return all layers' surfaces as targets write them, no further than a bound from the pillars."""
    field = result.field
    layers = [
        (field.compartment[layer.pillars], layer.elevation + field.compartments.lowest)
        for layer in result.layers
    ]
    made = sheets(field.compartments.grid, layers, float(result.parameters.link_step))
    return joined([covered(sheet, bound) for sheet in made])


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Make one mesh of several; what stands at the very same place becomes one vertex."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    corners = np.concatenate([mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)])
    vertices, number = np.unique(
        np.concatenate([mesh.vertices for mesh in meshes]).round(9), axis=0, return_inverse=True
    )
    return Mesh(vertices, number.reshape(-1)[corners])


def figures(found: Floats) -> tuple[float, float]:
    """Root mean square and the distance that 95 % are within."""
    return float(np.sqrt(np.mean(np.square(found)))), float(np.quantile(found, 0.95))


def _same(one: Mesh, other: Mesh) -> bool:
    return np.array_equal(one.vertices, other.vertices) and np.array_equal(one.triangles, other.triangles)
