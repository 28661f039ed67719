"""Surfaces the four simple objects cannot make: terrain, broken slabs, walls between edges, a helix.

All but the helix are sheets of flat triangles, which are their own equation: points drawn on them lie
exactly on the true mesh. The helix is drawn from its equation, as a winding ramp is smooth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepfield.synth.geometry import Floats, Mesh, lattice

#: Radial lines of a turn in the helix' mesh.
_TURN_STEPS = 360


@dataclass(frozen=True, eq=False)
class Sheet:
    """A surface of flat triangles.

    Attributes
    ----------
    patch : Mesh
        No triangle may be without area.
    """

    patch: Mesh

    @property
    def area(self) -> float:
        """Area in square metres."""
        return float(self._areas.sum())

    def draw(self, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """``count`` points spread evenly over the area and their unit normals, (N, 3) each."""
        counts = rng.multinomial(count, self._areas / self.area)
        u, v = rng.random((2, count, 1))
        # The far half of the parallelogram folds back onto the triangle.
        beyond = u + v > 1
        np.subtract(1, u, out=u, where=beyond)
        np.subtract(1, v, out=v, where=beyond)
        a, ab, ac, normals = (np.repeat(side, counts, axis=0) for side in (*self._frames, self._normals))
        ab *= u
        ac *= v
        a += ab
        a += ac
        return a, normals

    def mesh(self) -> Mesh:
        """Triangles of the sheet itself."""
        return self.patch

    @cached_property
    def _frames(self) -> tuple[Floats, Floats, Floats]:
        a, b, c = self.patch.corners().swapaxes(0, 1)
        return a, b - a, c - a

    @cached_property
    def _crosses(self) -> Floats:
        _, ab, ac = self._frames
        return np.cross(ab, ac)

    @cached_property
    def _areas(self) -> Floats:
        areas: Floats = np.linalg.norm(self._crosses, axis=1) / 2
        return areas

    @cached_property
    def _normals(self) -> Floats:
        normals: Floats = self._crosses / (2 * self._areas[:, None])
        return normals


def terrain(
    x: Floats,
    y: Floats,
    height: Callable[[Floats, Floats], Floats],
    left_out: Callable[[Floats, Floats], NDArray[np.bool_]] | None = None,
) -> Sheet:
    """Build ground of elevation ``height(x, y)`` over a lattice, all in metres.

    Parameters
    ----------
    x, y : ndarray
        Ascending coordinates of the lattice's lines.
    height : callable
        Elevations at x and y, arrays of one shape.
    left_out : callable, optional
        True where a triangle with its middle at x and y is not part of the ground.
    """
    east, north = np.meshgrid(x, y)
    vertices = np.stack([east, north, height(east, north)], axis=-1).reshape(-1, 3)
    triangles = lattice(len(y), len(x))
    if left_out is not None:
        middle = vertices[triangles].mean(axis=1)
        triangles = triangles[~left_out(middle[:, 0], middle[:, 1])]
    return Sheet(Mesh(vertices, triangles))


def ruled(one: Floats, other: Floats) -> Sheet:
    """Span a sheet between two polylines of as many vertices, (K, 3) each; they may share an end."""
    vertices = np.concatenate([one, other])
    mesh = Mesh(vertices, lattice(2, len(one)))
    flat = np.linalg.norm(np.cross(*np.diff(mesh.corners(), axis=1).swapaxes(0, 1)), axis=1) == 0
    return Sheet(Mesh(vertices, mesh.triangles[~flat]))


def prism(outline: Floats, thickness: float) -> Sheet:
    """Build an upright prism about z = 0: top, bottom and sides.

    Parameters
    ----------
    outline : ndarray of shape (K, 2)
        Counter-clockwise, every vertex visible from the mean of all.
    thickness : float
        Metres.
    """
    count = len(outline)
    ring = np.concatenate([outline, outline.mean(axis=0)[None]])
    vertices = np.concatenate(
        [np.column_stack([ring, np.full(count + 1, z)]) for z in (thickness / 2, -thickness / 2)]
    )
    here = np.arange(count)
    after, below = (here + 1) % count, count + 1
    centre = np.full(count, count)
    triangles = [
        (here, after, centre),
        (after + below, here + below, centre + below),
        (here, here + below, after + below),
        (here, after + below, after),
    ]
    stacked = np.concatenate([np.stack(corner, axis=1) for corner in triangles])
    return Sheet(Mesh(vertices, stacked.astype(np.int32)))


@dataclass(frozen=True)
class Helicoid:
    """A ramp winding about the z axis: z = rise * turns done, counter-clockwise from +x.

    Attributes
    ----------
    inner, outer : float
        Radii, metres.
    rise : float
        Metres a turn.
    turns : float
    """

    inner: float
    outer: float
    rise: float
    turns: float

    @property
    def area(self) -> float:
        """Area in square metres."""
        low, high = self._primitive(np.array([self.inner, self.outer]))
        return float((high - low) * self.turns * 2 * np.pi)

    def draw(self, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """``count`` points spread evenly over the area and their unit normals, (N, 3) each."""
        radius = self._radii(rng.random(count))
        turn = rng.random(count) * self.turns
        cos, sin = np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)
        points = np.stack([radius * cos, radius * sin, self.rise * turn], axis=1)
        pitch = self.rise / (2 * np.pi)
        normals = np.stack([pitch * sin, -pitch * cos, radius], axis=1) / np.hypot(radius, pitch)[:, None]
        return points, normals

    def mesh(self) -> Mesh:
        """Triangles between radial lines a degree apart."""
        turn = np.linspace(0, self.turns, int(np.ceil(self.turns * _TURN_STEPS)) + 1)[:, None]
        radius = np.array([self.inner, self.outer])
        x, y = radius * np.cos(2 * np.pi * turn), radius * np.sin(2 * np.pi * turn)
        z = np.broadcast_to(self.rise * turn, x.shape)
        return Mesh(np.stack([x, y, z], axis=-1).reshape(-1, 3), lattice(len(turn), 2))

    def _primitive(self, radius: Floats) -> Floats:
        """Integrate the area's density sqrt(r² + c²), where z = c * angle."""
        c = self.rise / (2 * np.pi)
        if c == 0:
            return radius**2 / 2
        area: Floats = (radius * np.hypot(radius, c) + c * c * np.arcsinh(radius / c)) / 2
        return area

    def _radii(self, share: Floats) -> Floats:
        """Radii within which the given shares of the area lie."""
        radius = np.linspace(self.inner, self.outer, 4097)
        below = self._primitive(radius)
        radii: Floats = np.interp(below[0] + share * (below[-1] - below[0]), below, radius)
        return radii
