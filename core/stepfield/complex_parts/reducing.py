"""Fewer triangles by Open3D's quadric error decimation, and how far points are from what is left."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Mesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Share of the triangles that stays: flat parts become few large ones, as most of a collapsed floor is flat.
SHARE = 0.18
#: Weight of the outline against the surface: the parts of a broken scan are many, and would fray.
OUTLINE = 10.0
#: Points whose distances are found at once.
CHUNK = 1 << 18


def reduced(mesh: Mesh, share: float = SHARE) -> Mesh:
    """Keep a share of the triangles, chosen so that the surface moves as little as possible."""
    import open3d as o3d

    middle = mesh.vertices.mean(axis=0) if len(mesh.vertices) else np.zeros(3)
    whole = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(mesh.vertices - middle),
        o3d.utility.Vector3iVector(mesh.triangles.astype(np.int32)),
    )
    wanted = max(1, round(len(mesh.triangles) * share))
    few = whole.simplify_quadric_decimation(wanted, boundary_weight=OUTLINE)
    few.remove_degenerate_triangles()
    few.remove_unreferenced_vertices()
    triangles = np.asarray(few.triangles).astype(np.int64).reshape(-1, 3)
    return Mesh(np.asarray(few.vertices).reshape(-1, 3) + middle, triangles)


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
