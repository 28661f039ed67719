"""Driving: the same commands in whatever world, and the track that comes of it."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.progress import Progress, silent
from stepfield.simulate.engine import engine
from stepfield.simulate.robot import TIME_STEP, wheel_speeds
from stepfield.simulate.route import Route
from stepfield.simulate.worlds import World

Floats = NDArray[np.float64]

#: Samples of a track a second.
RATE = 50
#: Metres below the lowest elevation where a robot has fallen out of the world.
FALLEN = 1.0


@dataclass(frozen=True, eq=False)
class Track:
    """What the robot did, sampled :data:`RATE` times a second; all of one length N.

    Attributes
    ----------
    times : ndarray of shape (N,)
        Seconds.
    positions : ndarray of shape (N, 3)
        Of the robot's origin, local coordinates, metres.
    roll, pitch, yaw : ndarray of shape (N,)
        Degrees; a positive pitch looks down, a positive roll leans to the right.
    speeds : ndarray of shape (N,)
        What was asked for, metres a second.
    states : ndarray of shape (N, positions of the model)
        All that MuJoCo needs to show each moment again.
    fell : bool
        Out of the world, and the track ends there.
    step_seconds : float
        Processor time of one step of simulation.
    """

    times: Floats
    positions: Floats
    roll: Floats
    pitch: Floats
    yaw: Floats
    speeds: Floats
    states: Floats
    fell: bool
    step_seconds: float


def drive(world: World, route: Route, progress: Progress = silent, seconds: float | None = None) -> Track:
    """Drive a route in a world, for all of it or ``seconds``; ``progress`` may raise Cancelled."""
    mujoco = engine()
    data = mujoco.MjData(world.model)
    steps = round(1 / (RATE * TIME_STEP))
    samples = int(np.ceil((route.seconds if seconds is None else seconds) * RATE))
    states, speeds, spent = [], [], 0.0
    for sample in range(samples):
        if sample % RATE == 0:
            progress(sample / samples, f"driving on {world.name}")
        command = route.at(sample / RATE)
        data.ctrl[:] = wheel_speeds(command.forward, command.turn)
        begin = time.perf_counter()
        mujoco.mj_step(world.model, data, steps)
        spent += time.perf_counter() - begin
        states.append(data.qpos.copy())
        speeds.append(command.forward)
        if data.qpos[2] < world.lowest - FALLEN:
            break
    return _track(np.array(states), np.array(speeds), data, world, spent / (len(states) * steps))


def _track(states: Floats, speeds: Floats, data: Any, world: World, step_seconds: float) -> Track:
    roll, pitch, yaw = _angles(states[:, 3:7])
    return Track(
        times=(np.arange(len(states)) + 1) / RATE,
        positions=states[:, :3],
        roll=roll,
        pitch=pitch,
        yaw=yaw,
        speeds=speeds,
        states=states,
        fell=bool(data.qpos[2] < world.lowest - FALLEN),
        step_seconds=step_seconds,
    )


def _angles(quaternions: Floats) -> tuple[Floats, Floats, Floats]:
    """Roll, pitch and yaw in degrees of unit quaternions (w, x, y, z), shape (N, 4)."""
    w, x, y, z = quaternions.T
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.degrees(roll), np.degrees(pitch), np.degrees(yaw)
