"""A surface to measure from: how far points are above it, and how far from its nearest place."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepfield.fidelity.buckets import Buckets, coarsened, grid_for, outside
from stepfield.fidelity.triangles import Triangles
from stepfield.grid import Grid
from stepfield.surface import Mesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Squares around a point that are looked at; what is farther away is not found.
MOST_RINGS = 10
#: Pairs of points and squares, or of points and triangles, looked at at once: what fits the cache.
PAIRS = 1 << 17
#: Points looked at at once.
POINTS = 1 << 15


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles, and where to look for them.

    Attributes
    ----------
    origin : ndarray of shape (3,)
        Subtracted from everything, metres.
    triangles : Triangles
    buckets : Buckets
    part : ndarray of shape (T,), int64
        Which of several meshes each triangle is of.
    low, high : ndarray of shape (T,)
        Lowest and highest elevation of each triangle.
    """

    origin: Floats
    triangles: Triangles
    buckets: Buckets
    part: Integers
    low: Floats
    high: Floats

    @classmethod
    def of(cls, meshes: list[Mesh], grid: Grid | None = None) -> Surface:
        """Prepare meshes in scan coordinates.

        Parameters
        ----------
        meshes : list of Mesh
        grid : Grid, optional
            One whose squares suit the triangles; made from their extent by default.
        """
        starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
        vertices = np.concatenate([np.zeros((0, 3)), *(mesh.vertices for mesh in meshes)])
        corners = [mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)]
        whole = Mesh(vertices, np.concatenate([np.zeros((0, 3), np.int64), *corners]))
        part = np.repeat(np.arange(len(meshes)), [len(mesh.triangles) for mesh in meshes])
        low = vertices.min(axis=0) if len(vertices) else np.zeros(3)
        if grid is None:
            grid = grid_for(low, vertices.max(axis=0) if len(vertices) else low, len(whole.triangles))
        origin = np.array([grid.west, grid.south, low[2]])
        triangles = Triangles.of(whole, origin)
        local = Grid(0.0, 0.0, grid.cell_size, grid.columns, grid.rows)
        return cls(
            origin,
            triangles,
            Buckets.of(triangles, coarsened(local, len(triangles))),
            part,
            *triangles.span(2),
        )

    @cached_property
    def _lowest(self) -> float:
        return float(self.low.min(initial=np.inf))

    @cached_property
    def _highest(self) -> float:
        return float(self.high.max(initial=-np.inf))

    @property
    def reach(self) -> float:
        """Metres within which the nearest place is sure to be found."""
        return (MOST_RINGS - 1) * self.buckets.grid.cell_size

    def above(self, x: Floats, y: Floats, z: Floats) -> tuple[Floats, Integers]:
        """Find what of the surface is vertically nearest.

        Parameters
        ----------
        x, y, z : ndarray of shape (n,)
            Less ``origin``, metres.

        Returns
        -------
        up : ndarray of shape (n,)
            How far each point is above it, negative below; infinite where the surface is not.
        part : ndarray of shape (n,), int64
            Which mesh that is of; -1 where there is none.
        """
        up, part = np.full(len(x), np.inf), np.full(len(x), -1)
        square = self.buckets.grid.compartment(x, y)
        self._improve(np.arange(len(x)), square, (x, y, z), up, part)
        rim = np.flatnonzero(np.isinf(up) & (self.buckets.to_border(x, y) < self._hair))
        for beside in self.buckets.around(square[rim], 1).T if len(rim) else ():
            there = np.flatnonzero(beside >= 0)
            self._improve(rim[there], beside[there], (x, y, z), up, part)
        return up, part

    def nearest(self, x: Floats, y: Floats, z: Floats, most: Floats) -> Floats:
        """Distance from each point to the nearest place of the surface.

        Parameters
        ----------
        x, y, z : ndarray of shape (n,)
            Less ``origin``, metres.
        most : ndarray of shape (n,)
            Distances that are known to be no less, infinite where nothing is known.

        Returns
        -------
        ndarray of shape (n,)
            Exact up to :attr:`reach`; beyond it ``most`` where nothing nearer was found.
        """
        best = np.square(most)
        square, place = self.buckets.grid.compartment(x, y), (x, y, z)
        for every in _portions(np.arange(len(x)), POINTS):
            self._approach(every, square[every], place, best)
        border = np.maximum(self.buckets.to_border(x, y), 0)
        border[self._is_out_of_reach(x, y, z)] = np.inf
        for ring in range(1, MOST_RINGS + 1):
            least = border + (ring - 1) * self.buckets.grid.cell_size
            left = np.flatnonzero(best > np.square(least))
            if not len(left):
                break
            for some in _portions(left, max(1, PAIRS // (8 * ring))):
                self._look_around(some, square[some], ring, place, best)
        distance: Floats = np.sqrt(best)
        return distance

    def _is_out_of_reach(self, x: Floats, y: Floats, z: Floats) -> NDArray[np.bool_]:
        """Tell which points are so far from all triangles that looking around them finds none."""
        grid, reach = self.buckets.grid, self.reach
        out: NDArray[np.bool_] = outside(x, 0.0, grid.columns * grid.cell_size) > reach
        out |= outside(y, 0.0, grid.rows * grid.cell_size) > reach
        out |= outside(z, self._lowest, self._highest) > reach
        return out

    @property
    def _hair(self) -> float:
        """So near to a square's side a point may belong to the square beside it, metres."""
        return 1e-6 * self.buckets.grid.cell_size

    def _improve(
        self,
        point: Integers,
        square: Integers,
        place: tuple[Floats, Floats, Floats],
        up: Floats,
        part: Integers,
    ) -> None:
        """Take the triangles of a square for points that are vertically nearer to them."""
        asked, triangle = self.buckets.pairs(square)
        met, above = self.triangles.above(triangle, point[asked], place)
        if not len(met):
            return
        asked, triangle, away = asked[met], triangle[met], np.abs(above)
        of, first = point[asked], np.flatnonzero(np.diff(asked, prepend=-1))
        least = np.full(len(square), np.inf)
        least[asked[first]] = np.minimum.reduceat(away, first)
        winner = np.flatnonzero((away == least[asked]) & (away < np.abs(up[of])))[::-1]  # ties to the first
        up[of[winner]], part[of[winner]] = above[winner], self.part[triangle[winner]]

    def _approach(
        self, point: Integers, square: Integers, place: tuple[Floats, Floats, Floats], best: Floats
    ) -> None:
        """Come nearer by the triangles of one square for each of some points; points may come again."""
        pair, triangle = self.buckets.pairs(square)
        of, z = point[pair], place[2]
        beyond = np.maximum(self.low[triangle] - z[of], z[of] - self.high[triangle])
        worth = np.flatnonzero((beyond < 0) | (np.square(beyond) < best[of]))
        of, triangle = of[worth], triangle[worth]
        np.minimum.at(best, of, self.triangles.squared(triangle, *(axis[of] for axis in place)))

    def _look_around(
        self,
        point: Integers,
        square: Integers,
        ring: int,
        place: tuple[Floats, Floats, Floats],
        best: Floats,
    ) -> None:
        """Come nearer by the squares of a ring around some points' own."""
        around = self.buckets.around(square, ring)
        at, way = np.nonzero(around >= 0)
        there, of = around[at, way], point[at]
        worth = np.flatnonzero(self.buckets.least_squared(there, *(axis[of] for axis in place)) < best[of])
        for some in _portions(worth, POINTS):
            self._approach(of[some], there[some], place, best)


def _portions(indices: Integers, size: int) -> list[Integers]:
    return [indices[at : at + size] for at in range(0, len(indices), size)]
