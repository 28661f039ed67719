"""The robot: four driven wheels without steering, about as large as a Pioneer 2AT; lengths in metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

WHEEL_RADIUS = 0.12
WHEEL_WIDTH = 0.08
#: Half the distances between the axles and between the wheels of one.
AXLE, SIDE = 0.2, 0.22
#: Of the whole robot, for a way wide and long enough.
HALF_WIDTH = SIDE + WHEEL_WIDTH / 2
HALF_LENGTH = AXLE + WHEEL_RADIUS
#: The origin is level with the axles.
HEIGHT = 0.3

CHASSIS_MASS, WHEEL_MASS = 12.0, 1.2
#: A wheel's greatest torque, newton metres, and how hard it is driven to its speed.
TORQUE, GAIN = 20.0, 30.0
TIME_STEP = 0.002
#: Wheels that skid turn the robot less than rolling ones would: found on level ground.
SKID = 2.4

WHEELS = (("front_left", 1, 1), ("front_right", 1, -1), ("rear_left", -1, 1), ("rear_right", -1, -1))


@dataclass(frozen=True)
class Place:
    """Where the origin of the robot is put, metres, and where it looks, degrees from east, anticlockwise."""

    x: float
    y: float
    z: float
    heading: float = 0.0


def wheel_speeds(forward: float, turn: float) -> NDArray[np.float64]:
    """Return speeds of the wheels, radians a second, for metres and degrees a second of the whole robot."""
    across = np.radians(turn) * SIDE * SKID
    return np.array([(forward - side * across) / WHEEL_RADIUS for _, _, side in WHEELS])


def with_robot(scene: str, place: Place) -> str:
    """Return a MuJoCo model of the scene in a file beside it with the robot in it."""
    half = np.radians(place.heading) / 2
    wheels = "\n".join(_wheel(name, AXLE * front, SIDE * side) for name, front, side in WHEELS)
    motors = "\n".join(
        f'    <velocity joint="{name}" kv="{GAIN}" forcerange="{-TORQUE} {TORQUE}"/>' for name, _, _ in WHEELS
    )
    return f"""<mujoco>
  <include file="{scene}"/>
  <option timestep="{TIME_STEP}"/>
  <visual><global offwidth="1280" offheight="960"/></visual>
  <asset>
    <texture type="skybox" builtin="gradient" rgb1="0.55 0.68 0.82" rgb2="0.92 0.94 0.96"
             width="64" height="384"/>
  </asset>
  <worldbody>
    <body name="robot" pos="{place.x} {place.y} {place.z}" quat="{np.cos(half)} 0 0 {np.sin(half)}">
      <freejoint name="robot"/>
      <geom type="box" size="0.26 0.16 0.06" pos="0 0 0.06" mass="{CHASSIS_MASS}" rgba="0.85 0.2 0.15 1"/>
      <geom type="box" size="0.05 0.1 0.03" pos="0.16 0 0.15" mass="0.3" rgba="0.2 0.2 0.22 1"/>
{wheels}
    </body>
  </worldbody>
  <actuator>
{motors}
  </actuator>
</mujoco>
"""


def _wheel(name: str, x: float, y: float) -> str:
    size = f"{WHEEL_RADIUS} {WHEEL_WIDTH / 2}"
    return f"""      <body name="{name}" pos="{x} {y} 0">
        <joint name="{name}" axis="0 1 0" damping="0.05" armature="0.01"/>
        <geom type="cylinder" size="{size}" euler="90 0 0" mass="{WHEEL_MASS}" friction="1 0.01 0.001" \
rgba="0.15 0.15 0.16 1"/>
      </body>"""
