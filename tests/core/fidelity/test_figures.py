"""Fidelity tells the truth: known offsets come back as known errors, and nothing is left out of the count."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.conftest import scan_of
from tests.core.walled import CELL, TOLERANCE, walled

from stepfield.compartments import sort_into_compartments
from stepfield.fidelity import Fidelity, Way, compare, compare_result, holes, layer_figures, near_gaps
from stepfield.grid import Grid
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.stack import write_stack
from stepfield.stack.check import check_stack

WAYS: tuple[Way, ...] = ("pillars", "simulator", "edges")
GRID = Grid(100.0, 200.0, 1.0, 3, 2)
FLOOR = (np.arange(6), np.full(6, 5.0))
TOP = (np.array([1]), np.array([8.0]))


def compared(points: list[list[float]], *layers: tuple[np.ndarray, np.ndarray]) -> Fidelity:
    return compare(scan_of(points), GRID, layers, "pillars", 0.1, 0.5).fidelity


def test_points_are_compared_with_the_nearest_layer_of_their_own_compartment() -> None:
    found = compared([[100.5, 201.5, 5.1], [101.5, 201.5, 7.8], [102.5, 200.5, 8.0]], FLOOR, TOP)
    assert found.vertical.max == pytest.approx(3.0)
    assert found.vertical.median == pytest.approx(0.2)
    assert found.vertical.rmse == pytest.approx(np.sqrt((0.01 + 0.04 + 9) / 3))
    assert found.vertical.p95 == pytest.approx(np.quantile([0.1, 0.2, 3.0], 0.95), rel=1e-5)
    assert found.explained == pytest.approx(2 / 3)
    assert found.nearest.max == pytest.approx(np.hypot(0.5, 0.5))  # level with the corner of the top's square


def test_points_in_holes_and_beyond_the_grid_count_as_unexplained() -> None:
    points = [[100.5, 201.5, 8.0], [99.0, 201.5, 8.0], [101.5, 201.5, 8.0], [101.5, 203.5, 8.0]]
    found = compared(points, TOP)
    assert found.vertical.missing == 3
    assert found.explained == 0.25
    assert found.nearest.missing == 0
    assert found.nearest.max == pytest.approx(2.0)


def test_points_without_any_surface_have_no_finite_error() -> None:
    found = compared([[-1000.0, 0.0, 0.0]], (np.zeros(0, np.int64), np.zeros(0)))
    assert found.vertical.missing == found.nearest.missing == 1
    assert np.isinf(found.vertical.rmse)
    values = found.as_dict()
    assert isinstance(values["vertical"], dict)
    assert values["vertical"]["rmse"] is None


def test_points_out_of_reach_are_not_looked_for() -> None:
    """A scan that lies elsewhere would take minutes, compartment by compartment."""
    large = Grid(0.0, 0.0, 1.0, 100, 100)
    own = np.flatnonzero(np.arange(len(large)) % 100 >= 5)  # the westmost columns are empty
    layer = (own, np.zeros(len(own)))
    points = np.array([[50, 50, 30], [50, 50, 5], [-2, 50, 0], [-30, 50, 0], [50, 50, -30.0]])
    found = compare(scan_of(points), large, [layer], "pillars", 0.1, 0.5).fidelity
    assert found.nearest.missing == 1  # beside it; those above and below are known to be no nearer
    assert found.nearest.max == pytest.approx(30)
    assert found.nearest.median == pytest.approx(18.5)


def test_errors_of_pillars_have_a_sign() -> None:
    scan = scan_of([[100.5, 201.5, 5.1], [100.6, 201.5, 5.3], [101.5, 201.5, 7.8], [101.5, 201.5, 4.9]])
    floor, top = compare(scan, GRID, [FLOOR, TOP], "pillars", 0.1, 0.5).errors
    assert floor[:2] == pytest.approx([0.2, -0.1], abs=1e-6)
    assert np.isnan(floor[2:]).all()
    assert top == pytest.approx([-0.2], abs=1e-6)


def test_a_mean_is_the_middle_of_its_points(real_scan: Callable[[str], Path]) -> None:
    """Of flat pillars nothing is off on the average: else points went to wrong pillars."""
    result = Pipeline().run([real_scan("plane_seg__06.pcd")], Parameters(cell_size=0.05, layer_tolerance=0.3))
    found = compare_result(result, "pillars")
    assert len(result.layers) == 1
    assert np.nanmax(np.abs(found.errors[0])) < 1e-5
    assert found.fidelity.vertical.missing == 0


def test_an_even_draw_comes_near_to_all_points(real_scan: Callable[[str], Path]) -> None:
    result = Pipeline().run([real_scan("data__room_scan1.pcd")], Parameters())
    exact, drawn = (compare_result(result, most=most).fidelity for most in (None, 20_000))
    assert drawn.is_drawn
    assert not exact.is_drawn
    assert (drawn.of, exact.points) == (exact.of, len(result.scan))
    assert drawn.explained == pytest.approx(exact.explained, abs=0.01)
    assert drawn.nearest.rmse == pytest.approx(exact.nearest.rmse, rel=0.05)


def test_unassigned_points_are_unexplained(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    floor, stray = rng.random((900, 3)) * [3, 3, 0.05], rng.random((20, 3)) * [3, 3, 0.05] + [0, 0, 2]
    np.save(tmp_path / "scan.npy", np.vstack([floor, stray]))
    parameters = Parameters(cell_size=1.0, layer_tolerance=0.5, min_points=15)
    result = Pipeline().run([tmp_path / "scan.npy"], parameters)
    assert len(result.layers) == 1
    for way in WAYS:
        assert compare_result(result, way).fidelity.explained == pytest.approx(
            (900 if way != "simulator" else np.all(np.abs(floor[:, :2] - 1.5) < 1, axis=1).sum()) / 920,
            abs=0.01,
        )


def test_holes_are_what_a_layer_encloses() -> None:
    grid = Grid(0.0, 0.0, 0.5, 6, 5)
    occupied = np.ones((5, 6), bool)
    occupied[1, 1] = occupied[2, 3] = occupied[2, 4] = occupied[3, 2] = False  # corners do not join
    occupied[4, 5] = occupied[0, 0] = False  # at the edge: bays
    own = np.flatnonzero(occupied)
    found = holes(grid, own)
    assert found.count == 3
    assert found.compartment.tolist() == [7, 15, 16, 20]
    (figures,) = layer_figures(grid, [(own, np.zeros(len(own)))], 0.1)
    assert (figures.holes, figures.hole_area) == (3, 1.0)
    assert figures.occupied_area == figures.area("edges") == pytest.approx(len(own) * 0.25)
    assert figures.area("simulator") < figures.occupied_area


def test_gaps_near_the_tolerance_are_found_on_either_side() -> None:
    heights = {0: [0, 0.39], 1: [0, 0.41], 2: [0, 0.61], 3: [0, 0.52, 0.99], 4: [0, 0.7], 5: [0, 0.49, 1.1]}
    points = [[c + 0.5, 0.5, z] for c, column in heights.items() for z in column]
    found = near_gaps(sort_into_compartments(scan_of([*points, [0.0, 0.0, 0.0], [6.0, 1.0, 0.0]]), 1.0), 0.5)
    gaps = dict(zip(found.compartment.tolist(), found.gap.tolist(), strict=True))
    assert gaps == {
        n: pytest.approx(gap) for n, gap in ((0, 0.39), (1, 0.41), (2, 0.61), (3, 0.52), (5, 0.49))
    }


def test_obstacles_are_solid(tmp_path: Path) -> None:
    """Points on a wall are at the side of its block, not metres below its top."""
    np.save(tmp_path / "scan.npy", walled())
    made = {}
    for walls in ("mean", "layer"):
        parameters = Parameters.checked(cell_size=CELL, layer_tolerance=TOLERANCE, walls=walls)
        result = Pipeline().run([tmp_path / "scan.npy"], parameters)
        made[walls] = compare_result(result).fidelity.nearest
        write_stack(result, tmp_path / walls)
        checked = check_stack(tmp_path / walls, [tmp_path / "scan.npy"])
        assert checked.faults == ()
        assert checked.fidelity is not None
        assert checked.fidelity.nearest.rmse == pytest.approx(made[walls].rmse, abs=1e-3)
    assert made["layer"].max < CELL
    assert made["layer"].max < made["mean"].max
