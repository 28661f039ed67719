"""Where a surface lies and what it is made of: poses, meshes and the contract every shape keeps.

A shape knows its own equation in its own coordinates and nothing of the scene; a pose puts it there.
That separation lets one sampler, one mesher and one ray caster serve every scene.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]
Triple = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles over shared vertices.

    Attributes
    ----------
    vertices : ndarray of shape (V, 3)
        Metres.
    triangles : ndarray of shape (T, 3)
        Indices into ``vertices``.
    """

    vertices: Floats
    triangles: Indices

    def corners(self) -> Floats:
        """Corners of every triangle, shape (T, 3, 3), metres."""
        return self.vertices[self.triangles]


def merged(meshes: Iterable[Mesh]) -> Mesh:
    """One mesh out of several, in their order."""
    vertices, triangles, first = [], [], 0
    for mesh in meshes:
        vertices.append(mesh.vertices)
        triangles.append(mesh.triangles + np.int32(first))
        first += len(mesh.vertices)
    if not vertices:
        return Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32))
    return Mesh(np.concatenate(vertices), np.concatenate(triangles))


def lattice(rows: int, columns: int) -> Indices:
    """Two triangles for every cell of a lattice of ``rows`` by ``columns`` vertices, row after row."""
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    lower = np.stack([corner, corner + 1, corner + columns + 1], axis=1)
    upper = np.stack([corner, corner + columns + 1, corner + columns], axis=1)
    return np.concatenate([lower, upper]).astype(np.int32)


def rotation(roll: float, pitch: float, yaw: float) -> Floats:
    """Turn about the fixed x axis by ``roll``, then y by ``pitch``, then z by ``yaw``.

    Angles are degrees, counter-clockwise seen from the axis' tip: a positive pitch lowers what lies
    towards +x. Returns the (3, 3) matrix that multiplies column vectors.
    """
    (cr, cp, cy), (sr, sp, sy) = (f(np.radians([roll, pitch, yaw])) for f in (np.cos, np.sin))
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    turn: Floats = about_z @ about_y @ about_x
    return turn


def turned(points: Floats, matrix: Floats) -> Floats:
    """Apply a (3, 3) rotation matrix to points (N, 3).

    Written out, as a linear algebra library may round differently with another number of threads, and
    equal seeds have to give equal clouds everywhere.
    """
    x, y, z = points.T
    result = np.empty(points.shape)
    for axis, (in_x, in_y, in_z) in enumerate(matrix.tolist()):
        result[:, axis] = in_x * x + in_y * y + in_z * z
    return result


@dataclass(frozen=True, eq=False)
class Pose:
    """Position (metres) and rotation matrix of a shape in its scene."""

    position: Triple = (0.0, 0.0, 0.0)
    matrix: Floats = field(default_factory=lambda: np.eye(3))

    @classmethod
    def at(
        cls, x: float, y: float, z: float, *, roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0
    ) -> Pose:
        """Pose at x, y, z (metres), turned by roll, pitch, yaw (degrees; see :func:`rotation`)."""
        return cls((x, y, z), rotation(roll, pitch, yaw))

    def place(self, points: Floats) -> Floats:
        """Own coordinates (N, 3) into the scene's."""
        placed = turned(points, self.matrix)
        placed += self.position
        return placed

    def unplace(self, points: Floats) -> Floats:
        """Scene coordinates (N, 3) into the shape's own."""
        return turned(points - self.position, self.matrix.T)


class Shape(Protocol):
    """What a surface must know of itself, in its own coordinates."""

    @property
    def area(self) -> float:
        """Area in square metres."""

    def draw(self, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """``count`` points spread evenly over the area and their unit normals, (N, 3) each."""

    def mesh(self) -> Mesh:
        """Triangles over the surface; curved ones within a millimetre, or 0.01 % of a large radius."""


@dataclass(frozen=True, eq=False)
class Assembly:
    """Several posed shapes that count as one surface: a box, a flight of stairs."""

    parts: Sequence[tuple[Shape, Pose]]

    @property
    def area(self) -> float:
        """Area in square metres."""
        return sum(shape.area for shape, _ in self.parts)

    def draw(self, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """``count`` points spread evenly over all parts and their unit normals, (N, 3) each."""
        areas = np.array([shape.area for shape, _ in self.parts])
        counts = rng.multinomial(count, areas / areas.sum())
        points, normals = np.empty((count, 3)), np.empty((count, 3))
        stops = np.cumsum(counts)
        for (shape, pose), start, stop in zip(self.parts, stops - counts, stops, strict=True):
            own, facing = shape.draw(int(stop - start), rng)
            points[start:stop] = pose.place(own)
            normals[start:stop] = turned(facing, pose.matrix)
        return points, normals

    def mesh(self) -> Mesh:
        """All parts' triangles."""
        return merged(placed_mesh(shape, pose) for shape, pose in self.parts)


def placed_mesh(shape: Shape, pose: Pose) -> Mesh:
    """Triangles of a shape in its scene's coordinates."""
    mesh = shape.mesh()
    return Mesh(pose.place(mesh.vertices), mesh.triangles)
