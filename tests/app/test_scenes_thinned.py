"""What is shown of a large step-field while a hand moves: some compartments, and all their pillars."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.app.scenes_made import UTM, table_result

from stepfield.reconstruction import Reconstruction
from stepfield_app.scenes.raster import elevations, raster, thumbnails
from stepfield_app.scenes.stacks import step_field
from stepfield_app.scenes.thinned import coarse_grid, pixels, stride_for, thinned

ALL = (-1, 0, 1)


@pytest.fixture
def result(tmp_path: Path) -> Reconstruction:
    return table_result(tmp_path, UTM)


@pytest.mark.parametrize("stride", [2, 3, 5])
def test_chosen_compartments_keep_their_middles_and_all_their_pillars(
    result: Reconstruction, stride: int
) -> None:
    field, some = result.field, thinned(result, stride)
    grid = field.compartments.grid
    row, column = grid.row_column(field.compartment)
    assert np.array_equal(some.pillars, np.flatnonzero((row % stride == 0) & (column % stride == 0)))
    middles = some.grid.centres(some.compartment)
    assert np.allclose(middles, grid.centres(field.compartment[some.pillars]), rtol=0, atol=1e-8)


def test_a_stride_of_one_keeps_everything(result: Reconstruction) -> None:
    assert np.array_equal(thinned(result, 1).pillars, np.arange(len(result.field)))
    [layer] = pixels(result, [1])
    assert np.array_equal(layer.elevation, result.layers[1].elevation)


def test_thinned_pictures_show_the_same_elevations(result: Reconstruction) -> None:
    whole = elevations(result, 0)
    thin = raster(result, 0, "hillshade", stride=2).elevations
    assert np.array_equal(thin, whole[::2, ::2], equal_nan=True)
    assert thumbnails(result, ALL, 8, stride=2).keys() == set(ALL)


def test_thinned_blocks_stand_where_they_stood_and_are_larger(result: Reconstruction) -> None:
    origin = result.scan.bounds()[0]
    whole, thin = step_field(result, origin, ALL), step_field(result, origin, ALL, stride=2)
    assert thin.lattice.cell_size == pytest.approx(2 * whole.lattice.cell_size)
    row, column = np.divmod(whole.compartment, whole.lattice.shape[1])
    kept = (row % 2 == 0) & (column % 2 == 0)
    for name in ("layer", "top", "standing"):
        assert np.array_equal(getattr(thin, name), getattr(whole, name)[kept]), name


def test_a_stride_leaves_about_as_many_as_asked_for(result: Reconstruction) -> None:
    assert stride_for(100, 100) == stride_for(0, 10) == 1
    assert stride_for(1_000_000, 40_000) == 5
    grid = result.field.compartments.grid
    assert len(coarse_grid(grid, 4)) == (-(-grid.rows // 4)) * (-(-grid.columns // 4))
