"""Invariants of the method over random clouds: each would be broken by a plausible mistake."""

from __future__ import annotations

from random import Random
from typing import Literal

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from tests.conftest import scan_of

from stepfield.compartments import sort_into_compartments
from stepfield.heightmap import Frame, GrayScale, draw
from stepfield.layers import UNASSIGNED, Layering, Method, classify
from stepfield.obstacles import classify_apart
from stepfield.pillars import StepField, build_pillars
from stepfield.scan import Axis, Scan

Floats = NDArray[np.float64]
Cap = int | Literal["auto", "none"]

#: Multiples of 2^-10 m, so that shifts by national-grid coordinates are exact.
clouds = st.integers(1, 120).flatmap(
    lambda n: arrays(np.int64, (n, 3), elements=st.integers(0, 4096)).map(lambda a: a / 1024.0)
)
cells = st.sampled_from([0.125, 0.25, 0.5, 1.0])
tolerances = st.sampled_from([0.0009765625, 0.0625, 0.25, 1.0, 3.0])
narrow = st.sampled_from([0.125, 0.25])
methods = st.sampled_from(["rank", "elevation", "surface"])
#: Many points above a few compartments: two in three of these have a wall.
towers = st.integers(0, 2**32 - 1).map(
    lambda seed: np.random.default_rng(seed).integers(0, 4096, (1 + seed % 150, 3)) / [16384, 16384, 2048.0]
)
wide = st.sampled_from([0.0625, 0.25, 0.5])


def made(points: Floats, cell: float, tolerance: float) -> StepField:
    return build_pillars(sort_into_compartments(scan_of(points), cell), tolerance)


def images(field: StepField, layering: Layering) -> list[bytes]:
    """All layers as 16-bit images, to be compared byte by byte."""
    grid = field.compartments.grid
    heights = field.elevation + 0.125
    scale = GrayScale(float(heights.max()), 16)
    frame = Frame.around(grid, "pow2")
    maps = []
    for layer in range(layering.count):
        chosen = layering.members(layer)
        maps.append(draw(grid, frame, field.compartment[chosen], heights[chosen], scale).gray.tobytes())
    return maps


@given(clouds, cells, tolerances, methods, st.randoms(use_true_random=False))
def test_the_order_of_the_points_does_not_matter(
    points: Floats, cell: float, tolerance: float, method: Method, random: Random
) -> None:
    shuffled = points[random.sample(range(len(points)), len(points))]
    one, other = made(points, cell, tolerance), made(shuffled, cell, tolerance)
    assert images(one, classify(one, method)) == images(other, classify(other, method))


@given(clouds, cells, tolerances)
def test_every_point_is_in_exactly_one_pillar_of_its_own_compartment(
    points: Floats, cell: float, tolerance: float
) -> None:
    field = made(points, cell, tolerance)
    assert field.points.sum() == len(points)
    assert field.points.min() >= 1
    low = points.min(axis=0)
    at = field.compartments.grid.compartment(points[:, 0] - low[0], points[:, 1] - low[1])
    z = points[:, 2] - low[2]
    for compartment in np.unique(at):
        mine = field.compartment == compartment
        inside = (field.low[mine] <= z[at == compartment, None]) & (
            z[at == compartment, None] <= field.high[mine]
        )
        assert (inside.sum(axis=1) == 1).all()


@given(clouds, cells, tolerances, methods, st.sampled_from(["auto", "none", 1, 2, 3]), st.integers(1, 3))
def test_one_pillar_a_compartment_a_layer_in_order_of_height(
    points: Floats, cell: float, tolerance: float, method: Method, max_layers: Cap, min_points: int
) -> None:
    field = made(points, cell, tolerance)
    layering = classify(field, method, min_points=min_points, max_layers=max_layers)
    assert layering.layer.max(initial=-1) < layering.count
    for compartment in np.unique(field.compartment):
        layer = layering.layer[field.compartment == compartment]
        assigned = layer[layer != UNASSIGNED]
        assert np.all(np.diff(assigned) > 0)
    enough = field.points >= min_points
    assert np.all(layering.layer[~enough] == UNASSIGNED)
    if max_layers == "none":
        assert np.all(layering.layer[enough] != UNASSIGNED)


@given(towers, narrow, wide, methods, st.sampled_from(["auto", "none", 1, 2, 3]), st.integers(1, 3))
def test_obstacles_and_surfaces_never_share_a_layer(
    points: Floats, cell: float, tolerance: float, method: Method, max_layers: Cap, min_points: int
) -> None:
    field = made(points, cell, tolerance).with_walls_to_their_tops()
    layering = classify_apart(field, method, min_points=min_points, max_layers=max_layers)
    surfaces = layering.count - len(layering.obstacles)
    assert layering.obstacles == tuple(range(surfaces, layering.count))
    assigned = layering.layer != UNASSIGNED
    assert np.array_equal(layering.in_obstacles()[assigned], field.vertical[assigned])
    for compartment in np.unique(field.compartment):
        mine = (field.compartment == compartment) & assigned
        for kind in (mine & field.vertical, mine & ~field.vertical):
            assert np.all(np.diff(layering.layer[kind]) > 0)
    enough = field.points >= min_points
    assert not assigned[~enough].any()
    if max_layers == "none":
        assert assigned[enough].all()
    averages = layering.averages(field.elevation)[:surfaces]
    assert method != "elevation" or np.all(np.diff(averages) >= 0)


@given(towers, narrow, wide, methods, st.randoms(use_true_random=False))
def test_the_order_of_the_points_does_not_matter_for_walls(
    points: Floats, cell: float, tolerance: float, method: Method, random: Random
) -> None:
    shuffled = points[random.sample(range(len(points)), len(points))]
    one, other = (made(each, cell, tolerance).with_walls_to_their_tops() for each in (points, shuffled))
    assert np.array_equal(one.vertical, other.vertical)
    assert images(one, classify_apart(one, method)) == images(other, classify_apart(other, method))


@given(clouds, cells, tolerances)
def test_the_cost_never_rises_and_the_averages_ascend(points: Floats, cell: float, tolerance: float) -> None:
    field = made(points, cell, tolerance)
    layering = classify(field, max_layers="none")
    costs = np.array(layering.costs)
    assert np.all(np.diff(costs) <= 1e-9 * (1 + costs[:-1]))
    assert layering.converged
    assert np.all(np.diff(layering.averages(field.elevation)) >= 0)


@given(clouds, cells, tolerances, tolerances)
def test_more_tolerance_never_means_more_pillars(
    points: Floats, cell: float, one: float, other: float
) -> None:
    narrow, wide = (made(points, cell, tolerance) for tolerance in sorted((one, other)))
    assert len(wide) <= len(narrow)
    assert set(wide.start.tolist()) <= set(narrow.start.tolist())


@given(clouds, cells, tolerances, st.integers(-50, 50), st.integers(-50, 50))
def test_shifting_by_whole_cells_moves_the_origin_only(
    points: Floats, cell: float, tolerance: float, east: int, north: int
) -> None:
    field = made(points, cell, tolerance)
    shifted = made(points + np.array([east * cell, north * cell, 0]), cell, tolerance)
    assert images(field, classify(field)) == images(shifted, classify(shifted))
    grid, moved = field.compartments.grid, shifted.compartments.grid
    assert (moved.west - grid.west, moved.south - grid.south) == (east * cell, north * cell)


@given(clouds, cells, tolerances)
def test_national_coordinates_lose_nothing(points: Floats, cell: float, tolerance: float) -> None:
    field = made(points, cell, tolerance)
    shifted = made(points + np.array([600_000, 5_400_000, 300]), cell, tolerance)
    assert images(field, classify(field)) == images(shifted, classify(shifted))


@settings(max_examples=50)
@given(arrays(np.int32, (40, 3), elements=st.integers(0, 5000)), st.sampled_from([0.001, 0.01, 0.0254]))
def test_las_offsets_lose_nothing(raw: NDArray[np.int32], scale: float) -> None:
    def scan(offsets: tuple[float, float, float]) -> Scan:
        x, y, z = (Axis(raw[:, i], scale, offset) for i, offset in enumerate(offsets))
        return Scan(x, y, z)

    near, far = (
        build_pillars(sort_into_compartments(scan(offsets), 10 * scale), 3 * scale)
        for offsets in ((0.0, 0.0, 0.0), (600_000.0, 5_400_000.0, 300.0))
    )
    assert images(near, classify(near)) == images(far, classify(far))
