"""Meshes as an independent reader (trimesh) finds them."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.core.targets.stacks import SOUTH, WEST, asymmetric, height_at, places_in, rays, stack_of

from stepfield.stack import Stack
from stepfield.surface import Mesh
from stepfield.targets import mesh as target
from stepfield.targets.target import Options
from stepfield.targets.terrain import Terrain
from stepfield.targets.thickening import thickened

trimesh = pytest.importorskip("trimesh", reason="trimesh reads the meshes; pip install trimesh")

SUFFIXES = (".glb", ".obj", ".stl", ".ply")


def loaded(path: Path) -> Any:
    """Read a mesh, z up again."""
    found = trimesh.load_mesh(path, process=False)
    if path.suffix == ".glb":
        found.apply_transform([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    return found


def corners(found: Any) -> NDArray[np.float64]:
    """Return corners of the triangles in an order of their own, shape (T, 9): STL has no vertices."""
    flat = np.round(np.asarray(found.triangles), 4).reshape(-1, 9) + 0.0
    return flat[np.lexsort(flat.T)]


@pytest.fixture(scope="module")
def written(asymmetric_stack: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("mesh")
    made = target.write(Terrain.of_stack(asymmetric_stack), folder, Options())
    found = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert found == set(made.files)
    return folder


@pytest.mark.parametrize(("layer", "suffix"), list(itertools.product(range(2), SUFFIXES)))
def test_every_format_holds_the_reconstruction(
    written: Path, asymmetric_stack: Path, layer: int, suffix: str
) -> None:
    stack = Stack.open(asymmetric_stack)
    elevations = stack.elevations(stack.manifest.layers[layer])
    places = places_in((WEST, SOUTH), 0.25, elevations.shape)
    expected = height_at(elevations, (WEST, SOUTH), 0.25, places)
    for folder, bound in ((written, 1e-3), (written / "decimated", 0.25 / 4 + 1e-3)):
        found = loaded(folder / f"layer_{layer:02d}{suffix}")
        heights = rays(np.asarray(found.vertices), np.asarray(found.faces), places)
        np.testing.assert_array_equal(np.isfinite(heights), np.isfinite(expected))
        assert np.nanmax(np.abs(heights - expected)) <= bound
        assert (np.asarray(found.face_normals)[:, 2] > 0).all(), "seen from above"


@pytest.mark.parametrize("layer", [0, 1])
def test_the_formats_hold_the_same_triangles(written: Path, layer: int) -> None:
    for folder in (written, written / "decimated"):
        first, *others = (corners(loaded(folder / f"layer_{layer:02d}{suffix}")) for suffix in SUFFIXES)
        for other in others:
            np.testing.assert_allclose(other, first, atol=2e-4)


@pytest.mark.parametrize("suffix", [".glb", ".obj", ".ply"])
def test_vertices_are_welded_and_used(written: Path, suffix: str) -> None:
    found = loaded(written / f"layer_01{suffix}")
    np.testing.assert_array_equal(np.unique(found.faces), np.arange(len(found.vertices)))
    assert len(np.unique(found.vertices, axis=0)) == len(found.vertices)


def test_a_vertex_is_the_pillar_itself(written: Path) -> None:
    """Every pillar beside which a quad survives, and no other, is a vertex."""
    expected = asymmetric()[1]
    vertices = np.asarray(loaded(written / "layer_01.ply").vertices)
    column = (vertices[:, 0] - WEST) / 0.25 - 0.5
    row = 23.5 - (vertices[:, 1] - SOUTH) / 0.25
    np.testing.assert_allclose([row, column], np.rint([row, column]), atol=1e-4)
    at = expected[np.rint(row).astype(int), np.rint(column).astype(int)]
    assert np.abs(at - vertices[:, 2]).max() < 1e-3
    whole = np.pad(np.isfinite(expected[:-1, :-1] + expected[:-1, 1:] + expected[1:, :-1] + expected[1:, 1:]), 1)  # fmt: skip  # noqa: E501
    assert len(vertices) == (whole[:-1, :-1] | whole[:-1, 1:] | whole[1:, :-1] | whole[1:, 1:]).sum()


def test_glb_is_y_up_and_says_where_it_was(tmp_path: Path) -> None:
    layers = [layer + 100 for layer in asymmetric()]
    stack = stack_of(tmp_path / "s", layers, west=600_000, south=5_400_000, base=99.0)
    target.write(Terrain.of_stack(stack), tmp_path, Options())
    scene = trimesh.load_scene(tmp_path / "layer_00.glb")
    (low, high) = scene.bounds
    assert 99 < low[1] < high[1] < 105
    assert -6.1 < low[2] < high[2] < 0, "north is minus z"
    (name,) = scene.graph.nodes_geometry
    assert name == "Layer 1"
    assert b'"local_origin":[600000.0,5400000.0,0.0]' in (tmp_path / "layer_00.glb").read_bytes()


def test_the_same_stack_makes_the_same_bytes(written: Path, asymmetric_stack: Path, tmp_path: Path) -> None:
    made = target.write(Terrain.of_stack(asymmetric_stack), tmp_path, Options())
    for name in made.files:
        assert (tmp_path / name).read_bytes() == (written / name).read_bytes(), name


@pytest.mark.parametrize("bad", ['a"b\\<&>', "line\nbreak\r\n", "日本\u2028 \x00\x07"])
def test_names_may_hold_anything(tmp_path: Path, bad: str) -> None:
    stack = stack_of(tmp_path / "s", asymmetric(), names=[bad, bad], name=f"{bad}.ply")
    (tmp_path / "out").mkdir()
    target.write(Terrain.of_stack(stack), tmp_path / "out", Options())
    for suffix in SUFFIXES:
        assert len(loaded(tmp_path / "out" / f"layer_00{suffix}").faces) == 2 * 23 * 36
    assert "\x07" not in (tmp_path / "out" / "README.txt").read_text()


@pytest.mark.parametrize("bound", [None, 0.06])
def test_thickened_bodies_are_closed(stack: Path, bound: float | None) -> None:
    terrain = Terrain.of_stack(stack)
    for layer in terrain.layers:
        sheet = terrain.surface(layer, bound)
        if not len(sheet.triangles):
            continue
        body = thickened(sheet, 0.05)
        found = trimesh.Trimesh(body.vertices, body.triangles, process=False)
        assert found.is_watertight
        assert found.is_winding_consistent
        assert found.volume == pytest.approx(sheet.plan_area * 0.05)


def test_parts_that_meet_in_a_vertex_are_parted() -> None:
    """Two quads corner to corner would share an upright edge of four walls."""
    vertices = np.array([[x, y, 0.0] for y in range(3) for x in range(3)])
    triangles = np.array([[0, 1, 4], [0, 4, 3], [4, 5, 8], [4, 8, 7]])
    used = np.unique(triangles)
    body = thickened(Mesh(vertices[used], np.searchsorted(used, triangles)), 1.0)
    found = trimesh.Trimesh(body.vertices, body.triangles, process=False)
    assert found.is_watertight
    assert found.volume == pytest.approx(2)
    assert found.body_count == 2


def test_thicken_and_decimate_reach_the_files(asymmetric_stack: Path, tmp_path: Path) -> None:
    target.write(Terrain.of_stack(asymmetric_stack), tmp_path, Options(thicken=0.2, decimate=0.5))
    for name in ("layer_01.obj", "decimated/layer_01.obj"):
        assert loaded(tmp_path / name).is_watertight
    whole, few = (loaded(tmp_path / name) for name in ("layer_01.obj", "decimated/layer_01.obj"))
    assert len(few.faces) < 0.8 * len(whole.faces)
    assert "0.2 m thick" in (tmp_path / "README.txt").read_text()
    assert "further than 0.5 m" in (tmp_path / "README.txt").read_text()


def test_a_layer_without_a_surface_is_said(tmp_path: Path) -> None:
    lonely = np.full((24, 37), np.nan)
    lonely[3, 5] = 7.0
    terrain = Terrain.of_stack(stack_of(tmp_path / "s", [*asymmetric(), lonely]))
    (tmp_path / "out").mkdir()
    made = target.write(terrain, tmp_path / "out", Options())
    assert not any("layer_02" in name for name in made.files)
    assert any("layer_02 has no surface" in note for note in made.notes)
    assert "layer_02 has no surface" in (tmp_path / "out" / "README.txt").read_text()
