"""A wall taken for ground is a pit at half its height; ground taken for a wall is a hole in the ground."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.conftest import scan_of
from tests.core.walled import CELL, TOLERANCE, walled

from stepfield.compartments import sort_into_compartments
from stepfield.parameters import Parameters
from stepfield.pillars import StepField, build_pillars
from stepfield.pipeline import Pipeline
from stepfield.scan.write import write
from stepfield.synth import synthesise

Floats = NDArray[np.float64]


def field_of(points: Floats, cell: float = 0.25, tolerance: float = 0.5) -> StepField:
    return build_pillars(sort_into_compartments(scan_of(points), cell), tolerance)


def column(heights: Floats) -> Floats:
    """Points above one place."""
    return np.column_stack([np.zeros((len(heights), 2)), heights])


def plane(slope: float, side: float = 10.0, step: float = 0.05) -> Floats:
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.arange(0, side, step)] * 2))
    return np.column_stack([x, y, slope * x])


def test_a_wall_is_vertical_and_the_floor_at_its_foot_is_not() -> None:
    """The wall's compartment holds floor, too: seen from one side, that is how walls are scanned."""
    floor = plane(0)
    rise = np.column_stack(
        [np.full(400, 5.1), np.repeat(np.arange(0, 10, 0.5), 20), np.tile(np.arange(20) / 10, 20)]
    )
    field = field_of(np.concatenate([floor, rise]))
    _, columns = field.compartments.grid.row_column(field.compartment[field.vertical])
    assert set(columns.tolist()) == {20}
    assert field.vertical.sum() == 20


def test_a_lintel_is_vertical_and_what_lies_beneath_it_is_not() -> None:
    field = field_of(column(np.concatenate([[0.0, 0.01], np.arange(2.0, 3.0, 0.1)])))
    assert field.vertical.tolist() == [False, True]


@pytest.mark.parametrize("cell", [0.5, 1.0, 5.0])
def test_a_hillside_of_45_degrees_is_ground_however_coarse_the_cells(cell: float) -> None:
    """It climbs by a whole compartment in each of them, more than the tolerance."""
    field = field_of(plane(1.0, 30.0, 0.1), cell, tolerance=0.2)
    assert (field.high - field.low).max() > 0.2
    assert not field.vertical.any()


@pytest.mark.parametrize("cell", [0.25, 1.0])
def test_a_cliff_is_vertical(cell: float) -> None:
    assert field_of(plane(4.0, step=0.02), cell).vertical.mean() > 0.9


def test_two_floors_within_the_tolerance_are_no_wall() -> None:
    """Three sheets 0.3 m apart make one pillar of 0.6 m: most of that is air."""
    field = field_of(column(np.array([0.0, 0.01, 0.3, 0.31, 0.6, 0.61])), tolerance=0.5)
    assert len(field) == 1
    assert not field.vertical.any()


@pytest.mark.parametrize(("height", "is_wall"), [(0.49, False), (0.5, False), (0.53, True)])
def test_a_run_of_exactly_the_tolerance_is_no_wall(height: float, is_wall: bool) -> None:
    heights = np.append(np.arange(0, height, 0.07), height)
    assert field_of(column(heights), cell=0.1).vertical.tolist() == [is_wall]


def reference(points: Floats, field: StepField, tolerance: float) -> list[bool]:
    """Walk up the points of each pillar and add the steps that are no wider than a compartment."""
    cells = field.compartments
    cell = cells.grid.cell_size
    found = []
    for begin, end in zip(field.start[:-1], field.start[1:], strict=True):
        steps = np.diff(cells.ticks[begin:end].astype(float)) * cells.tick
        found.append(bool(steps[steps <= cell].sum() > max(tolerance, 2 * cell)))
    return found


@given(
    st.lists(st.integers(0, 4096), min_size=1, max_size=200),
    st.sampled_from([0.125, 0.25, 0.5]),
    st.sampled_from([0.0625, 0.25, 0.5, 1.0]),
)
def test_vertical_is_what_walking_up_the_points_says(
    heights: list[int], cell: float, tolerance: float
) -> None:
    random = np.random.default_rng(len(heights))
    points = np.column_stack([random.random((len(heights), 2)), np.array(heights) / 1024])
    field = field_of(points, cell, tolerance)
    assert field.vertical.tolist() == reference(points, field, tolerance)


@pytest.mark.parametrize("scene", ["inclined-plane", "crossing-plane", "three-planes"])
def test_planes_have_no_walls(scene: str) -> None:
    field = field_of(synthesise(scene, 100_000).points, 0.1, 0.3)
    assert not field.vertical.any()


def test_on_the_ramp_only_its_columns_and_walls_are_vertical() -> None:
    scan = synthesise("ramp")
    field = field_of(scan.points, 0.2, 0.5)
    is_upright = np.array([name.startswith(("column", "wedge")) for name in scan.names])
    low = scan.points.min(axis=0)
    at = field.compartments.grid.compartment(*(scan.points[is_upright[scan.surface], :2] - low[:2]).T)
    assert field.vertical.any()
    assert np.isin(field.compartment[field.vertical], at).all()


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [("data__room_scan1.pcd", 0.03, 0.08), ("3dfier__ahn3_cropped_2.laz", 0.08, 0.15)],
)
def test_real_walls_and_facades_are_found(
    real_scan: Callable[[str], Path], name: str, least: float, most: float
) -> None:
    """The shares were looked at: room walls and shelves, facades and trees."""
    result = Pipeline().run([real_scan(name)], Parameters())
    assert least < result.field.vertical.mean() < most


def test_a_preview_knows_the_walls_of_the_whole_scan(tmp_path: Path) -> None:
    """Fewer points lie further apart: walls that vanished while a hand moves would flicker."""
    write(tmp_path / "room.ply", walled(), {})
    pipeline, parameters = Pipeline(), Parameters(cell_size=CELL, layer_tolerance=TOLERANCE)
    exact = pipeline.run([tmp_path / "room.ply"], parameters).field
    preview = pipeline.run([tmp_path / "room.ply"], parameters, most_points=len(walled()) // 6).field
    found = np.isin(exact.compartment[exact.vertical], preview.compartment[preview.vertical])
    assert found.mean() > 0.6
    assert np.isin(preview.compartment[preview.vertical], exact.compartment[exact.vertical]).all()


def test_walls_to_their_tops_change_nothing_else() -> None:
    heights = np.concatenate([[0.0, 0.01], np.arange(2.0, 3.0, 0.1)])
    field = field_of(column(heights))
    raised = field.with_walls_to_their_tops()
    assert raised.elevation.tolist() == [field.elevation[0], field.high[1]]
    assert raised.vertical.tolist() == field.vertical.tolist()
    assert field.elevation[1] < 2.6
