"""The paper's simple objects (section 2): planes, boxes, spheres and cylinders.

Points are put onto each by its equation, evenly over its area, and never by meshing it first, so
that a cloud without noise satisfies the equation exactly. All are centred on their own origin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stepfield.synth.geometry import Assembly, Floats, Mesh, Pose, lattice, merged

#: A rectangular hole (x0, y0, x1, y1) in a plane's own coordinates, metres.
Hole = tuple[float, float, float, float]

#: The faces of a box, named as on a map.
FACES = ("bottom", "top", "south", "north", "west", "east")

#: How far a chord may cut into a curve, metres, and the most chords of a turn.
_SAG = 0.0005
_MOST_CHORDS = 256
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Plane:
    """A rectangle z = 0 facing up, with rectangular holes.

    Attributes
    ----------
    width, depth : float
        Extent along x and y, metres.
    holes : sequence of Hole
        Parts left out; they may overlap each other and the rim.
    """

    width: float
    depth: float
    holes: Sequence[Hole] = ()

    @property
    def area(self) -> float:
        """Area in square metres, holes left out."""
        return float(self._areas.sum())

    def draw(self, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """``count`` points spread evenly over the area and their unit normals, (N, 3) each."""
        counts = rng.multinomial(count, self._areas / self.area)
        points, stops = np.zeros((count, 3)), np.cumsum(counts)
        for (x0, y0, x1, y1), start, stop in zip(self._cells.tolist(), stops - counts, stops, strict=True):
            points[start:stop, 0] = rng.uniform(x0, x1, stop - start)
            points[start:stop, 1] = rng.uniform(y0, y1, stop - start)
        return points, np.broadcast_to(_UP, points.shape)

    def mesh(self) -> Mesh:
        """Two triangles for every rectangle between the holes."""
        x0, y0, x1, y1 = self._cells.T
        zero = np.zeros_like(x0)
        corners = [(x0, y0, zero), (x1, y0, zero), (x0, y1, zero), (x1, y1, zero)]
        vertices = np.stack([np.stack(corner, axis=1) for corner in corners], axis=1).reshape(-1, 3)
        first = np.arange(len(x0), dtype=np.int32)[:, None, None] * 4
        triangles = np.array([[0, 1, 3], [0, 3, 2]], np.int32)
        return Mesh(vertices, (first + triangles).reshape(-1, 3))

    @cached_property
    def _areas(self) -> Floats:
        x0, y0, x1, y1 = self._cells.T
        areas: Floats = (x1 - x0) * (y1 - y0)
        return areas

    @cached_property
    def _cells(self) -> Floats:
        """Cut the rectangle along every hole's edges, without what lies in a hole; shape (C, 4)."""
        half = np.array([self.width, self.depth]) / 2
        if not len(self.holes):
            return np.hstack([-half, half])[None]
        holes = np.array(self.holes, float).reshape(-1, 2, 2)
        x, y = (np.unique(np.clip([-h, h, *holes[:, :, i].ravel()], -h, h)) for i, h in enumerate(half))
        low = np.stack(np.meshgrid(x[:-1], y[:-1], indexing="ij"), axis=-1).reshape(-1, 2)
        high = np.stack(np.meshgrid(x[1:], y[1:], indexing="ij"), axis=-1).reshape(-1, 2)
        middle = (low + high) / 2
        inside = (middle[:, None] > holes[None, :, 0]) & (middle[:, None] < holes[None, :, 1])
        cells: Floats = np.hstack([low, high])[~inside.all(axis=2).any(axis=1)]
        return cells


@dataclass(frozen=True)
class Disc:
    """A disc z = 0 of the given radius (metres) facing up."""

    radius: float

    @property
    def area(self) -> float:
        """Area in square metres."""
        return float(np.pi * self.radius**2)

    def draw(self, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """``count`` points spread evenly over the area and their unit normals, (N, 3) each."""
        radius = self.radius * np.sqrt(rng.random(count))
        angle = rng.random(count) * 2 * np.pi
        points = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(count)], axis=1)
        return points, np.broadcast_to(_UP, points.shape)

    def mesh(self) -> Mesh:
        """Fan of triangles about the centre."""
        return _lathe([0.0, self.radius], [0.0, 0.0])


@dataclass(frozen=True)
class Sphere:
    """A sphere x² + y² + z² = radius² (metres)."""

    radius: float

    @property
    def area(self) -> float:
        """Area in square metres."""
        return float(4 * np.pi * self.radius**2)

    def draw(self, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """``count`` points spread evenly over the area and their unit normals, (N, 3) each."""
        # Archimedes: equal slices in z have equal areas.
        z = rng.uniform(-1, 1, count)
        angle = rng.random(count) * 2 * np.pi
        across = np.sqrt(1 - z * z)
        normals = np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1)
        return self.radius * normals, normals

    def mesh(self) -> Mesh:
        """Rings of triangles from pole to pole."""
        tilt = np.linspace(-np.pi / 2, np.pi / 2, _chords(self.radius) // 2 + 1)
        return _lathe(self.radius * np.cos(tilt), self.radius * np.sin(tilt))


@dataclass(frozen=True)
class Cylinder:
    """A cylinder x² + y² = radius² with its axis along z; a rotation of (90, 0, 0) lays it along y.

    Attributes
    ----------
    radius, height : float
        Metres; z goes from -height/2 to height/2.
    caps : bool
        Whether both ends are closed.
    """

    radius: float
    height: float
    caps: bool = False

    @property
    def area(self) -> float:
        """Area in square metres."""
        return self._side_area() + 2 * self._cap().area * self.caps

    def draw(self, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """``count`` points spread evenly over the area and their unit normals, (N, 3) each."""
        on_side = int(rng.binomial(count, self._side_area() / self.area))
        angle = rng.random(on_side) * 2 * np.pi
        around = np.stack([np.cos(angle), np.sin(angle), np.zeros(on_side)], axis=1)
        side = self.radius * around
        side[:, 2] = (rng.random(on_side) - 0.5) * self.height
        if not self.caps:
            return side, around
        cap, _ = self._cap().draw(count - on_side, rng)
        ends = rng.choice([-1.0, 1.0], count - on_side)
        cap[:, 2] = ends * self.height / 2
        return np.concatenate([side, cap]), np.concatenate([around, ends[:, None] * _UP])

    def mesh(self) -> Mesh:
        """Band of triangles, and two fans when it is closed."""
        low, high = -self.height / 2, self.height / 2
        # Long slivers would cost the float32 arithmetic of a ray caster millimetres.
        longest = 10 * 2 * np.pi * self.radius / _chords(self.radius)
        up = np.linspace(low, high, 1 + min(1000, int(np.ceil(self.height / longest))))
        band = _lathe(np.full_like(up, self.radius), up)
        if not self.caps:
            return band
        return merged(
            [_lathe([0.0, self.radius], [low, low]), band, _lathe([self.radius, 0.0], [high, high])]
        )

    def _side_area(self) -> float:
        return float(2 * np.pi * self.radius * self.height)

    def _cap(self) -> Disc:
        return Disc(self.radius)


def box(
    width: float, depth: float, height: float, *, without: Sequence[str] = (), holes: Sequence[Hole] = ()
) -> Assembly:
    """Faces of a box centred on its own origin.

    Parameters
    ----------
    width, depth, height : float
        Extent along x, y and z, metres.
    without : sequence of str
        Faces to leave out, of :data:`FACES`.
    holes : sequence of Hole
        Shafts from top to bottom, with their walls; inside the rim and apart from each other.
    """
    half = np.array([width, depth, height]) / 2
    faces = {
        "bottom": (Plane(width, depth, [(x0, -y1, x1, -y0) for x0, y0, x1, y1 in holes]), _down(-half[2])),
        "top": (Plane(width, depth, holes), Pose.at(0, 0, half[2])),
        "south": (Plane(width, height), Pose.at(0, -half[1], 0, roll=90)),
        "north": (Plane(width, height), Pose.at(0, half[1], 0, roll=-90)),
        "west": (Plane(height, depth), Pose.at(-half[0], 0, 0, pitch=-90)),
        "east": (Plane(height, depth), Pose.at(half[0], 0, 0, pitch=90)),
    }
    shafts = [wall for hole in holes for wall in _shaft(hole, height)]
    return Assembly([face for name, face in faces.items() if name not in without] + shafts)


def _down(z: float) -> Pose:
    return Pose.at(0, 0, z, roll=180)


def _shaft(hole: Hole, height: float) -> list[tuple[Plane, Pose]]:
    """Four walls of a hole through a box of the given height."""
    x0, y0, x1, y1 = hole
    x, y = (x0 + x1) / 2, (y0 + y1) / 2
    along_x, along_y = Plane(x1 - x0, height), Plane(height, y1 - y0)
    return [
        (along_x, Pose.at(x, y0, 0, roll=-90)),
        (along_x, Pose.at(x, y1, 0, roll=90)),
        (along_y, Pose.at(x0, y, 0, pitch=90)),
        (along_y, Pose.at(x1, y, 0, pitch=-90)),
    ]


def _chords(radius: float) -> int:
    """Chords that stand for a full circle."""
    angle = 2 * np.arccos(np.clip(1 - _SAG / radius, -1, 1))
    return int(np.clip(np.ceil(2 * np.pi / angle), 12, _MOST_CHORDS))


def _lathe(radius: Sequence[float] | Floats, z: Sequence[float] | Floats) -> Mesh:
    """Turn the profile (radius, z) about the z axis."""
    angle = np.linspace(0, 2 * np.pi, _chords(float(np.max(radius))) + 1)
    across, up = np.asarray(radius)[:, None], np.asarray(z)[:, None]
    rings = np.broadcast_arrays(across * np.cos(angle), across * np.sin(angle), up)
    return Mesh(np.stack(rings, axis=-1).reshape(-1, 3), lattice(len(up), len(angle)))
