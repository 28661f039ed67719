"""Fewer triangles by Open3D's quadric error decimation, and how far points are from what is left."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Mesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: What leaving out one more edge may cost: the squares of how far it moves the surface, summed over the area
#: that moves, in the distance of neighbouring points to the fourth. What is flat becomes few large triangles;
#: what is rough, or has a compartment's shape in a handful of points, keeps most of its own.
COST = 6.0
#: Weight of the outline against the surface: the parts of a broken scan are many, and would fray.
OUTLINE = 10.0
#: Points whose distances are found at once.
CHUNK = 1 << 18


def reduced(mesh: Mesh, spacing: float, *, wanted: int = 1, cost: float = COST) -> Mesh:
    """Leave out triangles, those first whose loss moves the surface least.

    Open3D tells flat places by numbers that depend on the unit of length, so it gets the mesh in the distance
    of its points: a scan in millimetres and the same one in metres give the same triangles.

    Parameters
    ----------
    mesh : Mesh
    spacing : float
        Distance of the points it was made of, about; metres.
    wanted : int
        Triangles that are few enough.
    cost : float
        What leaving out one more edge may cost.
    """
    import open3d as o3d

    middle = mesh.vertices.mean(axis=0) if len(mesh.vertices) else np.zeros(3)
    whole = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector((mesh.vertices - middle) / spacing),
        o3d.utility.Vector3iVector(mesh.triangles.astype(np.int32)),
    )
    few = whole.simplify_quadric_decimation(wanted, maximum_error=cost, boundary_weight=OUTLINE)
    few.remove_degenerate_triangles()
    few.remove_unreferenced_vertices()
    triangles = np.asarray(few.triangles).astype(np.int64).reshape(-1, 3)
    return Mesh(np.asarray(few.vertices).reshape(-1, 3) * spacing + middle, triangles)


def distances(points: Floats, mesh: Mesh) -> Floats:
    """Distance of every point to the nearest place of a mesh, shape (n,), metres; infinite without any."""
    if not len(mesh.triangles):
        return np.full(len(points), np.inf)
    import open3d as o3d

    middle = mesh.vertices.mean(axis=0)
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor.from_numpy((mesh.vertices - middle).astype(np.float32)),
        o3d.core.Tensor.from_numpy(mesh.triangles.astype(np.uint32)),
    )
    found = np.empty(len(points))
    for start in range(0, len(points), CHUNK):
        part = (points[start : start + CHUNK] - middle).astype(np.float32)
        found[start : start + CHUNK] = scene.compute_distance(o3d.core.Tensor.from_numpy(part)).numpy()
    return found
