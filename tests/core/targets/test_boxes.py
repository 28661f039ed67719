"""Obstacles as solids: through walls and against open doors, no drive in a simulator is worth anything."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.core.targets.stacks import rays
from tests.core.walled import CELL, COLUMN, COLUMN_TOP, DOOR, LINTEL, TOLERANCE, TOP, WALL, walled

from stepfield.errors import TargetError
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.scan.write import write
from stepfield.simulate import worlds
from stepfield.simulate.drive import drive
from stepfield.simulate.route import Route, parse_commands, parse_start
from stepfield.stack import write_stack
from stepfield.targets import mujoco as mujoco_target
from stepfield.targets.boxes import as_boxes, boxes, feet
from stepfield.targets.terrain import Terrain, TerrainLayer
from stepfield.targets.writing import write_targets

Raster = NDArray[np.float32]

BALL = 0.15  # metres


def stack_in(folder: Path, points: NDArray[np.float64], **chosen: Any) -> Path:
    write(folder / "room.ply", points, {})
    values = {"cell_size": CELL, "layer_tolerance": TOLERANCE, "alpha": 0.1, "walls": "layer"} | chosen
    write_stack(Pipeline().run([folder / "room.ply"], Parameters(**values)), folder / "stack")
    return folder / "stack"


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return stack_in(tmp_path_factory.mktemp("room"), walled())


@pytest.fixture(scope="module")
def exported(room: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("exported")
    write_targets(room, ["mesh", "geotiff", "mujoco", "pybullet", "gazebo"], folder)
    return folder


def test_few_boxes_stand_for_many_pillars(room: Path) -> None:
    terrain = Terrain.of_stack(room)
    obstacles = terrain.layers[1]
    assert obstacles.is_obstacles
    made = sorted(boxes(terrain, obstacles), key=lambda box: (box.west, box.south))
    assert len(made) == 4  # the column, the wall on either side of the door, and the lintel
    column, south, lintel, north = made
    assert (column.top, column.bottom) == pytest.approx((COLUMN_TOP, 0), abs=0.01)
    assert [box.bottom for box in (south, lintel, north)] == pytest.approx([0, LINTEL, 0], abs=0.01)
    assert (lintel.south, lintel.north) == pytest.approx(DOOR)
    assert {round(box.top, 2) for box in made} == {COLUMN_TOP, TOP}


def made_of(tops: Raster, bottoms: Raster) -> Terrain:
    """Return a terrain of one layer of obstacles."""
    layer = TerrainLayer(0, "Obstacles", tops, 0.0, bottoms)
    rows, columns = tops.shape
    manifest: Any = None  # nothing here looks into it
    return Terrain(
        "made", 0.5, columns, rows, 3.0, 7.0, (0.0, 0.0, 0.0), -1.0, (layer,), None, "m", 1.0, manifest
    )


@settings(max_examples=50)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.1, 0.5]))
def test_boxes_cover_every_pillar_once_and_none_too_little(seed: int, bound: float) -> None:
    random = np.random.default_rng(seed)
    shape = tuple(random.integers(1, 9, 2))
    bottoms = random.integers(0, 3, shape) / 8
    tops = bottoms + 1 + random.integers(0, 3, shape) / 8
    tops[random.random(shape) < 0.4] = np.nan
    bottoms[np.isnan(tops)] = np.nan
    terrain = made_of(tops.astype(np.float32), bottoms.astype(np.float32))
    covered = np.zeros(shape, int)
    for box in boxes(terrain, terrain.layers[0], bound):
        rows = slice(round((7.25 - box.north) / 0.5), round((7.25 - box.south) / 0.5))
        columns = slice(round((box.west - 2.75) / 0.5), round((box.east - 2.75) / 0.5))
        covered[rows, columns] += 1
        assert ((tops[rows, columns] <= box.top) & (tops[rows, columns] >= box.top - bound)).all()
        assert ((bottoms[rows, columns] >= box.bottom) & (bottoms[rows, columns] <= box.bottom + bound)).all()
    assert np.array_equal(covered, ~np.isnan(tops))


def test_boxes_as_a_mesh_are_closed_and_look_outwards(room: Path) -> None:
    terrain = Terrain.of_stack(room)
    mesh = as_boxes(terrain, terrain.layers[1])
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    wall = (4.0 - (DOOR[1] - DOOR[0])) * CELL * TOP + (DOOR[1] - DOOR[0]) * CELL * (TOP - LINTEL)
    assert volume == pytest.approx(wall + COLUMN_TOP * CELL**2, rel=0.01)
    edges = mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    assert {tuple(edge) for edge in edges.tolist()} == {(v, u) for u, v in edges.tolist()}


def test_a_wall_whose_foot_was_hidden_goes_down_to_the_floor(tmp_path: Path) -> None:
    """Something stood before it: no floor was seen under it, and the wall only from 0.9 m up."""
    points = walled()
    hidden = (np.abs(points[:, 0] - WALL) < 0.11) & (points[:, 2] < 0.9)
    terrain = Terrain.of_stack(stack_in(tmp_path, points[~hidden]))
    layer = terrain.layers[1]
    assert layer.bottoms is not None
    seen, lower = (
        sorted(set(np.round(of[~np.isnan(of)], 1))) for of in (layer.bottoms, feet(terrain, layer))
    )
    assert seen == pytest.approx([0, 0.9, LINTEL], abs=0.01)
    assert lower == pytest.approx([0, LINTEL], abs=0.01)  # nor was the floor in the door seen


# ---- the real programs -----------------------------------------------------------------------------


def starts() -> dict[str, tuple[float, float]]:
    """Where a ball begins to roll east."""
    return {
        "wall": (WALL - 1, 0.9),
        "door": (WALL - 1, sum(DOOR) / 2),
        "column": (COLUMN[0] - 0.6, COLUMN[1]),
    }


def end(way: str, x: float) -> bool:
    """Whether a ball ended where it has to."""
    if way == "door":
        return x > WALL + 0.5
    face = (WALL if way == "wall" else COLUMN[0]) - CELL / 2
    return bool(face - 1.2 * BALL < x < face)


@pytest.mark.parametrize("way", ["wall", "door", "column"])
def test_a_ball_stops_at_walls_and_rolls_through_the_door_in_mujoco(exported: Path, way: str) -> None:
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed: its files are not loaded")
    x, y = starts()[way]
    scene = exported / "mujoco" / f"{way}.xml"
    scene.write_text(
        f'<mujoco><include file="scene.xml"/><worldbody><body pos="{x} {y} {BALL + 0.02}"><freejoint/>'
        f'<geom size="{BALL}"/></body></worldbody></mujoco>'
    )
    model = mujoco.MjModel.from_xml_path(str(scene))
    data = mujoco.MjData(model)
    furthest = x
    for _ in range(1250):
        data.qvel[:2] = 0.8, 0  # straight on: pushed at a column, it would slip past
        mujoco.mj_step(model, data)
        furthest = max(furthest, data.qpos[0])
    assert end(way, furthest)
    assert data.qpos[2] < 2 * BALL


@pytest.mark.parametrize("way", ["wall", "door", "column"])
def test_a_ball_stops_at_walls_and_rolls_through_the_door_in_pybullet(exported: Path, way: str) -> None:
    pybullet = pytest.importorskip("pybullet", reason="pybullet is not installed: its files are not loaded")
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setGravity(0, 0, -9.81, physicsClientId=client)
        spec = importlib.util.spec_from_file_location("load_stack", exported / "pybullet" / "load_stack.py")
        assert spec is not None
        assert spec.loader is not None
        script = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(script)
        bodies = script.load(client)
        assert len(bodies["layer_01"]) == 4
        shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=BALL, physicsClientId=client)
        x, y = starts()[way]
        ball = pybullet.createMultiBody(1, shape, basePosition=(x, y, BALL + 0.02), physicsClientId=client)
        for _ in range(600):
            speed = pybullet.getBaseVelocity(ball, physicsClientId=client)[0]
            pybullet.resetBaseVelocity(ball, (0.8, 0, speed[2]), physicsClientId=client)
            pybullet.stepSimulation(physicsClientId=client)
        place = pybullet.getBasePositionAndOrientation(ball, physicsClientId=client)[0]
    finally:
        pybullet.disconnect(client)
    assert end(way, place[0])
    assert place[2] == pytest.approx(BALL, abs=0.05)


def test_more_boxes_than_mujoco_loads_are_refused(
    room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mujoco_target, "MOST_BOXES", 3)
    with pytest.raises(TargetError, match="more than 3 boxes; build the stack with a larger"):
        write_targets(room, ["mujoco"], tmp_path / "out")


def test_the_robot_stops_at_the_wall_and_passes_the_door(room: Path) -> None:
    """As it would in the building: through the wall's hole in the floor it would fall out of the world."""
    pytest.importorskip("mujoco", reason="mujoco is not installed: no robot is driven")
    terrain = Terrain.of_stack(room)
    ends = {}
    for way, y in (("wall", 0.9), ("door", sum(DOOR) / 2)):
        route = Route(parse_start(f"1.8,{y},0,0.1", terrain), parse_commands("5,0.6,0"))
        track = drive(worlds.of_stack(way, terrain, route.start), route)
        assert not track.fell
        ends[way] = track.positions[:, 0].max()
    assert ends["wall"] < WALL
    assert ends["door"] > WALL + 0.5


def test_rays_meet_walls_lintel_and_column_in_mujoco(exported: Path) -> None:
    """A lidar a metre up, and one that looks up through the door."""
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed: its files are not loaded")
    model = mujoco.MjModel.from_xml_path(str(exported / "mujoco" / "scene.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)

    def distance(start: tuple[float, float, float], along: tuple[float, float, float]) -> float:
        met = np.zeros(1, np.int32)
        return float(mujoco.mj_ray(model, data, np.array(start), np.array(along), None, 1, -1, met))

    middle = sum(DOOR) / 2
    assert distance((2.0, 0.9, 1.0), (1, 0, 0)) == pytest.approx(1.0, abs=0.01)
    assert distance((2.0, middle, 1.0), (1, 0, 0)) == -1
    assert distance((2.0, middle, 2.2), (1, 0, 0)) == pytest.approx(1.0, abs=0.01)
    assert distance((WALL, middle, 1.0), (0, 0, 1)) == pytest.approx(LINTEL - 1, abs=0.01)
    assert distance((*COLUMN, 3.0), (0, 0, -1)) == pytest.approx(3 - COLUMN_TOP, abs=0.01)


@pytest.mark.parametrize("file", ["mesh/layer_01.stl", "mesh/decimated/layer_01.ply"])
def test_meshes_hold_the_same_solids(exported: Path, file: str) -> None:
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.load(exported / file, force="mesh")
    places = np.array([[WALL, 0.9], [WALL, sum(DOOR) / 2], COLUMN, [2.0, 2.0]])
    seen = rays(np.asarray(mesh.vertices), np.asarray(mesh.faces), places)
    np.testing.assert_allclose(seen, [TOP, TOP, COLUMN_TOP, np.nan], atol=0.01)


def test_gazebo_gets_a_model_of_the_obstacles(exported: Path) -> None:
    assert len(list((exported / "gazebo" / "models").glob("*layer_01/meshes/layer_01.stl"))) == 1


def test_rasters_say_where_obstacles_begin(exported: Path) -> None:
    rasterio = pytest.importorskip("rasterio")
    with rasterio.open(exported / "geotiff" / "layer_01_bottom.tif") as raster:
        bottoms = raster.read(1, masked=True)
    assert (bottoms.min(), bottoms.max()) == pytest.approx((0, LINTEL), abs=0.01)
    assert bottoms.count() == 21
