"""A process of its own that draws moments: ``python -m stepfield.simulate.painter MODEL STATES OUT``.

MuJoCo chooses its way of drawing when it is imported, and a driver may take the whole process down.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stepfield.simulate.engine import engine

WIDTH, HEIGHT = 320, 240
#: Metres from the camera to the robot, and degrees: it looks north-west, down.
DISTANCE, AZIMUTH, ELEVATION = 3.2, 125.0, -22.0


def main(model: str, states: str, out: str) -> None:
    """Draw every state in a file and store the pictures, shape (N, HEIGHT, WIDTH, 3)."""
    pictures = paint(Path(model), np.load(states))
    with Path(out).open("wb") as file:
        np.save(file, pictures)


def paint(model: Path, states: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Draw the robot in its world at each state."""
    mujoco = engine()
    loaded = mujoco.MjModel.from_binary_path(str(model))
    data = mujoco.MjData(loaded)
    look = mujoco.MjvOption()
    look.flags[mujoco.mjtVisFlag.mjVIS_FLEXSKIN] = True
    camera = mujoco.MjvCamera()
    camera.distance, camera.azimuth, camera.elevation = DISTANCE, AZIMUTH, ELEVATION
    pictures = np.empty((len(states), HEIGHT, WIDTH, 3), np.uint8)
    with mujoco.Renderer(loaded, HEIGHT, WIDTH) as renderer:
        for picture, state in zip(pictures, states, strict=True):
            data.qpos[:] = state
            mujoco.mj_forward(loaded, data)
            camera.lookat[:] = state[:3]
            renderer.update_scene(data, camera, look)
            renderer.render(out=picture)
    return pictures


if __name__ == "__main__":
    main(*sys.argv[1:])
