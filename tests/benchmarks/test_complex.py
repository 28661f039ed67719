"""Complex parts: height-maps alone, with a mesh of what they cannot hold, and a mesh of everything.

``python -m pytest tests/benchmarks/test_complex.py -s`` prints two tables a scene: which method meshes
complex parts best, and what the hybrid comes to at a tenth of the triangles of a full mesh, beside full
meshes that were reduced to as many. Two full meshes are what all is measured by: the one that Open3D's ball
pivoting gives when it is called once, and the one by balls that begin anew where something sparse was left.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.benchmarks.full_mesh import (
    METHODS,
    evened,
    full_ball_pivoting,
    full_once,
    invented,
    poisson,
    thinned,
)

from stepfield.complex_parts import build_complex_parts, without
from stepfield.complex_parts.build import POINTS_A_SIDE, _gathered
from stepfield.complex_parts.detection import detect
from stepfield.complex_parts.reducing import distances
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
#: The two full meshes that the others are measured by.
ONCE, AGAIN = "full, balls once", "full, balls again"

Made = TypeVar("Made")


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
    fine = evened(points, cell / FULL)
    ways: dict[str, Callable[[Floats, float], Mesh]] = {
        ONCE: full_once,
        AGAIN: full_ball_pivoting,
        "full, Poisson": poisson,
    }
    full = {name: _timed(method, fine, cell / FULL) for name, method in ways.items()}
    parts, took = _timed(build_complex_parts, result)
    together = joined([parts.mesh, height_maps(without(result, parts), cell / 8)])
    wanted = round(TENTH * len(full[ONCE][0].triangles))
    shown = {"height-maps alone": (height_maps(result, cell / 8), 0.0), "hybrid": (together, took), **full}
    for name in ("hybrid", *full):
        few, thinning = _timed(thinned, shown[name][0], points, cell / POINTS_A_SIDE, wanted)
        shown[f"{name}, a tenth"] = few, shown[name][1] + thinning
    share = f"{parts.count:,} of {len(result.field):,} pillars, {len(parts.mesh.triangles):,} triangles"
    print(f"{table(scene, result, points, shown)}\ncomplex: {share}")  # noqa: T201


def table(scene: str, result: Reconstruction, points: Floats, shown: dict[str, tuple[Mesh, float]]) -> str:
    """Say all of it; *within reach* of a full mesh are the points that it comes near to at all."""
    cell, count = result.field.compartments.grid.cell_size, len(shown[ONCE][0].triangles)
    found = {name: distances(points, mesh) for name, (mesh, _) in shown.items()}
    near = {name: found[name] < cell for name in (ONCE, AGAIN)}
    best = {name: figures(found[name][reached])[0] for name, reached in near.items()}
    reached = ", ".join(f"{each.mean():.1%} within reach of {name}" for name, each in near.items())
    lines = [f"\n{scene}: {len(points):,} points, cell {cell:g} m; {reached}"]
    lines.append(
        f"{'':30}{'RMSE':>9}{'95 %':>9}{'in reach':>10}{'ratio':>7}{'in reach':>10}{'ratio':>7}"
        f"{'triangles':>11}{'share':>7}{'seconds':>9}"
    )
    for name, (mesh, took) in shown.items():
        rmse, high = figures(found[name])
        reach = {each: figures(found[name][of])[0] for each, of in near.items()}
        ratios = "".join(f"{reach[each]:10.4f}{reach[each] / best[each]:7.2f}" for each in near)
        size = len(mesh.triangles)
        lines.append(f"{name:30}{rmse:9.4f}{high:9.4f}{ratios}{size:11,}{size / count:7.2f}{took:9.2f}")
    return "\n".join(lines)


def _timed(make: Callable[..., Made], *given: object) -> tuple[Made, float]:
    start = time.perf_counter()
    made = make(*given)
    return made, time.perf_counter() - start


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
