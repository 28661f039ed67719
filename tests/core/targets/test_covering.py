"""Fewer triangles of the edges surface: the bound, the same ground, and no cracks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.core.targets.stacks import places_in, rays
from tests.core.targets.test_decimation import RASTERS

from stepfield.grid import Grid
from stepfield.surface import Mesh, Sheet, sheets
from stepfield.surface.edges import mesh_of
from stepfield.targets.covering import covered
from stepfield.targets.thickening import thickened

STEP = 0.3


def sheet_of(raster: NDArray[np.float32]) -> Sheet:
    grid = Grid(0.0, 0.0, 1.0, raster.shape[1], raster.shape[0])
    there = np.flatnonzero(np.isfinite(raster))
    (sheet,) = sheets(grid, [(there, raster.ravel()[there].astype(np.float64))], STEP)
    return sheet


def rim(mesh: Mesh) -> float:
    """Length in the plan of the edges that one triangle only has."""
    edges = mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    there = {tuple(edge) for edge in edges.tolist()}
    assert len(there) == len(edges), "two triangles use an edge in the same direction"
    alone = np.array([edge for edge in there if edge[::-1] not in there], np.int64).reshape(-1, 2)
    reach = np.abs(np.diff(mesh.vertices[alone], axis=1)[:, 0])
    return float(reach[:, :2].sum())


@pytest.mark.parametrize("raster", RASTERS)
@pytest.mark.parametrize("tolerance", [0.0, 0.005, 0.03, 1.0])
def test_it_stays_within_the_tolerance_and_covers_the_same(
    raster: NDArray[np.float32], tolerance: float
) -> None:
    sheet = sheet_of(raster)
    whole, fewer = mesh_of(sheet), covered(sheet, tolerance)
    assert len(fewer.triangles) <= len(whole.triangles)
    assert fewer.plan_area == pytest.approx(np.isfinite(raster).sum(), rel=1e-9)
    places = places_in((0, 0), 1.0, raster.shape, 4000)
    expected, found = (rays(mesh.vertices, mesh.triangles, places) for mesh in (whole, fewer))
    np.testing.assert_array_equal(np.isfinite(found), np.isfinite(expected))
    assert np.abs(found - expected)[np.isfinite(expected)].max(initial=0) <= tolerance + 1e-4


@pytest.mark.parametrize("raster", RASTERS)
def test_no_crack_opens(raster: NDArray[np.float32]) -> None:
    """Were there one, it would add to the length of the rim."""
    sheet = sheet_of(raster)
    assert rim(covered(sheet, 0.03)) == pytest.approx(rim(mesh_of(sheet)))


@given(st.integers(1, 9), st.integers(1, 9), st.data())
@settings(max_examples=100, deadline=None)
def test_any_layer_keeps_its_ground_its_rim_and_its_risers(
    rows: int, columns: int, data: st.DataObject
) -> None:
    tops = st.lists(st.sampled_from([np.nan, 0.0, 0.125, 0.25, 1.0]), min_size=rows * columns)
    raster = np.array(data.draw(tops)[: rows * columns], np.float32).reshape(rows, columns)
    sheet = sheet_of(raster)
    fewer = covered(sheet, 0.1)
    assert fewer.plan_area == pytest.approx(np.isfinite(raster).sum())
    assert rim(fewer) == pytest.approx(rim(mesh_of(sheet)))
    np.testing.assert_array_equal(np.unique(fewer.triangles), np.arange(len(fewer.vertices)))


def test_a_plane_needs_few() -> None:
    row, column = np.indices((256, 256))
    slope = (row * 0.125 - column * 0.25).astype(np.float32)
    inner = covered(sheet_of(slope), 1e-6)
    assert len(inner.triangles) < 0.05 * 4 * slope.size, "its rim, where corners are averages of fewer, aside"


def test_where_nothing_is_nothing_comes() -> None:
    made = covered(sheet_of(np.full((30, 30), np.nan, np.float32)), 0.1)
    assert made.triangles.shape == (0, 3)


@pytest.mark.parametrize("raster", RASTERS)
def test_it_can_be_closed(raster: NDArray[np.float32]) -> None:
    """A body so thick: as large as the ground is, and every edge of it has a triangle on either side."""
    for sheet in (mesh_of(sheet_of(raster)), covered(sheet_of(raster), 0.03)):
        body = thickened(sheet, 0.25)
        assert rim(body) == 0
        a, b, c = (body.vertices[body.triangles[:, i]] for i in range(3))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
        assert volume == pytest.approx(0.25 * np.isfinite(raster).sum(), rel=1e-6)
