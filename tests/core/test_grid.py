"""The grid is the only world-to-row arithmetic: an error here shifts every image by half a cell."""

import numpy as np
import pytest

from stepfield.errors import GridError
from stepfield.grid import Grid


def test_row_zero_is_north_and_column_zero_is_west() -> None:
    grid = Grid.over(100.0, 200.0, 2.5, 1.5, 0.5)
    assert (grid.columns, grid.rows) == (5, 3)
    corners = grid.compartment(np.array([0.0, 2.4, 0.0, 2.4]), np.array([1.4, 1.4, 0.0, 0.0]))
    rows, columns = grid.row_column(corners)
    assert rows.tolist() == [0, 0, 2, 2]
    assert columns.tolist() == [0, 4, 0, 4]


def test_the_far_edge_belongs_to_the_last_compartment() -> None:
    grid = Grid.over(0.0, 0.0, 2.0, 2.0, 0.5)
    assert (grid.columns, grid.rows) == (4, 4)
    assert grid.compartment(np.array([2.0]), np.array([2.0])).tolist() == [3]


def test_a_rounding_error_makes_no_extra_column() -> None:
    assert Grid.over(0.0, 0.0, 0.3 + 1e-12, 0.1, 0.1).columns == 3


def test_a_scan_without_extent_still_has_one_compartment() -> None:
    assert len(Grid.over(5.0, 5.0, 0.0, 0.0, 0.1)) == 1


def test_squares_and_centres_are_where_the_points_came_from() -> None:
    grid = Grid.over(10.0, -4.0, 3.0, 2.0, 1.0)
    square = grid.squares(grid.compartment(np.array([2.5]), np.array([0.5])))
    assert square.tolist() == [[12.0, -4.0, 13.0, -3.0]]
    assert grid.centres(grid.compartment(np.array([2.5]), np.array([0.5]))).tolist() == [[12.5, -3.5]]


@pytest.mark.parametrize("cell_size", [1e-6, 1e-300])
def test_an_absurd_grid_is_refused_and_the_advised_cell_size_works(cell_size: float) -> None:
    with pytest.raises(GridError, match="use at least") as caught:
        Grid.over(0.0, 0.0, 1000.0, 1000.0, cell_size)
    advised = float(str(caught.value).split("use at least ")[1].split(" m")[0])
    assert len(Grid.over(0.0, 0.0, 1000.0, 1000.0, advised)) > 0
