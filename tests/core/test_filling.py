"""Filling holes: what was not measured is never taken for it, and never in the way of what was."""

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
from PIL import Image

from stepfield.filling import Filled, Ground, Method, fill
from stepfield.grid import Grid
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction
from stepfield.scan.write import write
from stepfield.stack import Manifest, Stack, write_stack
from stepfield.stack.check import check_stack
from stepfield.targets.terrain import Terrain

METHODS: tuple[Method, ...] = get_args(Method)
GRID = Grid(0.0, 0.0, 0.5, 12, 10)


def ground(raster: NDArray[np.float64], **more: Any) -> Ground:
    there = np.flatnonzero(~np.isnan(raster))
    return Ground(there, raster.ravel()[there], raster.ravel()[there], **more)


def slope() -> NDArray[np.float64]:
    row, column = np.indices((10, 12)).astype(float)
    return 0.2 * column + 0.1 * row


def with_holes(*holes: tuple[slice, slice]) -> NDArray[np.float64]:
    raster = slope()
    for hole in holes:
        raster[hole] = np.nan
    return raster


SMALL, LONG, OPEN = np.s_[2:4, 2:5], np.s_[6:7, 2:10], np.s_[0:3, 8:9]


@pytest.mark.parametrize("method", METHODS)
def test_only_holes_up_to_the_size_are_filled(method: Method) -> None:
    """The bay that is open to the outside is none, however small."""
    raster = with_holes(SMALL, LONG, OPEN)
    for size, holes in ((1.4, []), (1.5, [SMALL]), (4.0, [SMALL, LONG])):
        (filled,) = fill(GRID, [ground(raster)], method, size, 0.3)
        wanted = np.zeros(raster.shape, bool)
        for hole in holes:
            wanted[hole] = True
        np.testing.assert_array_equal(filled.compartment, np.flatnonzero(wanted))
        assert filled.left == 0


def test_holes_that_touch_in_a_corner_are_two() -> None:
    raster = with_holes(np.s_[2:4, 2:4], np.s_[4:6, 4:6])
    (filled,) = fill(GRID, [ground(raster)], "nearest", 1.0, 0.3)
    assert len(filled.compartment) == 8


@pytest.mark.parametrize(("method", "error"), [("nearest", 0.25), ("linear", 1e-9), ("inpaint", 1e-6)])
def test_a_slope_goes_on_through_its_holes(method: Method, error: float) -> None:
    (filled,) = fill(GRID, [ground(with_holes(SMALL, LONG))], method, 4.0, 0.3)
    np.testing.assert_allclose(filled.elevation, slope().ravel()[filled.compartment], atol=error)


@pytest.mark.parametrize("method", METHODS)
def test_nothing_is_put_on_through_or_near_another_layer(method: Method) -> None:
    lower, upper = with_holes(SMALL, LONG), np.full((10, 12), np.nan)
    upper[2, 2:5] = slope()[2, 2:5]  # nearer than the tolerance
    upper[3, 2:5] = slope()[3, 2:5] - 1.0  # below it, though it is the upper layer
    upper[6, 2:6] = slope()[6, 2:6] + 1.0  # far enough above
    filled, above = fill(GRID, [ground(lower), ground(upper)], method, 4.0, 0.3)
    assert set(filled.compartment // 12) == {6}
    assert len(filled.compartment) == 8
    assert filled.left == 6
    assert len(above.compartment) == 0


def test_two_layers_do_not_fill_the_same_place() -> None:
    """Both have a hole in the same place, with less than the tolerance between them."""
    lower, upper = with_holes(SMALL), with_holes(SMALL) + 0.25
    first, second = fill(GRID, [ground(lower), ground(upper)], "linear", 4.0, 0.3)
    assert (len(first.compartment), first.left) == (6, 0)
    assert (len(second.compartment), second.left) == (0, 6)


def test_obstacles_are_in_the_way_only_where_they_are_solid() -> None:
    lower = with_holes(SMALL, LONG)
    there = np.concatenate([np.flatnonzero(np.isnan(lower))])
    stands = there // 12 < 6
    bottom = np.where(stands, slope().ravel()[there], slope().ravel()[there] + 2.0)
    wall = Ground(there, bottom, bottom + 3.0, is_filled=False)
    filled, nothing = fill(GRID, [ground(lower), wall], "linear", 4.0, 0.3)
    assert set(filled.compartment // 12) == {6}, "the floor goes on under a lintel, not into a wall"
    assert filled.left == 6
    assert len(nothing.compartment) == 0


@given(st.integers(0, 2**32 - 1), st.sampled_from(METHODS), st.floats(0.1, 6.0))
@settings(max_examples=60, deadline=None)
def test_any_layers_keep_their_pillars_and_their_order(seed: int, method: Method, size: float) -> None:
    random = np.random.default_rng(seed)
    rasters = []
    for index in range(random.integers(1, 4)):
        raster = (random.integers(0, 4, (10, 12)) * 0.25 + index).astype(np.float64)
        raster[random.random(raster.shape) < 0.3] = np.nan
        rasters.append(raster)
    made = fill(GRID, [ground(raster) for raster in rasters], method, size, 0.3)
    before = np.full((10, 12), -np.inf)
    for raster, filled in zip(rasters, made, strict=True):
        assert np.isnan(raster.ravel()[filled.compartment]).all(), "a pillar is filled over"
        assert (np.diff(filled.compartment) > 0).all()
        if len(filled.compartment):
            assert filled.elevation.min() >= np.nanmin(raster)
            assert filled.elevation.max() <= np.nanmax(raster)
        whole = raster.copy()
        whole.ravel()[filled.compartment] = filled.elevation
        is_new = np.zeros(120, bool)
        is_new[filled.compartment] = True
        above = np.where(np.isnan(whole), np.inf, whole) >= before + 0.3
        assert above.ravel()[is_new].all(), "what is filled is not above the layer below"
        before = np.fmax(before, whole)


# ---- from the scan to the files --------------------------------------------------------------------


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A slope with a hole of two by three compartments, and a board over a part of it."""
    row, column = (part.ravel() for part in np.indices((40, 60)))
    points = np.column_stack([column * 0.1 + 0.05, row * 0.1 + 0.05, 0.02 * column])
    is_hole = (column // 5 >= 4) & (column // 5 < 7) & (row // 5 >= 3) & (row // 5 < 5)
    board = points[(column // 5 == 4) & (row // 5 == 3)] + [0, 0, 0.15]
    path = tmp_path_factory.mktemp("holed") / "slope.ply"
    write(path, np.concatenate([[[0.0, 0.0, 0.0]], points[~is_hole], board]), {})
    return path


def built(scan: Path, **chosen: Any) -> Reconstruction:
    values = {"cell_size": 0.5, "layer_tolerance": 0.3, "alpha": 0.5, "layering": "rank", "min_points": 2}
    return Pipeline().run([scan], Parameters.checked(**(values | chosen)))


@pytest.mark.parametrize("method", METHODS)
def test_a_stack_keeps_apart_what_was_filled(scan: Path, tmp_path: Path, method: Method) -> None:
    result = built(scan, fill=method, crop=(0, 0, -1, 9, 9, 1.3))
    manifest = write_stack(result, tmp_path / "stack")
    (layer,) = manifest.layers
    assert (layer.filled_mask, layer.filled) == ("layer_00_filled.png", 5)
    gray, mask, filled = (
        np.asarray(Image.open(tmp_path / "stack" / name))
        for name in (layer.image, layer.mask, "layer_00_filled.png")
    )
    assert set(np.unique(filled)) == {0, 255}
    assert np.count_nonzero(filled) == 5
    assert not (filled & mask).any()
    np.testing.assert_array_equal(gray > 0, (filled | mask) > 0)
    plain = write_stack(built(scan, crop=(0, 0, -1, 9, 9, 1.3)), tmp_path / "plain")
    assert (plain.layers[0].filled_mask, plain.layers[0].filled) == (None, 0)
    assert not (tmp_path / "plain" / "layer_00_filled.png").exists()
    measured = np.asarray(Image.open(tmp_path / "plain" / layer.image))
    np.testing.assert_array_equal(np.where(mask > 0, gray, 0), measured)
    assert layer.pillars == plain.layers[0].pillars
    assert check_stack(tmp_path / "stack", [scan]).faults == ()


def test_equal_parameters_give_equal_bytes(scan: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_stack(built(scan, fill="inpaint"), tmp_path / name)
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()


def test_targets_take_what_was_filled_for_ground(scan: Path, tmp_path: Path) -> None:
    manifest = write_stack(built(scan, fill="linear"), tmp_path / "stack")
    terrain = Terrain.of_stack(tmp_path / "stack")
    assert terrain.layers[0].occupied.sum() == manifest.layers[0].pillars + manifest.layers[0].filled
    area = terrain.surface(terrain.layers[0]).plan_area
    assert area == pytest.approx(terrain.layers[0].occupied.sum() * 0.25)
    stack = Stack.open(tmp_path / "stack")
    assert np.isfinite(stack.elevations(manifest.layers[0])).sum() == manifest.layers[0].pillars


def test_a_check_finds_what_is_wrong_with_a_mask(scan: Path, tmp_path: Path) -> None:
    write_stack(built(scan, fill="linear"), tmp_path / "stack")
    path = tmp_path / "stack" / "layer_00_filled.png"
    filled = np.array(Image.open(path))
    occupied = np.argwhere(np.asarray(Image.open(tmp_path / "stack" / "layer_00_mask.png")))[0]
    filled[tuple(occupied)] = 255
    Image.fromarray(filled).save(path)
    faults = check_stack(tmp_path / "stack").faults
    assert any("measured, too" in fault for fault in faults)
    assert any("filled pixels where the manifest says" in fault for fault in faults)
    path.unlink()
    assert any("missing" in fault for fault in check_stack(tmp_path / "stack").faults)


def test_the_size_is_five_compartments_unless_it_is_given(scan: Path) -> None:
    assert built(scan, fill="nearest").parameters.fill_size == 2.5
    assert len(built(scan, fill="nearest", fill_size=1.0).layers[0].filled.compartment) == 0


def test_a_stack_from_before_holes_could_be_filled_loads(scan: Path, tmp_path: Path) -> None:
    write_stack(built(scan), tmp_path / "stack")
    path = tmp_path / "stack" / "manifest.json"
    document = json.loads(path.read_text())
    for name in ("fill", "fill_size", "reconstruction"):
        del document["parameters"][name]
    for entry in document["layers"]:
        del entry["filled"], entry["filled_mask"]
    path.write_text(json.dumps(document))
    assert Manifest.of(tmp_path / "stack").layers[0].filled == 0
    assert check_stack(tmp_path / "stack").faults == ()


def test_what_is_left_is_said(scan: Path, tmp_path: Path) -> None:
    """The board is higher than the slope beside it by less than the tolerance, in the upper layer."""
    low = built(scan, layering="elevation", fill="linear")
    left = sum(layer.filled.left for layer in low.layers)
    said = write_stack(low, tmp_path / "stack").warnings
    assert bool(left) == any("were not filled" in warning for warning in said)


def test_a_real_scan_is_filled_in_order(real_scan: Callable[[str], Path], tmp_path: Path) -> None:
    parameters = Parameters(cell_size=0.1, fill="linear", fill_size=0.5)
    result = Pipeline().run([real_scan("data__room_scan1.pcd")], parameters)
    filled: list[Filled] = [layer.filled for layer in result.layers]
    assert sum(len(each.compartment) for each in filled) > 100
    write_stack(result, tmp_path / "stack")
    assert check_stack(tmp_path / "stack").faults == ()
