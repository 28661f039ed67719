"""Distances are those to the very nearest triangle: as found by looking at each, one after the other."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.conftest import scan_of

from stepfield.errors import Cancelled
from stepfield.fidelity import Surface, Way, measure, surface_of
from stepfield.fidelity.reconstructions import layers_of, meshes_of
from stepfield.grid import Grid
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.surface import Mesh

Floats = NDArray[np.float64]
GRID = Grid(500_000.25, 4_000_000.5, 0.5, 5, 4)
Place = tuple[float, float, float]
Drawn = list[dict[int, float]]
WAYS: tuple[Way, ...] = ("pillars", "simulator", "edges")

coordinate = st.floats(-3, 3, width=16)
place = st.tuples(coordinate, coordinate, coordinate)


def to_triangle(point: Floats, a: Floats, b: Floats, c: Floats) -> float:
    """Distance of a point from a triangle: its plane's foot if that is inside, else the nearest side."""
    normal = np.cross(b - a, c - a)
    ends = [(a, b), (b, c), (c, a)]
    if np.linalg.norm(normal) > 1e-9:
        foot = point - normal * np.dot(point - a, normal) / np.dot(normal, normal)
        if all(np.dot(np.cross(q - p, foot - p), normal) >= 0 for p, q in ends):
            return float(np.linalg.norm(point - foot))
    return min(to_side(point, p, q) for p, q in ends)


def to_side(point: Floats, start: Floats, end: Floats) -> float:
    along = end - start
    share = np.clip(np.dot(point - start, along) / max(np.dot(along, along), 1e-300), 0, 1)
    return float(np.linalg.norm(point - start - share * along))


@settings(max_examples=60, deadline=None)
@given(st.lists(place, min_size=3, max_size=9), st.lists(place, min_size=1, max_size=5), st.randoms())
def test_the_nearest_of_any_triangles_is_found(
    corners: list[Place], points: list[Place], random: Random
) -> None:
    vertices = np.array(corners, float)
    count = len(vertices)
    triangles = np.array([random.sample(range(count), 3) for _ in range(count)])
    surface = Surface.of([Mesh(vertices, triangles)])
    found = measure(np.array(points, float), surface).nearest
    for point, distance in zip(np.array(points, float), found, strict=True):
        true = min(to_triangle(point, *vertices[triangle]) for triangle in triangles)
        if true <= surface.reach:
            assert distance == pytest.approx(true, abs=1e-6)
        else:
            assert distance >= true * (1 - 1e-6)


layers = st.lists(
    st.dictionaries(st.integers(0, len(GRID) - 1), st.floats(0, 4, width=16), max_size=12),
    min_size=1,
    max_size=3,
)


def as_layers(drawn: Drawn) -> list[tuple[NDArray[np.int64], Floats]]:
    return [
        (np.array(sorted(own), np.int64), np.array([own[at] + 3 * n for at in sorted(own)], float))
        for n, own in enumerate(drawn)
    ]


@settings(max_examples=40, deadline=None)
@given(layers, st.sampled_from(WAYS), st.integers(0, 2**32 - 1))
def test_no_point_is_nearer_vertically_than_in_any_direction(drawn: Drawn, way: Way, seed: int) -> None:
    low = np.array([GRID.west - 1, GRID.south - 1, -1.0])
    points = low + np.random.default_rng(seed).random((40, 3)) * [4.5, 4, 12]
    found = measure(points, surface_of(GRID, as_layers(drawn), way, 0.5))
    finite = np.isfinite(found.up)
    assert np.all(found.nearest[finite] <= np.abs(found.up[finite]) + 1e-6)
    assert np.array_equal(found.part >= 0, finite)


@settings(max_examples=40, deadline=None)
@given(layers, st.sampled_from(WAYS), st.integers(0, 2**32 - 1))
def test_points_of_the_surface_are_on_it(drawn: Drawn, way: Way, seed: int) -> None:
    made, rng = as_layers(drawn), np.random.default_rng(seed)
    surface = surface_of(GRID, made, way, 0.5)
    for number, mesh in enumerate(meshes_of(GRID, made, way, 0.5)):
        if not len(mesh.triangles):
            continue
        corners = mesh.vertices[mesh.triangles]
        weights = rng.dirichlet([1, 1, 1], len(corners))
        inner = measure((corners * weights[:, :, np.newaxis]).sum(axis=1), surface)
        assert np.all(inner.nearest < 1e-6)
        level = corners[np.ptp(corners[:, :, 2], axis=1) == 0].mean(axis=1)
        raised = measure(level + np.array([0, 0, 0.01]), surface)
        assert np.allclose(raised.up[raised.part == number], 0.01, atol=1e-6)
        assert np.all(measure(mesh.vertices, surface).nearest < 1e-6)  # on the rims of squares


def test_heights_above_a_surface_have_a_sign_and_a_layer() -> None:
    layers = [(np.array([0, 1]), np.array([1.0, 1.0])), (np.array([1]), np.array([3.0]))]
    centres = GRID.centres(np.array([0, 1, 1, 1, 2]))
    points = np.column_stack([centres, [0.9, 1.1, 1.9, 2.5, 1.0]])
    found = measure(points, surface_of(GRID, layers, "edges", 0.1))
    assert found.up == pytest.approx([-0.1, 0.1, 0.9, -0.5, np.inf], abs=1e-6)
    assert found.part.tolist() == [0, 0, 0, 1, -1]
    assert found.nearest[-1] == pytest.approx(0.25)  # half a compartment to the side


def test_a_layer_without_pillars_is_nowhere() -> None:
    nothing = (np.zeros(0, np.int64), np.zeros(0))
    for way in WAYS:
        found = measure(np.array([[GRID.west, GRID.south, 0.0]]), surface_of(GRID, [nothing], way, 0.1))
        assert np.isinf(found.up).all()
        assert np.isinf(found.nearest).all()


def test_threads_and_batches_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(5)
    own = np.flatnonzero(rng.random(len(GRID)) < 0.7)
    surface = surface_of(GRID, [(own, rng.random(len(own)))], "edges", 0.3)
    points = np.array([GRID.west, GRID.south, 0.0]) + rng.random((5000, 3)) * [2.5, 2, 2]
    scan = scan_of(points)
    first = measure(scan, surface)
    for name, value in (("BATCH", 700), ("BLOCK", 90), ("WORKERS", 1)):
        monkeypatch.setitem(measure.__globals__, name, value)
    second = measure(points, surface)
    for name in ("up", "nearest", "part"):
        assert np.array_equal(getattr(first, name), getattr(second, name))


def test_a_comparison_can_be_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    """A new result would otherwise wait for the comparison of all points of an older one."""
    own = np.arange(len(GRID))
    surface = surface_of(GRID, [(own, np.zeros(len(own)))], "edges", 0.3)
    begun = []
    whole = Surface.above

    def counted(self: Surface, *place: Floats) -> Any:
        begun.append(len(place[0]))
        return whole(self, *place)

    def stop(share: float, what: str) -> None:
        if share > 0:
            raise Cancelled

    monkeypatch.setattr(Surface, "above", counted)
    monkeypatch.setitem(measure.__globals__, "BATCH", 1)
    points = np.broadcast_to(np.array([GRID.west, GRID.south, 0.0]), (20_000, 3))
    with pytest.raises(Cancelled):
        measure(points, surface, stop)
    assert len(begun) < len(points)


@pytest.mark.parametrize("way", WAYS)
def test_a_real_scan_agrees_with_a_ray_caster(way: Way, real_scan: Callable[[str], Path]) -> None:
    import open3d

    result = Pipeline().run([real_scan("data__room_scan1.pcd")], Parameters())
    grid, layers = result.field.compartments.grid, layers_of(result)
    surface = surface_of(grid, layers, way, 0.3)
    points = result.scan.thinned(20_000).points()
    caster: Any = open3d.t.geometry.RaycastingScene()
    for mesh in meshes_of(grid, layers, way, 0.3):
        if len(mesh.triangles):
            caster.add_triangles(
                (mesh.vertices - surface.origin).astype(np.float32), mesh.triangles.astype(np.uint32)
            )
    true = caster.compute_distance((points - surface.origin).astype(np.float32)).numpy()
    found = measure(points, surface).nearest
    near = true < surface.reach
    assert near.mean() > 0.95
    assert np.allclose(found[near], true[near], atol=2e-5)
    assert np.all(found[~near] >= true[~near] - 2e-5)
