"""PyBullet's files, loaded by their own script into PyBullet: its rays, its balls, its pictures, a robot."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.core.targets.stacks import CELL, asymmetric, height_at, places_in, stack_of

from stepfield.targets import pybullet as target
from stepfield.targets.target import Options, Written
from stepfield.targets.terrain import Terrain

pybullet = pytest.importorskip("pybullet", reason="pybullet is not installed: its files are not loaded")

Raster = NDArray[np.float64]

BALL = 0.05
#: A pillar is as high as the mean of its points, and the table top is 4 cm thick: 0.71 to 0.75 m.
TOP = 0.73


@pytest.fixture
def client() -> Iterator[int]:
    """Give a world of its own, with gravity."""
    connected: int = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81, physicsClientId=connected)
    yield connected
    pybullet.disconnect(connected)


def exported(stack: Path, folder: Path) -> tuple[Terrain, Written]:
    terrain = Terrain.of_stack(stack)
    return terrain, target.write(terrain, folder, Options())


def loaded(folder: Path, client: int, **more: Any) -> dict[str, list[int]]:
    """Run the script that was written."""
    spec = importlib.util.spec_from_file_location("load_stack", folder / target.SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    bodies: dict[str, list[int]] = script.load(client, **more)
    return bodies


def looked_down(bodies: list[int], others: list[int], places: Raster, client: int) -> Raster:
    """Heights of some bodies only."""
    for group, which in ((0, others), (1, bodies)):
        for body in which:
            pybullet.setCollisionFilterGroupMask(body, -1, group, group, physicsClientId=client)
    heights = np.full(len(places), np.nan)
    for i, (x, y) in enumerate(places.tolist()):
        down = ([x, y, 100.0], [x, y, -100.0])
        met = pybullet.rayTest(*down, collisionFilterMask=1, physicsClientId=client)[0]
        if met[0] >= 0:
            heights[i] = met[3][2]
    return heights


def layer_heights(bodies: dict[str, list[int]], label: str, places: Raster, client: int) -> Raster:
    others = [body for name, own in bodies.items() if name != label for body in own]
    return looked_down(bodies[label], others, places, client)


def test_rays_meet_the_reconstruction_and_nothing_else(stack: Path, tmp_path: Path, client: int) -> None:
    # As for MuJoCo: no flip, no shift, the same diagonals, and holes that are open to their corners.
    terrain, _ = exported(stack, tmp_path)
    bodies = loaded(tmp_path, client)
    corner = terrain.west - terrain.cell_size / 2, terrain.south - terrain.cell_size / 2
    places = places_in(corner, terrain.cell_size, (terrain.rows, terrain.columns))
    for layer in terrain.layers:
        wanted = height_at(layer.elevations.astype(float), corner, terrain.cell_size, places)
        seen = layer_heights(bodies, layer.label, places, client)
        np.testing.assert_array_equal(np.isnan(seen), np.isnan(wanted))
        np.testing.assert_allclose(seen, wanted, atol=layer.half_level + 1e-3)


def test_rays_meet_the_pillars_themselves_at_their_middles(
    asymmetric_stack: Path, tmp_path: Path, client: int
) -> None:
    terrain, _ = exported(asymmetric_stack, tmp_path)
    bodies = loaded(tmp_path, client)
    for layer, made in zip(terrain.layers, asymmetric(), strict=True):
        row, column = (steps[:300] for steps in np.nonzero(layer.quads))
        x, y = terrain.west + column * CELL, terrain.north - row * CELL
        places = np.column_stack([x + 1e-6, y - 1e-6])  # just within the quad to its south-east
        seen = layer_heights(bodies, layer.label, places, client)
        np.testing.assert_allclose(seen, made[row, column], atol=layer.half_level + 1e-3)


def test_large_layers_are_several_bodies_without_a_seam(tmp_path: Path, client: int) -> None:
    rows, columns = 300, 270
    row, column = np.indices((rows, columns)).astype(float)
    slope = 0.02 * column + 0.05 * (rows - row)
    slope[200, 100] = np.nan
    (tmp_path / "out").mkdir()
    terrain, _ = exported(stack_of(tmp_path / "made", [slope]), tmp_path / "out")
    bodies = loaded(tmp_path / "out", client, visible=False)
    assert len(bodies["layer_00"]) == 4
    x = terrain.west + (256 + np.linspace(-1, 1, 41)) * CELL + 1e-5
    y = np.full_like(x, terrain.north - 250.3 * CELL)
    seen = looked_down(bodies["layer_00"], [], np.column_stack([x, y]), client)
    wanted = 0.02 * (x - terrain.west) / CELL + 0.05 * (rows - 250.3)
    np.testing.assert_allclose(seen, wanted, atol=2e-3)


def test_the_offset_moves_everything(asymmetric_stack: Path, tmp_path: Path, client: int) -> None:
    terrain, _ = exported(asymmetric_stack, tmp_path)
    here, there = loaded(tmp_path, client), loaded(tmp_path, client, offset=(100.0, 50.0, 3.0))
    place = np.array([[terrain.west + 3.1, terrain.south + 2.2]])
    low = layer_heights(here, "layer_00", place, client)
    high = layer_heights(there, "layer_00", place + np.array([100, 50]), client)
    np.testing.assert_allclose(high, low + 3, atol=1e-4)


def dropped(client: int, place: tuple[float, float, float], speed: tuple[float, float, float]) -> Raster:
    """Let a ball go; return its path over four seconds."""
    shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=BALL, physicsClientId=client)
    ball = pybullet.createMultiBody(0.3, shape, basePosition=place, physicsClientId=client)
    pybullet.changeDynamics(ball, -1, rollingFriction=1e-3, physicsClientId=client)
    pybullet.resetBaseVelocity(ball, speed, physicsClientId=client)
    gone = np.empty((960, 3))
    for moment in gone:
        pybullet.stepSimulation(physicsClientId=client)
        moment[:] = pybullet.getBasePositionAndOrientation(ball, physicsClientId=client)[0]
    return gone


@pytest.mark.parametrize(
    ("place", "rest"), [((0.1, 0.05, 1.2), TOP), ((1.4, 1.1, 1.2), 0.0)], ids=["on the table", "beside it"]
)
def test_balls_rest_where_they_fall(
    find_stack: Callable[[str], Path],
    tmp_path: Path,
    client: int,
    place: tuple[float, float, float],
    rest: float,
) -> None:
    exported(find_stack("table"), tmp_path)
    loaded(tmp_path, client, visible=False)
    assert dropped(client, place, (0, 0, 0))[-1, 2] == pytest.approx(rest + BALL, abs=0.015)


def test_a_ball_rolls_under_the_table(find_stack: Callable[[str], Path], tmp_path: Path, client: int) -> None:
    exported(find_stack("table"), tmp_path)
    loaded(tmp_path, client, visible=False)
    gone = dropped(client, (0.05, -1.2, BALL + 0.01), (0, 2.0, 0))
    assert gone[:, 1].max() > 0.9
    beneath = gone[np.abs(gone[:, 1]) < 0.4]
    assert len(beneath)
    assert np.abs(beneath[:, 2] - BALL).max() < 0.03


def test_cameras_see_the_layers(asymmetric_stack: Path, tmp_path: Path, client: int) -> None:
    terrain, _ = exported(asymmetric_stack, tmp_path)
    loaded(tmp_path, client)
    middle = [(terrain.west + terrain.east) / 2, (terrain.south + terrain.north) / 2, 3.0]
    view = pybullet.computeViewMatrixFromYawPitchRoll(middle, 12, 30, -40, 0, 2)
    frame = pybullet.computeProjectionMatrixFOV(50, 1, 0.1, 100)
    picture = pybullet.getCameraImage(
        80, 80, view, frame, renderer=pybullet.ER_TINY_RENDERER, physicsClientId=client
    )
    seen = set(np.unique(np.reshape(picture[4], -1)).tolist())
    assert {0, 1} <= seen


def test_names_stay_out_of_the_script(tmp_path: Path, client: int) -> None:
    evil = '"""\n__import__("os").system("touch hacked") # \\ ü\udc80'
    (tmp_path / "out").mkdir()
    exported(stack_of(tmp_path / "made", [np.zeros((4, 5))], names=["'" + evil[:-1]]), tmp_path / "out")
    script = (tmp_path / "out" / target.SCRIPT).read_text()
    assert "hacked" not in script
    assert json.loads((tmp_path / "out" / target.PLACES).read_text())["layers"][0]["name"].startswith("'\"")
    assert len(loaded(tmp_path / "out", client)["layer_00"]) == 1


def test_a_layer_without_a_quad_has_no_body_and_that_is_said(tmp_path: Path, client: int) -> None:
    checkered = np.where(np.indices((5, 5)).sum(axis=0) % 2, np.nan, 1.0)
    (tmp_path / "out").mkdir()
    _, written = exported(
        stack_of(tmp_path / "made", [np.zeros((5, 5)), checkered, np.full((5, 5), np.nan)]), tmp_path / "out"
    )
    assert len(written.notes) == 2
    assert loaded(tmp_path / "out", client)["layer_01"] == []


def test_equal_stacks_give_equal_bytes_and_all_is_said(asymmetric_stack: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        _, written = exported(asymmetric_stack, tmp_path / name)
    assert sorted(written.files) == sorted(path.name for path in (tmp_path / "a").iterdir())
    for file in written.files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()
