"""Heights that nobody measured: how many there are, and how far off they are likely to be, is not made up."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from stepfield.cli.check import check_folder
from stepfield.cli.report import Reporter
from stepfield.fidelity import (
    FilledFigures,
    Hidden,
    Surface,
    filled_figures,
    hidden,
    patches,
    result_filled_figures,
    with_truth,
)
from stepfield.filling import Filled, Ground, Method, fill
from stepfield.grid import Grid
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction
from stepfield.scan.write import write
from stepfield.stack import write_stack
from stepfield.stack.check import check_stack
from stepfield.surface import Mesh
from stepfield.synth import synthesise

Floats = NDArray[np.float64]
METHODS: tuple[Method, ...] = get_args(Method)
SIDE = 60
GRID = Grid(0.0, 0.0, 0.5, SIDE, SIDE)
CLEARANCE = 0.3


def layer(raster: Floats) -> tuple[NDArray[np.int64], Floats]:
    there = np.flatnonzero(~np.isnan(raster))
    return there, raster.ravel()[there]


def ground(raster: Floats) -> Ground:
    there, elevation = layer(raster)
    return Ground(there, elevation, elevation)


def slope() -> Floats:
    row, column = np.indices((SIDE, SIDE)).astype(float)
    return 0.2 * column + 0.1 * row


def rough(seed: int = 3) -> Floats:
    return slope() + np.random.default_rng(seed).normal(0, 0.3, (SIDE, SIDE))


def with_holes(raster: Floats, side: int = 3, apart: int = 12) -> Floats:
    raster = raster.copy()
    for row in range(6, SIDE - side - 1, apart):
        for column in range(6, SIDE - side - 1, apart):
            raster[row : row + side, column : column + side] = np.nan
    return raster


def figures(*rasters: Floats, method: Method = "linear", size: float = 3.0) -> tuple[FilledFigures, ...]:
    filled = fill(GRID, [ground(raster) for raster in rasters], method, size, CLEARANCE)
    return filled_figures(GRID, [layer(raster) for raster in rasters], {}, filled, method, CLEARANCE)


def known(found: FilledFigures) -> Hidden:
    assert found.hidden is not None
    return found.hidden


def test_pixels_and_holes_are_counted_with_their_areas() -> None:
    raster = with_holes(rough())
    raster[40:50, 28:38] = np.nan  # too long for the size; it takes one of the others in
    (found,) = figures(raster)
    assert (found.pixels, found.holes, found.open) == (24 * 9, 24, 1)
    assert found.area == 24 * 9 * 0.25
    assert found.open_area == pytest.approx(np.isnan(raster).sum() * 0.25 - found.area)


def test_a_hole_with_another_layer_in_the_way_is_left_open_in_part() -> None:
    lower, upper = with_holes(slope()), np.full((SIDE, SIDE), np.nan)
    upper[6, 6:9] = slope()[6, 6:9] + 0.1
    found, above = figures(lower, upper)
    assert (found.holes, found.open, found.open_area) == (24, 1, 0.75)
    assert found.pixels == 25 * 9 - 3
    assert (above.pixels, above.hidden) == (0, None)


def test_between_obstacles_nothing_is_left_open() -> None:
    """Four walls around a yard are no hole that somebody forgot to fill."""
    walls = np.full((SIDE, SIDE), np.nan)
    walls[20:24, 20:24] = 3.0
    walls[21:23, 21:23] = np.nan
    layers = [layer(with_holes(slope())), layer(walls)]
    nothing = Filled(np.zeros(0, np.int64), np.zeros(0))
    bottoms = {1: layers[1][1] - 3}
    ground_of, walls_of = filled_figures(GRID, layers, bottoms, [nothing] * 2, "linear", CLEARANCE)
    assert (ground_of.open, walls_of.open) == (25, 0)


@pytest.mark.parametrize(("method", "most"), [("nearest", 0.45), ("linear", 1e-9), ("inpaint", 1e-6)])
def test_on_a_slope_only_the_nearest_pillar_is_off(method: Method, most: float) -> None:
    """Two compartments from the rim are 0.4 m along the slope: that, and no less, is what to expect."""
    estimate = known(figures(with_holes(slope()), method=method)[0])
    assert estimate.errors.max() <= most
    if method == "nearest":
        assert estimate.errors.max() == pytest.approx(0.4)
        assert estimate.rmse == pytest.approx(np.sqrt(np.mean(np.square(estimate.errors))))


def test_the_estimate_is_near_what_filling_is_off_by() -> None:
    """The holes were cut out of ground that is known, and as rough as what is left of it."""
    whole = rough()
    raster = with_holes(whole)
    for method in METHODS:
        (filled,) = fill(GRID, [ground(raster)], method, 3.0, CLEARANCE)
        error = np.abs(filled.elevation - whole.ravel()[filled.compartment])
        estimate = known(figures(raster, method=method)[0])
        assert estimate.rmse == pytest.approx(np.sqrt(np.mean(np.square(error))), rel=0.2)
        assert estimate.median == pytest.approx(np.median(error), rel=0.25)
        assert estimate.p95 == pytest.approx(np.quantile(error, 0.95), rel=0.2)


def test_patches_are_hidden_in_ground_as_uneven_as_that_around_the_holes() -> None:
    """Holes in heaps of rubble on level ground: that beside them would promise that nothing is off."""
    random, raster = np.random.default_rng(5), np.zeros((SIDE, SIDE))
    raster[:, 20:32] = random.normal(0, 0.5, (SIDE, 12))
    for row in range(6, SIDE - 6, 8):
        raster[row - 1 : row + 4, 11:16] = random.normal(0, 0.5, (5, 5))
    whole = raster.copy()
    for row in range(6, SIDE - 6, 8):
        raster[row : row + 3, 12:15] = np.nan
    (filled,) = fill(GRID, [ground(raster)], "linear", 3.0, CLEARANCE)
    error = np.abs(filled.elevation - whole.ravel()[filled.compartment])
    estimate = known(figures(raster)[0])
    assert estimate.rmse == pytest.approx(np.sqrt(np.mean(np.square(error))), rel=0.3)


@pytest.mark.parametrize("method", METHODS)
def test_a_patch_is_filled_as_a_hole_of_the_whole_layer_would_be(method: Method) -> None:
    """Only a window of the layer is looked at; at its edge, and with holes around it, nothing may differ."""
    raster = with_holes(rough(), apart=6 if method != "inpaint" else 12)  # which goes by filled neighbours
    raster[0, 30] = -20.0  # what is filled may go as far as this, wherever the window is
    for row, column in ((2, 2), (12, 12), (10, 3), (21, 35), (SIDE - 4, SIDE - 10)):
        place = np.ravel_multi_index(
            np.array([[row, row, row + 1], [column, column + 1, column]]), (SIDE, SIDE)
        )
        cut = raster.copy()
        cut.ravel()[place] = np.nan
        (filled,) = fill(GRID, [ground(cut)], method, 3.0, CLEARANCE)
        there = np.searchsorted(filled.compartment, place)
        span = float(np.nanmin(raster)), float(np.nanmax(raster))
        window = hidden._refilled(GRID, raster, place, method, span)
        np.testing.assert_allclose(window, filled.elevation[there], atol=1e-9)


def test_a_hidden_summit_may_be_higher_than_all_around_it() -> None:
    """What is filled goes as far as the layer does, not as far as what is left in the window."""
    row, column = np.indices((SIDE, SIDE)) - 30
    raster = -0.05 * (row**2 + column**2).astype(float)
    place = np.ravel_multi_index(np.array([[30, 30, 31, 31], [30, 31, 30, 31]]), (SIDE, SIDE))
    rim, lowest = raster[29, 30], float(raster.min())
    assert hidden._refilled(GRID, raster, place, "inpaint", (lowest, 0.0)).max() > rim
    assert hidden._refilled(GRID, raster, place, "inpaint", (lowest, rim)).max() == rim


def test_heights_that_would_be_left_out_are_not_counted() -> None:
    """Beneath a slab just above the ground a wrong height would have been refused, so it is no error."""
    lower = with_holes(rough())
    free = known(figures(lower)[0])
    under = known(figures(lower, lower + 0.31)[0])  # the holes go through both
    assert len(under.errors) < 0.8 * len(free.errors)
    assert under.p95 < free.p95


def test_every_filled_compartment_counts_once() -> None:
    """Three large holes and many small ones: errors in large ones weigh by the ground that they cover."""
    raster = rough()
    raster[5:41:4, 5] = np.nan
    for column in (15, 30, 45):
        raster[20:26, column : column + 6] = np.nan
    (found,) = figures(raster)
    assert known(found).weights.sum() == pytest.approx(found.pixels)


def test_errors_weigh_as_the_holes_they_stand_for_cover_ground() -> None:
    """On a slope a shape is off by as much wherever it is; the large one fits into a few places only."""
    raster = slope()
    raster[:, :14] = raster[:, 46:] = raster[52:] = np.nan
    raster[30:38, 26:34] = np.nan
    raster[2:12:2, 16:44:2] = np.nan
    (filled,) = fill(GRID, [ground(raster)], "nearest", 4.0, CLEARANCE)
    error = np.abs(filled.elevation - slope().ravel()[filled.compartment])
    estimate = known(figures(raster, method="nearest", size=4.0)[0])
    assert estimate.rmse == pytest.approx(np.sqrt(np.mean(np.square(error))), rel=0.05)


def test_one_hole_is_hidden_in_many_places() -> None:
    raster = rough()
    raster[28:31, 28:31] = np.nan
    estimate = known(figures(raster)[0])
    assert hidden.LEAST_PATCHES <= estimate.patches <= patches.PATCHES
    assert estimate.p95 > 0.1


def test_too_little_ground_says_nothing() -> None:
    """A ring round a hole fills it, and knows nothing about it."""
    raster = np.full((SIDE, SIDE), np.nan)
    raster[20:25, 20:25] = 1.0
    raster[21:24, 21:24] = np.nan
    (found,) = figures(raster)
    assert (found.pixels, found.holes, found.hidden) == (9, 1, None)


def test_small_patches_do_not_speak_for_a_large_hole() -> None:
    """Most of what was filled is one hole that fits nowhere else."""
    raster = rough()
    raster[3:-3, 3:-3] = np.nan
    raster[1, 2:50:2] = np.nan
    (found,) = figures(raster, size=100.0)
    assert found.holes == 25
    assert found.hidden is None


def test_the_work_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """However many holes, and however large they are."""
    many = known(figures(with_holes(rough(), 1, 2))[0])
    assert many.patches == patches.PATCHES
    monkeypatch.setattr(patches, "PIXELS", 200)
    large = known(figures(with_holes(rough()))[0])
    assert hidden.LEAST_PATCHES <= large.patches <= 200 // 9
    monkeypatch.setattr(patches, "LARGEST", 8)
    assert figures(with_holes(rough()))[0].hidden is None


@given(st.integers(0, 2**32 - 1), st.sampled_from(METHODS))
@settings(max_examples=15, deadline=None)
def test_whatever_was_filled_is_told_the_same_twice(seed: int, method: Method) -> None:
    random = np.random.default_rng(seed)
    rasters: list[Floats] = []
    for index in range(random.integers(1, 4)):
        raster = (random.integers(0, 4, (SIDE, SIDE)) * 0.25 + index).astype(np.float64)
        raster[random.random(raster.shape) < random.random() * 0.4] = np.nan
        raster[: random.integers(0, SIDE)] = np.nan
        rasters.append(raster)
    once, twice = (figures(*rasters, method=method, size=2.0) for _ in range(2))
    assert [each.as_dict() for each in once] == [each.as_dict() for each in twice]
    for each, raster in zip(once, rasters, strict=True):
        assert each.pixels <= np.isnan(raster).sum()
        if each.hidden is not None:
            assert 0 <= each.hidden.median <= each.hidden.p95 <= 4
            assert each.hidden.weights.sum() == pytest.approx(each.pixels)


def test_layers_are_joined_by_what_was_filled_in_them() -> None:
    one = Hidden.of(8, np.array([0.2, 0.1]), np.array([30.0, 30.0]))
    other = Hidden.of(9, np.array([3.0]), np.array([2.0]))
    joined = Hidden.joined([one, other])
    assert joined is not None
    assert (joined.patches, joined.median, joined.p95) == (17, 0.2, 0.2)
    assert joined.rmse == pytest.approx(np.sqrt((0.04 * 30 + 0.01 * 30 + 9 * 2) / 62))
    assert Hidden.joined([]) is None


def test_against_the_truth_up_and_down_count_alike() -> None:
    square = np.array([[0, 0, 1.0], [30, 0, 1.0], [30, 15, 1.0], [0, 15, 1.0]])
    truth = Surface.of([Mesh(square, np.array([[0, 1, 2], [0, 2, 3]]))])
    south = (SIDE - 2) * SIDE
    filled = Filled(np.array([2, south + 3, south + 4]), np.array([1.0, 1.2, 0.6]))
    found = with_truth(figures(with_holes(slope()))[0], GRID, filled, truth, CLEARANCE).truth
    assert found is not None
    assert found.missing == 1  # in the north there is no truth
    assert found.max == pytest.approx(0.4)
    assert found.rmse == pytest.approx(np.sqrt((0.04 + 0.16) / 2))


# ---- from the scan to the command ------------------------------------------------------------------


@pytest.fixture(scope="module")
def holed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A slope that a virtual scanner saw no points of in many small holes."""
    made = synthesise("inclined-plane", points=60_000, noise=0.002, seed=1).points
    column, row = (np.floor(made[:, axis] / 0.1).astype(int) for axis in (0, 1))
    path = tmp_path_factory.mktemp("holed") / "scan.npy"
    write(path, made[(column % 8 < 6) | (row % 8 < 6)], {})
    return path


def built(scan: Path, **chosen: Any) -> Reconstruction:
    values = {"cell_size": 0.1, "layer_tolerance": 0.3}
    return Pipeline().run([scan], Parameters.checked(**(values | chosen)))


def test_a_check_says_what_the_result_in_memory_says(holed: Path, tmp_path: Path) -> None:
    result = built(holed, fill="linear")
    write_stack(result, tmp_path / "stack")
    report = check_stack(tmp_path / "stack")
    here = result_filled_figures(result)
    for one, other in zip(report.filled, here, strict=True):
        assert (one.pixels, one.holes, one.open) == (other.pixels, other.holes, other.open)
        assert one.pixels > 100
        assert one.truth is None
        assert known(one).rmse == pytest.approx(known(other).rmse, rel=0.2)  # half a gray level can tell


def test_the_command_says_what_was_filled_and_how_far_off(
    holed: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_stack(built(holed, fill="linear"), tmp_path / "stack")
    assert check_folder(tmp_path / "stack", [], "inclined-plane", Reporter(True)) == 0
    told = json.loads(capsys.readouterr().out)["filled"]
    assert [each["layer"] for each in told] == [f"Layer {number}" for number in (1, 2, 3, 4)]
    for each in told:
        assert sorted(each["estimate"]) == ["median", "p95", "patches", "pixels", "rmse"]
        assert each["estimate"]["median"] < 0.01
        assert each["truth"]["median"] < 0.01
    check_folder(tmp_path / "stack", [], "inclined-plane", Reporter(False))
    said = capsys.readouterr().out
    assert "layer_00_filled.png  Layer 1: " in said
    assert "hidden patches\n" in said
    assert said.count("from the true surface: RMSE") == 4


def test_the_command_puts_a_dash_where_it_cannot_tell(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points = np.argwhere(np.ones((5, 5))) + 0.5
    points = points[np.abs(points - 2.5).max(axis=1) > 1.1]
    np.save(tmp_path / "scan.npy", np.column_stack([points, np.zeros(len(points))]))
    write_stack(built(tmp_path / "scan.npy", cell_size=0.8, fill="linear"), tmp_path / "stack")
    check_folder(tmp_path / "stack", [], None, Reporter(False))
    assert "off by – (too little measured ground" in capsys.readouterr().out
    check_folder(tmp_path / "stack", [], None, Reporter(True))
    assert json.loads(capsys.readouterr().out)["filled"][0]["estimate"] is None


def test_without_filling_nothing_is_said(
    holed: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_stack(built(holed), tmp_path / "stack")
    assert result_filled_figures(built(holed)) == ()
    check_folder(tmp_path / "stack", [], None, Reporter(False))
    assert "filled" not in capsys.readouterr().out
    check_folder(tmp_path / "stack", [], None, Reporter(True))
    assert json.loads(capsys.readouterr().out)["filled"] == []


def test_a_real_scan(real_scan: Callable[[str], Path]) -> None:
    parameters = Parameters(fill="inpaint", fill_size=0.5)
    result = Pipeline().run([real_scan("data__room_scan1.pcd")], parameters)
    found = result_filled_figures(result)
    for each, own in zip(found, result.layers, strict=True):
        assert each.pixels == len(own.filled.compartment)
        assert 0 < known(each).median <= known(each).rmse < 1
