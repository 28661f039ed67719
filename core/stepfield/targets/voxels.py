"""A mesh as boxes that it runs through: for programs that collide with convex bodies only."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Mesh
from stepfield.targets.boxes import Box

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Places looked at along a cube's side, so that no cube a triangle runs through is missed but a tip of it.
LOOKS = 2
#: Places looked at at once; bounds the memory.
CHUNK = 1 << 20


def solids(mesh: Mesh, side: float) -> Iterator[Box]:
    """Cover a mesh with boxes: cubes it runs through, joined upwards and then eastwards.

    Parameters
    ----------
    mesh : Mesh
        With at least one triangle.
    side : float
        Of a cube, metres: how thick the boxes are.
    """
    low = mesh.vertices.min(axis=0)
    local = Mesh((mesh.vertices - low) / side, mesh.triangles)
    cubes = np.unique(np.concatenate([np.unique(part, axis=0) for part in _cubes(local)]), axis=0)
    for west, south, bottom, east, top in _joined(cubes).tolist():
        x, y, z = (float(value) for value in low)
        yield Box(
            x + west * side,
            y + south * side,
            z + bottom * side,
            x + east * side,
            y + (south + 1) * side,
            z + top * side,
        )


def _cubes(mesh: Mesh) -> Iterator[Integers]:
    """Yield the cubes of places all over the triangles, shape (n, 3); lengths in cubes."""
    corners = mesh.vertices[mesh.triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    steps = np.maximum(1, np.ceil(longest * LOOKS)).astype(np.int64)
    for count in np.unique(steps).tolist():
        weights = _weights(count)
        alike = corners[steps == count]
        for part in np.array_split(alike, max(1, len(alike) * len(weights) // CHUNK)):
            places = np.einsum("wc,tcx->twx", weights, part).reshape(-1, 3)
            yield np.floor(places + 1e-9).astype(np.int64)


def _weights(count: int) -> Floats:
    """Weights of a triangle's corners at places all over it, so many steps along a side; shape (n, 3)."""
    first, second = (grid.ravel() for grid in np.meshgrid(np.arange(count + 1), np.arange(count + 1)))
    inside = first + second <= count
    first, second = first[inside], second[inside]
    return np.column_stack([first, second, count - first - second]) / count


def _joined(cubes: Integers) -> Integers:
    """Join cubes, ordered by x, y and z; return west, south, bottom, east and top of boxes, shape (n, 5)."""
    begins = np.flatnonzero((np.diff(cubes, axis=0, prepend=-2) != (0, 0, 1)).any(axis=1))
    top = cubes[np.append(begins[1:], len(cubes)) - 1, 2] + 1
    column = np.column_stack([cubes[begins], top])  # x, y, bottom, top
    column = column[np.lexsort((column[:, 0], column[:, 3], column[:, 2], column[:, 1]))]
    begins = np.flatnonzero((np.diff(column, axis=0, prepend=-2) != (1, 0, 0, 0)).any(axis=1))
    east = column[np.append(begins[1:], len(column)) - 1, 0] + 1
    x, y, bottom, top = column[begins].T
    return np.column_stack([x, y, bottom, east, top])
