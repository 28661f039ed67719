"""A scene as the drawing process holds it: with what is worked out once and used for many pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from itertools import count

import numpy as np
from numpy.typing import NDArray

from stepfield_app.render.canvas import Canvas, Span
from stepfield_app.render.detail import PROBE, Indices, colours_of, shuffled
from stepfield_app.render.pace import MOST_POINTS
from stepfield_app.render.scene import Scene, Singles, Triangles

Doubles = NDArray[np.float64]
Settle = Callable[[Singles], Singles]

_numbers = count()


class Subject:
    """A scene, its bounds and a random order of its points."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.number = next(_numbers)

    @property
    def _cloud(self) -> Singles | None:
        return self.scene.points.places if self.scene.points else None

    @property
    def count(self) -> int:
        """Points of the cloud."""
        return len(self.scene.points.places) if self.scene.points else 0

    @cached_property
    def span(self) -> Span:
        """Ball around everything."""
        corners = [corner for places in self._places() for corner in _corners(places)]
        corners += [np.asarray(self.scene.low, float), np.asarray(self.scene.high, float)]
        low, high = np.min(corners, axis=0), np.max(corners, axis=0)
        return Span((low + high) / 2, float(np.linalg.norm(high - low)) / 2 * 1.01 + 1e-3)

    @cached_property
    def order(self) -> Indices:
        """Rows of the points that a moving picture draws first ones of."""
        return shuffled(self.count, MOST_POINTS)

    @cached_property
    def probe(self) -> Singles:
        """Few points that stand for all of them."""
        assert self.scene.points is not None
        return self.scene.points.places[:: max(self.count // PROBE, 1)]

    def inherits(self, others: Iterable[Subject]) -> Subject:
        """Take over what other scenes of the same cloud have worked out already."""
        for other in others:
            if self._cloud is not None and self._cloud is other._cloud and "order" in vars(other):
                self.order = other.order
        return self

    def level(self, most: int) -> Triangles | None:
        """Finest mesh of at most so many triangles, or the coarsest."""
        meshes = self.scene.meshes
        return next((mesh for mesh in meshes if len(mesh.triangles) <= most), meshes[-1] if meshes else None)

    def put_points(
        self,
        canvas: Canvas,
        key: object,
        rows: Indices | slice,
        settle: Settle | None = None,
    ) -> int:
        """Show some of the points, moved a little by ``settle``, unless they are shown; return how many."""
        points = self.scene.points
        if points is None:
            canvas.clear("points")
            return 0
        if canvas.key("points") != (self.number, key):
            places = settle(points.places[rows]) if settle else points.places[rows]
            canvas.points("points", (self.number, key), places, colours_of(points, rows))
        return len(points.places) if isinstance(rows, slice) else len(rows)

    def put_mesh(self, canvas: Canvas, mesh: Triangles | None) -> int:
        """Show a mesh unless it is shown already; return the number of triangles."""
        if mesh is None:
            canvas.clear("mesh")
            return 0
        if canvas.key("mesh") is not mesh:
            canvas.mesh("mesh", mesh, mesh)
        return len(mesh.triangles)

    def put_lines(self, canvas: Canvas) -> None:
        """Show all lines unless they are shown already."""
        lines = self.scene.lines
        if not lines:
            canvas.clear("lines")
        elif canvas.key("lines") is not lines:
            ends = np.concatenate([part.ends for part in lines])
            canvas.lines("lines", lines, ends, np.concatenate([part.colours for part in lines]))

    def _places(self) -> list[Singles]:
        points = [self.scene.points.places] if self.scene.points else []
        meshes = [mesh.vertices for mesh in self.scene.meshes[:1]]
        return [*points, *meshes, *(part.ends.reshape(-1, 3) for part in self.scene.lines)]


def _corners(places: Singles) -> list[Doubles]:
    if not len(places):
        return []
    columns = [places[:, axis] for axis in range(3)]  # three passes are quicker than one along the short axis
    return [np.array([ends(column) for column in columns], float) for ends in (np.nanmin, np.nanmax)]
