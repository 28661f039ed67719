"""Worlds to drive in, as MuJoCo models: a stack's layers, or the triangles of a mesh."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stepfield.errors import SimulationError
from stepfield.files import one_line
from stepfield.simulate.engine import engine
from stepfield.simulate.robot import Place, with_robot
from stepfield.surface import Mesh
from stepfield.targets import mujoco as target
from stepfield.targets.target import Options
from stepfield.targets.terrain import Terrain

#: Triangles are this thick to either side, metres, and lowered by as much: thinner ones let wheels through.
RADIUS = 0.02


@dataclass(frozen=True, eq=False)
class World:
    """A model with the robot in it, and what it cost.

    Attributes
    ----------
    name : str
    model : mujoco.MjModel
    parts : int
        Height-fields and boxes, or triangles.
    load_seconds : float
        From files to a model.
    megabytes : float
        Of the model and its state.
    lowest : float
        Lowest elevation, metres: what is far below has fallen out of the world.
    """

    name: str
    model: Any
    parts: int
    load_seconds: float
    megabytes: float
    lowest: float


def of_stack(name: str, terrain: Terrain, start: Place) -> World:
    """Make a world of a stack's layers, as ``export --target mujoco`` writes them."""
    low = [float(np.nanmin(layer.elevations)) for layer in terrain.layers if layer.occupied.any()]
    if not any(terrain.has_body(layer) and not layer.is_obstacles for layer in terrain.layers):
        raise SimulationError(
            f"{name}: the stack has no surface to drive on; build it with a larger cell size"
        )

    def write(folder: Path) -> None:
        target.write(terrain, folder, Options())

    return _world(name, start, write, min(low), lambda model: int((model.geom_bodyid == 0).sum()))


def of_mesh(name: str, mesh: Mesh, start: Place) -> World:
    """Make a world of a mesh in local coordinates; every triangle is met from both sides."""
    if not len(mesh.triangles):
        raise SimulationError(f"{name}: the mesh has no triangles; give another")

    def write(folder: Path) -> None:
        _write_obj(folder / "mesh.obj", mesh)
        (folder / target.SCENE).write_text(_mesh_scene(), encoding="utf-8")

    low = float(mesh.vertices[:, 2].min())
    return _world(name, start, write, low, lambda _: len(mesh.triangles))


def _world(
    name: str, start: Place, write: Callable[[Path], None], lowest: float, count: Callable[[Any], int]
) -> World:
    mujoco = engine()
    with tempfile.TemporaryDirectory(prefix="stepfield-") as made:
        folder = Path(made)
        write(folder)
        path = folder / "world.xml"
        path.write_text(with_robot(target.SCENE, start), encoding="utf-8")
        begin = time.perf_counter()
        try:
            model = mujoco.MjModel.from_xml_path(str(path))
        except ValueError as error:
            raise SimulationError(f"{name}: MuJoCo does not load it ({one_line(str(error))[:200]})") from None
        seconds = time.perf_counter() - begin
    size = (mujoco.mj_sizeModel(model) + mujoco.MjData(model).nbuffer) / 1e6
    return World(name, model, count(model), seconds, size, lowest)


def _mesh_scene() -> str:
    """A rigid flex: MuJoCo would fill a mesh geometry up to its convex hull."""
    return f"""<mujoco model="mesh">
  <worldbody>
    <light directional="true" pos="0 0 100" dir="-0.3 0.4 -1" diffuse="0.6 0.6 0.6" castshadow="false"/>
    <flexcomp name="mesh" type="mesh" file="mesh.obj" dim="2" rigid="true" radius="{RADIUS}"
              rgba="0.6 0.6 0.55 1">
      <contact selfcollide="none" friction="1 0.01 0.001"/>
    </flexcomp>
  </worldbody>
</mujoco>
"""


def _write_obj(path: Path, mesh: Mesh) -> None:
    """Write the triangles, corners at one place welded, none without an area, lowered by their thickness."""
    corners, number = np.unique(mesh.vertices.round(6), axis=0, return_inverse=True)
    faces = number.ravel()[mesh.triangles]
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    used, compact = np.unique(faces, return_inverse=True)
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in (corners[used] - [0, 0, RADIUS]).tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (compact.reshape(-1, 3) + 1).tolist()]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
