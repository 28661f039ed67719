"""Pillars are the paper's 5.1 and 5.3.2: wrong parting or heights would falsify every map."""

import numpy as np
import pytest
from tests.conftest import scan_of, scan_of_axes

from stepfield.compartments import sort_into_compartments
from stepfield.pillars import Statistic, StepField, build_pillars
from stepfield.scan import Axis, Scan


def field_of(points: list[list[float]], tolerance: float = 0.5, cell: float = 1.0) -> StepField:
    return build_pillars(sort_into_compartments(scan_of(points), cell), tolerance)


def test_points_part_where_the_gap_exceeds_the_tolerance() -> None:
    field = field_of([[0, 0, z] for z in (0.0, 0.5, 1.0, 1.75, 2.0)])
    assert field.low.tolist() == [0.0, 1.75]
    assert field.high.tolist() == [1.0, 2.0]
    assert field.points.tolist() == [3, 2]
    assert field.elevation.tolist() == pytest.approx([0.5, 1.875], abs=1e-8)


def test_a_gap_of_exactly_the_tolerance_does_not_part_las_integers() -> None:
    raw = np.array([0, 29, 59], np.int32)
    flat = Axis(np.zeros(3))
    scan = Scan(flat, flat, Axis(raw, 0.01, 500.0))
    field = build_pillars(sort_into_compartments(scan, 1.0), 0.29)
    assert field.points.tolist() == [2, 1]


def test_compartments_are_not_joined_across_their_border() -> None:
    field = field_of([[0.5, 0, 0], [1.5, 0, 0.1], [2.0, 0, 0.2]])
    assert field.compartment.tolist() == [0, 1]
    assert field.rank.tolist() == [0, 0]


@pytest.mark.parametrize(
    ("statistic", "expected"), [("mean", 2.0), ("max", 5.0), ("median", 1.5), ("p90", 4.0)]
)
def test_each_statistic_of_a_pillar(statistic: Statistic, expected: float) -> None:
    points = [[0.0, 0.0, z] for z in (0.0, 1.0, 1.5, 2.5, 5.0)]
    field = build_pillars(sort_into_compartments(scan_of(points), 1.0), 10.0, statistic)
    assert field.elevation.tolist() == pytest.approx([expected], abs=1e-8)


def test_a_shift_to_national_coordinates_changes_nothing_for_las_integers() -> None:
    rng = np.random.default_rng(1)
    raw = rng.integers(0, 100_000, (3, 5000)).astype(np.int32)
    offsets = (600_000.0, 5_400_000.0, 300.0)
    here = scan_of_axes(*(Axis(r, 0.001) for r in raw))
    there = scan_of_axes(*(Axis(r, 0.001, offset) for r, offset in zip(raw, offsets, strict=True)))
    near, far = (build_pillars(sort_into_compartments(scan, 0.7), 0.3) for scan in (here, there))
    assert np.array_equal(near.compartment, far.compartment)
    assert np.array_equal(near.elevation, far.elevation)


def test_elevations_of_a_mountain_keep_a_micrometre() -> None:
    z = np.array([0.0, 1234.567891, 4000.0])
    field = build_pillars(sort_into_compartments(scan_of(np.c_[np.zeros((3, 2)), z]), 1.0), 0.5)
    assert np.abs(field.elevation - z).max() < 2e-6


def test_boxes_are_in_scan_coordinates() -> None:
    field = field_of([[10.0, 20.0, 5.0], [11.0, 20.0, 7.0]])
    assert field.boxes(np.array([0])).tolist() == [[10.0, 20.0, 11.0, 21.0, 5.0, 5.0]]
