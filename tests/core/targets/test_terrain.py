"""A stack decoded: every height in its place, in coordinates that a simulator's float32 can hold."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from tests.core.targets.stacks import CELL, SOUTH, WEST, asymmetric, height_at, places_in, rays, stack_of

from stepfield.errors import StackError
from stepfield.targets.terrain import Terrain


def test_heights_and_holes_are_those_that_went_in(asymmetric_stack: Path) -> None:
    terrain = Terrain.of_stack(asymmetric_stack)
    for layer, expected in zip(terrain.layers, asymmetric(), strict=True):
        assert layer.elevations.dtype == np.float32
        np.testing.assert_array_equal(layer.occupied, np.isfinite(expected))
        assert np.nanmax(np.abs(layer.elevations - expected)) <= layer.half_level + 1e-6


def test_samples_stand_in_the_middles_of_their_compartments(asymmetric_stack: Path) -> None:
    terrain = Terrain.of_stack(asymmetric_stack)
    assert (terrain.west, terrain.south) == pytest.approx((WEST + CELL / 2, SOUTH + CELL / 2))
    assert (terrain.columns, terrain.rows) == (37, 24)
    assert terrain.east == pytest.approx(WEST + 36.5 * CELL)
    assert terrain.north == pytest.approx(SOUTH + 23.5 * CELL)
    assert terrain.local_origin == (0, 0, 0)


@pytest.mark.parametrize(
    ("place", "origin"),
    [
        ((9_000.0, -9_000.0, 900.0), (0, 0, 0)),
        ((600_000.3, 5_400_000.7, 300.0), (600_000, 5_400_000, 0)),
        ((-9_995.0, 9_995.0, 0.0), (-9_995, 9_995, 0)),  # its far side is beyond ten kilometres
        ((5.0, 5.0, -12_000.25), (0, 0, -12_001)),
    ],
)
def test_far_coordinates_lose_nothing(
    tmp_path: Path, place: tuple[float, float, float], origin: tuple[float, float, float]
) -> None:
    """In float32 a UTM northing would be half a metre off."""
    west, south, up = place
    layers = [layer + up for layer in asymmetric()]
    terrain = Terrain.of_stack(
        stack_of(tmp_path / "s", layers, west=west, south=south, base=up - 0.5, cell=0.25)
    )
    assert terrain.local_origin == origin
    mesh = terrain.surface(terrain.layers[1])
    back = mesh.vertices.astype(np.float32).astype(np.float64) + terrain.local_origin
    found = height_at(layers[1], (west, south), 0.25, back[:, :2])
    inside = np.isfinite(found)  # those on the rim may lie a rounding error outside
    assert inside.mean() > 0.7
    assert np.abs(found - back[:, 2])[inside].max() < 1e-3


def test_the_surface_is_that_of_section_6(stack: Path) -> None:
    """A ray meets the surface where four neighbours are there, and nothing anywhere else."""
    terrain = Terrain.of_stack(stack)
    half = terrain.cell_size / 2
    corner = (terrain.west - half, terrain.south - half)
    places = places_in(corner, terrain.cell_size, (terrain.rows, terrain.columns))
    for layer in terrain.layers:
        mesh = terrain.surface(layer)
        expected = height_at(layer.elevations.astype(np.float64), corner, terrain.cell_size, places)
        found = rays(mesh.vertices, mesh.triangles, places)
        np.testing.assert_array_equal(np.isfinite(found), np.isfinite(expected))
        assert np.abs(found - expected)[np.isfinite(expected)].max(initial=0) < 1e-3


def test_vertices_are_shared_and_none_is_unused(asymmetric_stack: Path) -> None:
    """An unused one makes MuJoCo 3.2 draw wrong faces; a doubled one opens seams."""
    terrain = Terrain.of_stack(asymmetric_stack)
    for bound in (None, 0.05):
        mesh = terrain.surface(terrain.layers[1], bound)
        np.testing.assert_array_equal(np.unique(mesh.triangles), np.arange(len(mesh.vertices)))
        assert len(np.unique(mesh.vertices, axis=0)) == len(mesh.vertices)


def test_a_layer_without_four_neighbours_has_an_empty_surface(tmp_path: Path) -> None:
    lonely = np.full((24, 37), np.nan)
    lonely[3, 5] = lonely[3, 6] = 7.0
    terrain = Terrain.of_stack(stack_of(tmp_path / "s", [*asymmetric(), lonely]))
    for bound in (None, 0.01):
        mesh = terrain.surface(terrain.layers[2], bound)
        assert mesh.vertices.shape == mesh.triangles.shape == (0, 3)


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1)])
def test_a_grid_of_one_row_has_no_surface(tmp_path: Path, shape: tuple[int, int]) -> None:
    terrain = Terrain.of_stack(stack_of(tmp_path / "s", [np.ones(shape)]))
    assert len(terrain.surface(terrain.layers[0]).triangles) == 0
    assert len(terrain.surface(terrain.layers[0], 0.1).triangles) == 0
    assert not terrain.layers[0].is_whole


def test_8_bits_decode_from_the_middles_of_their_levels(tmp_path: Path) -> None:
    terrain = Terrain.of_stack(stack_of(tmp_path / "s", asymmetric(), bits=8))
    for layer, expected in zip(terrain.layers, asymmetric(), strict=True):
        assert layer.half_level > 0.01
        assert np.nanmax(np.abs(layer.elevations - expected)) <= layer.half_level + 1e-6


class TestWhatIsNoStack:
    def refusal(self, folder: Path) -> str:
        with pytest.raises(StackError) as error:
            Terrain.of_stack(folder)
        return str(error.value)

    def changed(self, folder: Path, **values: object) -> Path:
        stack_of(folder, asymmetric())
        document = json.loads((folder / "manifest.json").read_text()) | values
        (folder / "manifest.json").write_text(json.dumps(document))
        return folder

    def test_an_empty_folder(self, tmp_path: Path) -> None:
        assert "cannot read the stack" in self.refusal(tmp_path)

    def test_a_newer_version(self, tmp_path: Path) -> None:
        assert "newer Stepfield" in self.refusal(self.changed(tmp_path / "s", version=99))

    def test_layers_of_one_number(self, tmp_path: Path) -> None:
        folder = self.changed(tmp_path / "s")
        document = json.loads((folder / "manifest.json").read_text())
        document["layers"][1]["index"] = 0
        (folder / "manifest.json").write_text(json.dumps(document))
        assert "not numbered 0, 1, 2" in self.refusal(folder)

    def test_a_grid_larger_than_its_images(self, tmp_path: Path) -> None:
        grid = {"origin": [0, 0], "cell_size": 1.0, "columns": 999, "rows": 24}
        assert "does not fit" in self.refusal(self.changed(tmp_path / "s", grid=grid))

    def test_heights_beyond_all_numbers(self, tmp_path: Path) -> None:
        folder = self.changed(tmp_path / "s")
        document = json.loads((folder / "manifest.json").read_text())
        document["layers"][0]["scale"] = 1e300
        (folder / "manifest.json").write_text(json.dumps(document))
        assert "beyond what any simulator" in self.refusal(folder)
