"""A small wheeled robot in PyBullet: over the bridge, and beneath it."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.core.bridges import DECK, bridge_stack

from stepfield.targets import pybullet as target
from stepfield.targets.target import Options
from stepfield.targets.terrain import Terrain

pybullet = pytest.importorskip("pybullet", reason="pybullet is not installed: its files are not loaded")

WHEEL, SPEED = 0.12, 1.0

ROBOT = """<robot name="robot"><link name="chassis">
<inertial><mass value="12"/><origin xyz="0 0 0.02"/>
<inertia ixx="0.3" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.6"/></inertial>
<collision><origin xyz="0 0 0.06"/><geometry><box size="0.5 0.3 0.12"/></geometry></collision></link>
{wheels}</robot>"""
A_WHEEL = """<link name="{name}"><inertial><mass value="1.2"/>
<inertia ixx="0.008" ixy="0" ixz="0" iyy="0.008" iyz="0" izz="0.008"/></inertial>
<collision><geometry><sphere radius="0.12"/></geometry></collision></link>
<joint name="{name}" type="continuous"><parent link="chassis"/><child link="{name}"/>
<origin xyz="{x} {y} 0"/><axis xyz="0 1 0"/></joint>"""


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    """Give PyBullet with the bridge in it, loaded by the script that is written."""
    folder = tmp_path_factory.mktemp("bridge")
    target.write(Terrain.of_stack(bridge_stack(folder)), folder, Options())
    spec = importlib.util.spec_from_file_location("load_stack", folder / target.SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    client: int = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81, physicsClientId=client)
    script.load(client, visible=False)
    yield client
    pybullet.disconnect(client)


def driven(
    client: int, folder: Path, place: tuple[float, float, float], heading: float, seconds: float
) -> NDArray[np.float64]:
    """Drive straight on; return the path, 240 places a second."""
    wheels = "".join(
        A_WHEEL.format(name=f"wheel_{x}_{y}", x=x, y=y) for x in (0.2, -0.2) for y in (0.22, -0.22)
    )
    (folder / "robot.urdf").write_text(ROBOT.format(wheels=wheels))
    turned = pybullet.getQuaternionFromEuler((0, 0, heading))
    robot = pybullet.loadURDF(str(folder / "robot.urdf"), place, turned, physicsClientId=client)
    for wheel in range(4):
        pybullet.changeDynamics(robot, wheel, lateralFriction=1, physicsClientId=client)
        motor = {"targetVelocity": SPEED / WHEEL, "force": 20, "physicsClientId": client}
        pybullet.setJointMotorControl2(robot, wheel, pybullet.VELOCITY_CONTROL, **motor)
    path = np.empty((int(seconds * 240), 3))
    for moment in path:
        pybullet.stepSimulation(physicsClientId=client)
        moment[:] = pybullet.getBasePositionAndOrientation(robot, physicsClientId=client)[0]
    pybullet.removeBody(robot, physicsClientId=client)
    return path


def test_the_robot_crosses_the_bridge(world: int, tmp_path: Path) -> None:
    path = driven(world, tmp_path, (-9.0, 0.0, 3.2), 0.0, 23)
    assert path[-1, 0] > 8
    on_deck = np.abs(path[:, 0]) < 5
    np.testing.assert_allclose(path[on_deck, 2], DECK + WHEEL, atol=0.08)


def test_the_robot_passes_beneath_the_bridge(world: int, tmp_path: Path) -> None:
    path = driven(world, tmp_path, (0.5, -6.0, 0.2), np.pi / 2, 12)
    assert path[-1, 1] > 5
    np.testing.assert_allclose(path[240:, 2], WHEEL, atol=0.08)
