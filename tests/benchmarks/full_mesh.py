"""Meshes of point clouds by the three ways that Open3D has, for figures."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import open3d as o3d
from numpy.typing import NDArray

from stepfield.complex_parts.fitting import fitted
from stepfield.complex_parts.pivoting import _joined, pivoted
from stepfield.complex_parts.reducing import reduced
from stepfield.complex_parts.thinning import Thinning
from stepfield.progress import silent
from stepfield.surface import Mesh

Floats = NDArray[np.float64]
Method = Callable[[Floats, float], Mesh]

#: Radii of the balls for a whole scan, evened out twice as finely: they reach as far as for complex parts.
FULL_RADII = (1.0, 2.0, 4.0, 8.0)


def evened(points: Floats, spacing: float) -> Floats:
    """Even points out, so that they are about ``spacing`` metres apart."""
    low = points.min(axis=0)
    thinning = Thinning(spacing)
    thinning.add(points - low)
    means: Floats = thinning.means() + low
    return means


def ball_pivoting(points: Floats, spacing: float) -> Mesh:
    """Mesh as complex parts are meshed."""
    return Mesh(points, pivoted(points, spacing))


def full_ball_pivoting(points: Floats, spacing: float) -> Mesh:
    """Mesh a whole scan as complex parts are meshed: sparse parts beside dense ones too."""
    return Mesh(points, pivoted(points, spacing, radii=FULL_RADII))


def full_once(points: Floats, spacing: float) -> Mesh:
    """Mesh a whole scan as Open3D does when it is called once, with all the balls."""
    return Mesh(points, _joined(points, spacing, FULL_RADII, silent))


def thinned(mesh: Mesh, points: Floats, spacing: float, wanted: int) -> Mesh:
    """Leave so many triangles of a mesh, and draw it to points, as complex parts are."""
    return fitted(reduced(mesh, spacing, wanted=wanted, cost=np.inf), evened(points, spacing), spacing)


def poisson(points: Floats, spacing: float) -> Mesh:
    """Reconstruct by Poisson's equation, cells as fine as the points, trimmed where no points are near."""
    cloud = _cloud(points, spacing)
    depth = math.ceil(math.log2(1.1 * float(np.ptp(points, axis=0).max()) / spacing))
    mesh, _ = o3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=depth)
    far = np.asarray(o3d.geometry.PointCloud(mesh.vertices).compute_point_cloud_distance(cloud)) > 2 * spacing
    mesh.remove_vertices_by_mask(far.tolist())
    return _mesh(mesh, points)


def alpha_shape(points: Floats, spacing: float) -> Mesh:
    """Wrap the points in tetrahedra no wider than the widest ball."""
    cloud = _cloud(points, spacing)
    return _mesh(o3d.geometry.TriangleMesh.create_from_point_cloud_alpha_shape(cloud, 4 * spacing), points)


METHODS: dict[str, Method] = {
    "ball pivoting": ball_pivoting,
    "Poisson": poisson,
    "alpha shape": alpha_shape,
}


def invented(mesh: Mesh, points: Floats, far: float) -> float:
    """Share of the surface that is further than ``far`` metres from every point."""
    from scipy.spatial import cKDTree

    o3d.utility.random.seed(0)
    whole = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(mesh.vertices), o3d.utility.Vector3iVector(mesh.triangles.astype(np.int32))
    )
    places = np.asarray(whole.sample_points_uniformly(50_000).points)
    distance, _ = cKDTree(points).query(places, workers=-1)
    return float(np.mean(distance > far))


def _cloud(points: Floats, spacing: float) -> Any:
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points - points.mean(axis=0)))
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamHybrid(4 * spacing, 30))
    cloud.orient_normals_consistent_tangent_plane(12)
    return cloud


def _mesh(mesh: Any, points: Floats) -> Mesh:
    triangles = np.asarray(mesh.triangles).astype(np.int64).reshape(-1, 3)
    return Mesh(np.asarray(mesh.vertices).reshape(-1, 3) + points.mean(axis=0), triangles)
