"""The mesh of complex parts in every target: where it stands, and said where it cannot be had."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.core.targets.stacks import asymmetric, stack_of

from stepfield.parameters import Way
from stepfield.stack.complexfile import save_complex
from stepfield.surface import Mesh
from stepfield.targets import gazebo, geotiff, mesh, mujoco, pybullet, usarsim
from stepfield.targets.target import Options
from stepfield.targets.terrain import Terrain
from stepfield.targets.voxels import solids

Floats = NDArray[np.float64]

#: So far that the files need a local origin.
WEST, SOUTH = 431_003.1, 5_411_992.6
#: West edge and heights of an upright square, metres east of the corner and scan elevations.
AT, LOW, HIGH = 2.1, 5.0, 7.0


def wall(west: float = WEST + AT, south: float = SOUTH + 1.0) -> Mesh:
    """Return a square across the x axis, one metre wide."""
    corners = [[west, south, LOW], [west, south + 1, LOW], [west, south + 1, HIGH], [west, south, HIGH]]
    return Mesh(np.array(corners), np.array([[0, 1, 2], [0, 2, 3]]))


@pytest.fixture(params=["edges", "simulator"])
def terrain(tmp_path: Path, request: pytest.FixtureRequest) -> Terrain:
    way: Way = request.param
    folder = stack_of(tmp_path / "stack", asymmetric(), west=WEST, south=SOUTH, reconstruction=way)
    save_complex(folder / "complex.ply", wall())
    manifest = folder / "manifest.json"
    entry = {"mesh": "complex.ply", "vertices": 4, "triangles": 2, "pillars": 7}
    manifest.write_text(json.dumps(json.loads(manifest.read_text()) | {"complex": entry}))
    return Terrain.of_stack(folder)


@pytest.fixture
def place(terrain: Terrain) -> Floats:
    """Give the middle of the wall in local coordinates."""
    middle = np.array([WEST + AT, SOUTH + 1.5, (LOW + HIGH) / 2])
    return middle - terrain.local_origin


def folder_of(tmp_path: Path) -> Path:
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


def test_the_mesh_is_local(terrain: Terrain, place: Floats) -> None:
    assert terrain.complex_mesh is not None
    assert terrain.complex_mesh.vertices.mean(axis=0) == pytest.approx(place)
    assert np.abs(terrain.complex_mesh.vertices).max() < 100


def test_meshes_have_it_in_every_format(terrain: Terrain, place: Floats, tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh", reason="trimesh reads the meshes")
    folder = folder_of(tmp_path)
    written = mesh.write(terrain, folder, Options())
    assert {f"complex{suffix}" for suffix in mesh.SUFFIXES} <= set(written.files)
    for suffix in mesh.SUFFIXES:
        loaded = trimesh.load(folder / f"complex{suffix}", force="mesh")
        x, y, z = loaded.bounds.mean(axis=0)
        found = (x, -z, y) if suffix == ".glb" else (x, y, z)
        assert found == pytest.approx(place, abs=1e-4)


def test_gazebo_has_a_model_of_it(terrain: Terrain, tmp_path: Path) -> None:
    folder = folder_of(tmp_path)
    written = gazebo.write(terrain, folder, Options())
    found = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert found == set(written.files)
    assert any(file.endswith("_complex/meshes/complex.stl") for file in written.files)
    assert "_complex</uri>" in (folder / "world.sdf").read_text()


def test_pybullets_rays_meet_it(terrain: Terrain, place: Floats, tmp_path: Path) -> None:
    engine = pytest.importorskip("pybullet", reason="pybullet is not installed")
    folder = folder_of(tmp_path)
    pybullet.write(terrain, folder, Options())
    client = engine.connect(engine.DIRECT)
    try:
        bodies = _script(folder).load(client)
        assert len(bodies["complex"]) == 1
        step = np.array([1.0, 0.0, 0.0])
        hit = engine.rayTest(place - step, place + step, physicsClientId=client)[0]
        assert hit[0] == bodies["complex"][0]
        assert hit[3][0] == pytest.approx(place[0], abs=1e-4)
    finally:
        engine.disconnect(client)


def _script(folder: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("load_stack", folder / pybullet.SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    return script


def test_mujoco_sees_it_and_bumps_into_it(terrain: Terrain, place: Floats, tmp_path: Path) -> None:
    engine = pytest.importorskip("mujoco", reason="mujoco is not installed")
    folder = folder_of(tmp_path)
    written = mujoco.write(terrain, folder, Options())
    assert any("boxes" in note for note in written.notes)
    spec = engine.MjSpec.from_file(str(folder / mujoco.SCENE))
    ball = spec.worldbody.add_body(name="ball", pos=place - [0.5, 0, 0])
    ball.add_freejoint()
    ball.add_geom(size=[0.1, 0, 0])
    spec.option.gravity = [5.0, 0.0, 0.0]
    model = spec.compile()
    data = engine.MjData(model)
    engine.mj_step(model, data, 1000)
    assert -0.4 < data.body("ball").xpos[0] - place[0] < 0  # nearer, and not through
    hit = np.array([-1], np.int32)
    only_seen = np.array([1, 0, 0, 0, 0, 0], np.uint8)
    start = place - [1, 0.3, 0.3]
    far = engine.mj_ray(model, data, start, np.array([1.0, 0, 0]), only_seen, 1, -1, hit)
    assert far == pytest.approx(1.0, abs=1e-3)
    assert model.geom(int(hit[0])).name.startswith("complex_seen")


def test_boxes_cover_the_mesh_and_are_no_thicker_than_said() -> None:
    side = 0.25
    made = list(solids(wall(0.0, 0.0), side))
    assert sum((b.east - b.west) * (b.north - b.south) * (b.top - b.bottom) for b in made) <= side * 1.5 * 2.5
    for y in np.linspace(0.01, 0.99, 9):
        for z in np.linspace(LOW + 0.01, HIGH - 0.01, 9):
            assert any(b.south <= y <= b.north and b.bottom <= z <= b.top for b in made)


@pytest.mark.parametrize("limits", [geotiff.limits, usarsim.limits])
def test_those_that_cannot_have_it_say_so(terrain: Terrain, limits: Callable[[Terrain], list[str]]) -> None:
    assert any("7 pillars" in said for said in limits(terrain))
