"""What each scene is for: the lesson of its figure holds for its noiseless points and its true mesh."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from stepfield.synth import SyntheticScan, synthesise
from stepfield.synth.geometry import Floats

Bools = NDArray[np.bool_]


def exact(name: str, points: int = 20_000) -> SyntheticScan:
    return synthesise(name, points=points, noise=0.0)


def of(scan: SyntheticScan, *names: str) -> Floats:
    chosen = [number for number, name in enumerate(scan.names) if name in names]
    assert chosen, f"no surface of {names}"
    return np.asarray(scan.points[np.isin(scan.surface, chosen)])


def crossings(scan: SyntheticScan, x: float, y: float) -> Floats:
    """Elevations at which the vertical line through x and y pierces the true mesh, ascending."""
    a, b, c = scan.true_mesh.vertices[scan.true_mesh.triangles].swapaxes(0, 1)
    p = np.array([x, y])
    weights = [cross2(b - p_(p), c - p_(p)), cross2(c - p_(p), a - p_(p)), cross2(a - p_(p), b - p_(p))]
    area = weights[0] + weights[1] + weights[2]
    hit: Bools = np.all([w * np.sign(area) >= 0 for w in weights], axis=0) & (np.abs(area) > 1e-9)
    elevations = [(w[hit] / area[hit]) * corner[hit, 2] for w, corner in zip(weights, (a, b, c), strict=True)]
    # On an edge two triangles answer.
    return np.unique(np.sum(elevations, axis=0).round(9))


def p_(point: Floats) -> Floats:
    return np.array([*point, 0.0])


def cross2(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def levels(scan: SyntheticScan, x: float, y: float, apart: float = 0.4) -> int:
    """Surfaces one above the other at x and y that a gap of ``apart`` metres separates."""
    z = crossings(scan, x, y)
    return int(np.count_nonzero(np.diff(z) > apart) + (len(z) > 0))


def test_three_planes_have_three_elevations_and_one_plan() -> None:
    scan = exact("three-planes")
    assert sorted(set(scan.points[:, 2].tolist())) == [0.0, 1.0, 2.0]
    assert np.bincount(scan.surface).max() - np.bincount(scan.surface).min() <= 1
    for name in scan.names:
        plan = of(scan, name)[:, :2]
        assert np.allclose([plan.min(axis=0), plan.max(axis=0)], [[-5, -5], [5, 5]], atol=0.02)


def test_the_inclined_plane_crosses_two_elevations_and_touches_nothing() -> None:
    scan = exact("inclined-plane")
    inclined = of(scan, "inclined plane")
    low, high = inclined[:, 2].min(), inclined[:, 2].max()
    assert [z for z in (0.0, 1.0, 2.0) if low < z < high] == [1.0, 2.0]
    above_plan = inclined[np.abs(inclined[:, :2]).max(axis=1) <= 5]
    assert above_plan[:, 2].min() > 2.4
    assert len(above_plan) > 1000
    assert residual_to_plane(inclined) < 1e-9


def test_the_crossing_plane_cuts_the_highest_and_no_other() -> None:
    scan = exact("crossing-plane")
    inclined = of(scan, "inclined plane")
    within = inclined[np.abs(inclined[:, :2]).max(axis=1) <= 5][:, 2]
    assert [z for z in (0.0, 1.0, 2.0) if within.min() < z < within.max()] == [2.0]
    assert inclined[:, 2].min() < 1.0


def residual_to_plane(points: Floats) -> float:
    centred = points - points.mean(axis=0)
    return float(np.abs(centred @ np.linalg.svd(centred, full_matrices=False)[2][2]).max())


def test_the_cylinder_is_above_itself() -> None:
    scan = exact("cylinder")
    x, y, z = of(scan, "cylinder").T
    assert np.abs(np.hypot(y, z - 1) - 1).max() < 1e-9
    assert np.abs(x).max() <= 3
    assert np.array_equal(crossings(scan, 0.3, 0.5)[:1], [0.0])
    assert np.allclose(crossings(scan, 0.3, 0.5)[1:], 1 + np.sqrt(0.75) * np.array([-1, 1]), atol=2e-3)


def test_the_table_stands_on_four_thin_legs() -> None:
    scan = exact("table")
    assert sum(name.startswith("leg") for name in scan.names) == 4
    assert levels(scan, 0.1, 0.2) == 2
    legs = of(scan, "leg 1", "leg 2", "leg 3", "leg 4")
    assert legs[:, 2].min() < 0.01
    assert legs[:, 2].max() == pytest.approx(of(scan, "table top")[:, 2].min(), abs=0.01)


@pytest.mark.parametrize("y", [-1.0, 0.1, 1.2])
@pytest.mark.parametrize("x", [-5.0, -2.0, 0.1, 4.6])
def test_one_can_pass_beneath_the_bridge(x: float, y: float) -> None:
    z = crossings(exact("bridge", 1000), x, y)
    assert len(z) == 3
    assert z[1] - z[0] > 2.0
    assert z[2] - z[1] == pytest.approx(0.4)


def test_one_can_cross_the_bridge() -> None:
    """Along the middle of the ramps and the deck, no step is higher than the slope explains."""
    scan = exact("bridge", 1000)
    top = np.array([crossings(scan, float(x), 0.11)[-1] for x in np.arange(-20.05, 20, 0.3)])
    assert np.abs(np.diff(top)).max() < 0.12
    assert top.max() == pytest.approx(3.4)
    assert top[0] < 1.1
    assert top[-1] < 1.1


def test_stairs_climb_in_even_steps_and_wind_over_themselves() -> None:
    scan = exact("stairs", 1000)
    first = [crossings(scan, 0.28 * step + 0.1, 0.61)[-1] for step in range(8)]
    assert np.allclose(np.diff(first), 0.17)
    assert levels(scan, 1.1, 0.61) == 3
    assert levels(scan, 1.1, 2.01) == 3


def test_the_ramp_is_continuous_and_winds_over_itself() -> None:
    scan = exact("ramp")
    x, y, z = of(scan, "ramp").T
    turns = z / 3.0 - np.arctan2(y, x) / (2 * np.pi)
    assert np.abs(turns - np.round(turns)).max() < 1e-9
    assert np.diff(np.sort(z)).max() < 0.02
    overlaps = crossings(scan, -1.0, 6.0)
    assert len(overlaps) >= 3
    assert np.allclose(np.diff(overlaps)[-1:], 3.0, atol=0.01)


def test_the_ramp_joins_the_ground_and_the_exit() -> None:
    scan = exact("ramp", 1000)
    assert crossings(scan, 6.0, 0.05)[0] == pytest.approx(0.0, abs=0.01)
    before, after = crossings(scan, -6.0, 0.05)[-1], crossings(scan, -6.0, -0.05)[-1]
    assert before == pytest.approx(after, abs=0.01)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_rubble_has_places_with_several_surfaces_and_voids(seed: int) -> None:
    scan = synthesise("rubble", points=1000, noise=0.0, seed=seed)
    along, across = np.arange(1.05, 19, 1.5).tolist(), np.arange(1.05, 14.5, 1.5).tolist()
    stacked = np.array([levels(scan, x, y) for x in along for y in across])
    assert np.mean(stacked >= 2) > 0.4
    assert np.mean(stacked >= 3) > 0.1
    assert stacked.max() >= 4


def test_rubble_is_about_the_house_and_its_street() -> None:
    scan = exact("rubble", 50_000)
    low, high = scan.points.min(axis=0), scan.points.max(axis=0)
    assert np.all(high[:2] - low[:2] < [31, 28])
    assert -0.3 < low[2] < 0
    assert 8 < high[2] < 10


def test_every_seed_is_another_collapse() -> None:
    one, other = (synthesise("rubble", points=1000, seed=seed).true_mesh.vertices for seed in (0, 1))
    assert one.shape != other.shape or not np.allclose(one, other)
