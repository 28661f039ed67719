"""Distances from points to triangles, pair by pair: the arithmetic that all else here only organises."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Mesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Barycentric coordinates this far below zero still count as inside: neighbours leave no crack between them.
SLACK = 1e-9
#: Stands for a length that is none, where something is divided by it.
TINY = 1e-300


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles in local coordinates, ready for pairs with points.

    Attributes
    ----------
    corner, one, other : tuple of three ndarray of shape (T,)
        First corner, and the sides from it to the second and the third; x, y, z, metres.
    """

    corner: tuple[Floats, Floats, Floats]
    one: tuple[Floats, Floats, Floats]
    other: tuple[Floats, Floats, Floats]

    @classmethod
    def of(cls, mesh: Mesh, origin: Floats) -> Triangles:
        """Prepare a mesh; ``origin`` is subtracted, shape (3,)."""
        axes = [np.ascontiguousarray(mesh.vertices[:, i]) - origin[i] for i in range(3)]
        first, second, third = (np.ascontiguousarray(mesh.triangles[:, i]) for i in range(3))
        corner = [axis[first] for axis in axes]
        one = [axis[second] - start for axis, start in zip(axes, corner, strict=True)]
        other = [axis[third] - start for axis, start in zip(axes, corner, strict=True)]
        return cls(*((x, y, z) for x, y, z in (corner, one, other)))

    def __len__(self) -> int:
        return len(self.corner[0])

    def span(self, axis: int) -> tuple[Floats, Floats]:
        """Lowest and highest coordinate of each triangle along an axis, shape (T,) both."""
        one, other = self.one[axis], self.other[axis]
        low = np.minimum(np.minimum(one, other), 0)
        high = np.maximum(np.maximum(one, other), 0)
        low += self.corner[axis]
        high += self.corner[axis]
        return low, high

    def above(
        self, triangle: Integers, point: Integers, place: tuple[Floats, Floats, Floats]
    ) -> tuple[Integers, Floats]:
        """Find the pairs whose point is straight above or below the triangle; never of an upright one.

        Parameters
        ----------
        triangle, point : ndarray of shape (n,), int64
            The pairs.
        place : tuple of ndarray
            Coordinates of all points.

        Returns
        -------
        pair : ndarray of shape (k,), int64
            Ascending.
        up : ndarray of shape (k,)
            How far each of them is above, negative below.
        """
        (ax, ay), (bx, by), (cx, cy) = self._taken(triangle, 2)
        east, north = place[0].take(point) - ax, place[1].take(point) - ay
        area = bx * cy - by * cx
        with np.errstate(divide="ignore", invalid="ignore"):
            s, t = (east * cy - north * cx) / area, (north * bx - east * by) / area
            pair = np.flatnonzero((s >= -SLACK) & (t >= -SLACK) & (s + t <= 1 + SLACK))
        az, bz, cz = (axes[2].take(triangle[pair]) for axes in (self.corner, self.one, self.other))
        up: Floats = place[2].take(point[pair]) - az - s[pair] * bz - t[pair] * cz
        return pair, up

    def squared(self, triangle: Integers, x: Floats, y: Floats, z: Floats) -> Floats:
        """Squared distance of each point from its triangle, shape (n,)."""
        corner, one, other = self._taken(triangle, 3)
        away = tuple(a - b for a, b in zip((x, y, z), corner, strict=True))
        bb, bc, cc = _dot(one, one), _dot(one, other), _dot(other, other)
        b, c, reach = _dot(away, one), _dot(away, other), _dot(away, away)
        area = bb * cc - bc * bc
        has_area = area > 1e-24 * bb * cc  # without one it has only sides
        area[~has_area] = 1
        s, t = (cc * b - bc * c) / area, (bb * c - bc * b) / area
        nearest = np.minimum(_to_side(reach, b, bb), _to_side(reach, c, cc))
        third = _to_side(reach - 2 * b + bb, c - b - bc + bb, bb + cc - 2 * bc)
        np.minimum(nearest, third, out=nearest)
        foot = [v - s * p - t * q for v, p, q in zip(away, one, other, strict=True)]
        np.copyto(nearest, _dot(foot, foot), where=has_area & (s >= 0) & (t >= 0) & (s + t <= 1))
        return np.maximum(nearest, 0, out=nearest)

    def _taken(self, triangle: Integers, axes: int) -> list[list[Floats]]:
        """Return corner and sides of some triangles along the first axes."""
        wanted = (self.corner, self.one, self.other)
        return [[axis.take(triangle) for axis in each[:axes]] for each in wanted]


def _dot(one: list[Floats] | tuple[Floats, ...], other: list[Floats] | tuple[Floats, ...]) -> Floats:
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def _to_side(reach: Floats, along: Floats, length: Floats) -> Floats:
    """Squared distance from a side, given that of its start, the product with it and its own square."""
    share = along / np.maximum(length, TINY)
    np.maximum(share, 0, out=share)
    np.minimum(share, 1, out=share)
    return reach + share * (share * length - 2 * along)
