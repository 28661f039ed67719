"""A mesh drawn to the points it was made of: leaving triangles out moves it away from them.

The inner problem of mesh optimisation (Hoppe, DeRose, Duchamp, McDonald and Stuetzle, 1993): every point
pulls at the place of the mesh that is nearest to it, and the vertices move so that the squares of all
distances become least. Which vertices make a triangle stays.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Mesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Times that points are found anew on the moved mesh; more would crumple it for little.
ROUNDS = 8
#: Points further than this from the mesh, in the distance of neighbouring points, are no part of it.
REACH = 2.0
#: What a vertex's own move weighs, and its moving otherwise than a neighbour, against a point's distance.
STAY, ALONG = 0.3, 0.3


def fitted(mesh: Mesh, points: Floats, spacing: float) -> Mesh:
    """Move the vertices of a mesh so that it comes as near to points as its triangles can.

    Parameters
    ----------
    mesh : Mesh
    points : ndarray of shape (n, 3)
        About ``spacing`` apart, so that every part of the surface weighs as much as it is large; metres.
    spacing : float

    Returns
    -------
    Mesh
        Of the same triangles; a vertex that no point pulls at goes where its neighbours go.
    """
    if not len(mesh.triangles):
        return mesh
    held = _held(mesh)
    for _ in range(ROUNDS):
        mesh = Mesh(mesh.vertices + _moves(mesh, points, REACH * spacing, held), mesh.triangles)
    return mesh


def _held(mesh: Mesh) -> Any:
    """Return what holds the vertices back from moving, a sparse matrix of shape (V, V)."""
    from scipy.sparse import coo_array, diags_array

    count = len(mesh.vertices)
    sides = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    one, other = np.unique(sides, axis=0).T
    half = coo_array((np.full(len(one), ALONG), (one, other)), shape=(count, count)).tocsr()
    around = half + half.T
    return diags_array(STAY + around.sum(axis=1)) - around


def _moves(mesh: Mesh, points: Floats, reach: float, held: Any) -> Floats:
    """Solve for the moves of the vertices, shape (V, 3), while every point pulls where it does now."""
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import splu

    triangle, share = _nearest(mesh, points)
    corner = mesh.triangles[triangle]
    apart = points - (share[:, :, np.newaxis] * mesh.vertices[corner]).sum(axis=1)
    near = np.square(apart).sum(axis=1) <= reach**2
    corner, share, apart = corner[near], share[near], apart[near]
    starts = np.arange(len(corner) + 1) * 3
    pulls = csr_array((share.ravel(), corner.ravel(), starts), shape=(len(corner), len(mesh.vertices)))
    moves: Floats = splu((pulls.T @ pulls + held).tocsc()).solve(pulls.T @ apart)
    return moves


def _nearest(mesh: Mesh, points: Floats) -> tuple[Integers, Floats]:
    """Find the triangle nearest to each point and the shares of its corners in the place there, (n, 3)."""
    import open3d as o3d

    middle = mesh.vertices.mean(axis=0)
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor.from_numpy((mesh.vertices - middle).astype(np.float32)),
        o3d.core.Tensor.from_numpy(mesh.triangles.astype(np.uint32)),
    )
    found = scene.compute_closest_points(o3d.core.Tensor.from_numpy((points - middle).astype(np.float32)))
    share = found["primitive_uvs"].numpy().astype(np.float64)
    shares = np.column_stack([1 - share.sum(axis=1), share])
    return found["primitive_ids"].numpy().astype(np.int64), np.clip(shares, 0, 1)
