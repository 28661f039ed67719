"""Meshes to drive on: the truth, from a file or a synthetic scene, and one of all points of a scan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.fidelity.true_mesh import true_mesh as truth
from stepfield.scan import Scan
from stepfield.stack import Stack
from stepfield.surface import Mesh
from stepfield.targets.terrain import Terrain

Floats = NDArray[np.float64]

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
    SceneError
        In one sentence.
    """
    mesh = truth(source)
    return Mesh(mesh.vertices - terrain.local_origin, mesh.triangles)


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
