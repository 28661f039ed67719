"""Meshes to drive on: the truth, from a file or a synthetic scene, and one of all points of a scan."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.errors import SimulationError
from stepfield.files import one_line
from stepfield.scan import Scan
from stepfield.stack import Stack
from stepfield.surface import Mesh
from stepfield.synth import SCENES, synthesise
from stepfield.targets.terrain import Terrain

Floats = NDArray[np.float64]

SUFFIXES = (".obj", ".ply", ".stl", ".off", ".glb", ".gltf")
#: Triangles between points further apart than this many compartments close a hole, so are left out.
REACH = 2.0


def true_mesh(source: str, terrain: Terrain) -> Mesh:
    """Return the true surfaces in the terrain's local coordinates.

    Parameters
    ----------
    source : str
        A mesh file in the scan's coordinates and metres, z up (glTF: y up, as that format is); a scene's
        name; or a scene's JSON description.
    terrain : Terrain

    Raises
    ------
    SimulationError, SceneError
        In one sentence.
    """
    path = Path(source)
    if path.suffix.lower() in SUFFIXES:
        mesh = _read(path)
    elif source in SCENES or path.suffix.lower() == ".json":
        scene = synthesise(source, points=1).true_mesh
        mesh = Mesh(scene.vertices, scene.triangles.astype(np.int64))
    else:
        raise SimulationError(
            f"{source}: neither a mesh ({', '.join(SUFFIXES)}) nor a scene ({', '.join(SCENES)}); give one"
        )
    return Mesh(mesh.vertices - terrain.local_origin, mesh.triangles)


def _read(path: Path) -> Mesh:
    if not path.is_file():
        raise SimulationError(f"{path}: there is no such file; give the path of a mesh")
    try:
        import trimesh
    except ImportError:
        sentence = "reading meshes needs trimesh; install it with: pip install 'stepfield[simulate]'"
        raise SimulationError(sentence) from None
    try:
        loaded: Any = trimesh.load(path, force="mesh", process=False)
        vertices, triangles = np.array(loaded.vertices, np.float64), np.array(loaded.faces, np.int64)
    except Exception as error:  # noqa: BLE001  whatever a damaged file makes of a reader
        raise SimulationError(f"{path}: cannot be read as a mesh ({one_line(str(error))[:150]})") from None
    if not len(triangles) or not np.isfinite(vertices).all():
        raise SimulationError(f"{path}: holds no triangles, or vertices that are nowhere; give another mesh")
    if path.suffix.lower() in {".glb", ".gltf"}:
        vertices = vertices[:, [0, 2, 1]] * [1, -1, 1]
    return Mesh(vertices, triangles)


def cloud_mesh(scan: Scan, stack: Stack, terrain: Terrain) -> Mesh:
    """Triangulate all points of a scan, layer by layer: what a stack replaces (paper 4).

    Every point belongs to the layer that is nearest to it in its compartment; within a layer the plan's
    Delaunay triangles join the points.
    """
    points = scan.points()
    owner = _nearest_layer(points, stack)
    vertices, triangles, first = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
    for layer in range(len(stack.manifest.layers)):
        own = points[owner == layer]
        vertices.append(own)
        triangles.append(_delaunay(own, REACH * stack.grid.cell_size) + first)
        first += len(own)
    return Mesh(np.vstack(vertices) - terrain.local_origin, np.vstack(triangles))


def _nearest_layer(points: Floats, stack: Stack) -> NDArray[np.int64]:
    """Index of the layer nearest to every point, -1 where the stack has none."""
    grid = stack.grid
    east, north = points[:, 0] - grid.west, points[:, 1] - grid.south
    inside = (east >= 0) & (north >= 0) & (east <= grid.columns * grid.cell_size)
    inside &= north <= grid.rows * grid.cell_size
    compartment = grid.compartment(np.where(inside, east, 0), np.where(inside, north, 0))
    owner, nearest = np.full(len(points), -1), np.where(inside, np.inf, -1.0)
    for layer in stack.manifest.layers:
        distance = np.abs(points[:, 2] - stack.elevations(layer).ravel()[compartment])
        closer = distance < nearest
        owner[closer], nearest[closer] = layer.index, distance[closer]
    return owner


def _delaunay(points: Floats, reach: float) -> NDArray[np.int64]:
    """Triangles between points, shape (T, 3), none with a side longer in the plan than ``reach``."""
    from scipy.spatial import Delaunay, QhullError

    if len(points) < 3:
        return np.empty((0, 3), np.int64)
    try:
        triangles = Delaunay(points[:, :2] - points[:, :2].min(axis=0)).simplices.astype(np.int64)
    except QhullError:  # all on one line
        return np.empty((0, 3), np.int64)
    corners = points[triangles, :2]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    near: NDArray[np.int64] = triangles[(sides <= reach).all(axis=1)]
    return near
