"""Closing a sheet: a copy further down, and walls along every edge, for engines that fall through sheets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Mesh

Integers = NDArray[np.int64]


def thickened(sheet: Mesh, thickness: float) -> Mesh:
    """Make a closed body of a sheet; its top is the sheet.

    Parameters
    ----------
    sheet : Mesh
        Counter-clockwise seen from above. Where two parts of it meet in a single vertex, they are parted,
        so that every edge of the body has two triangles.
    thickness : float
        Metres, downwards.
    """
    sheet = _parted(sheet)
    count = len(sheet.vertices)
    below = sheet.vertices - [0, 0, thickness]
    a, b = _edges(sheet.triangles).T
    walls = np.concatenate([np.column_stack([b, a, a + count]), np.column_stack([b, a + count, b + count])])
    bottom = sheet.triangles[:, ::-1] + count
    return Mesh(np.concatenate([sheet.vertices, below]), np.concatenate([sheet.triangles, bottom, walls]))


def _edges(triangles: Integers) -> Integers:
    """Return the edges that one triangle only has, shape (n, 2), in its direction and order."""
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    count = triangles.max(initial=-1) + 1
    numbers, back = edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0]
    alone: Integers = edges[~np.isin(back, numbers)]
    return alone


def _parted(sheet: Mesh) -> Mesh:
    """Give a second vertex to parts that meet in one: two quads diagonal to each other, both others missing.

    One of the two then lies south of the vertex, the other north.
    """
    shared = np.bincount(_edges(sheet.triangles)[:, 0], minlength=len(sheet.vertices)) > 1
    of = np.flatnonzero(shared[sheet.triangles].any(axis=1))
    corners = sheet.triangles[of]
    north = sheet.vertices[:, 1]
    is_south = north[corners].mean(axis=1, keepdims=True) < north[corners]
    number = len(sheet.vertices) + np.cumsum(shared) - 1
    triangles = sheet.triangles.copy()
    triangles[of] = np.where(shared[corners] & is_south, number[corners], corners)
    return Mesh(np.concatenate([sheet.vertices, sheet.vertices[shared]]), triangles)
