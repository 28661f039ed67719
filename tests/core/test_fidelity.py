"""Fidelity tells the truth: known offsets come back as known errors, and nothing outside is counted in."""

import numpy as np
import pytest
from tests.conftest import scan_of

from stepfield.fidelity import vertical
from stepfield.grid import Grid

GRID = Grid(100.0, 200.0, 1.0, 3, 2)
FLOOR = np.full((2, 3), 5.0)
TOP = np.array([[np.nan, 8.0, np.nan], [np.nan, np.nan, np.nan]])


def test_points_are_compared_with_the_nearest_layer_of_their_own_compartment() -> None:
    scan = scan_of([[100.5, 201.5, 5.1], [101.5, 201.5, 7.8], [102.5, 200.5, 8.0]])
    found = vertical(scan, GRID, [FLOOR, TOP], 0.5)
    assert found.max == pytest.approx(3.0)
    assert found.median == pytest.approx(0.2)
    assert found.rmse == pytest.approx(np.sqrt((0.01 + 0.04 + 9) / 3))
    assert found.explained == pytest.approx(2 / 3)


def test_points_in_holes_and_beyond_the_grid_are_outside() -> None:
    scan = scan_of([[100.5, 201.5, 8.0], [99.0, 201.5, 8.0], [101.5, 201.5, 8.0], [101.5, 203.5, 8.0]])
    found = vertical(scan, GRID, [TOP], 0.5)
    assert (found.points, found.outside) == (1, 3)
    assert found.explained == 0.25


def test_a_scan_that_misses_the_stack_altogether_has_no_finite_error() -> None:
    found = vertical(scan_of([[0.0, 0.0, 0.0]]), GRID, [FLOOR], 0.5)
    assert found.points == 0
    assert np.isinf(found.rmse)
    assert found.as_dict()["rmse"] is None
