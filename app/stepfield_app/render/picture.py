"""One picture of a subject: quickly while the hand moves, in full when it rests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter

from stepfield_app.render.camera import Camera, Size
from stepfield_app.render.canvas import Canvas
from stepfield_app.render.detail import Indices, is_speckled, nearest, point_size, settled
from stepfield_app.render.eyedome import relief_of, shade
from stepfield_app.render.pace import Pace
from stepfield_app.render.scene import Bytes, Singles, Triangles
from stepfield_app.render.seen import seen
from stepfield_app.render.subject import Subject

#: Clouds and meshes up to this size are drawn whole.
FEW = 300_000
#: How near to the depth of a point a pixel counts as that point and not as a mesh, in sizes of a pixel.
SAME = 4.0


@dataclass(frozen=True, eq=False)
class Picture:
    """What was drawn.

    Attributes
    ----------
    colours : ndarray of shape (height, width, 3), float32
        Red, green, blue, 0 to 1.
    depth : ndarray of shape (height, width), float32, or None
    light : ndarray of shape (height, width), float32, or None
        What colours are to be multiplied with.
    points, triangles : int
    limited : bool
        Whether detail was left out.
    """

    colours: Singles
    depth: Singles | None
    light: Singles | None
    points: int
    triangles: int
    limited: bool

    @property
    def covered(self) -> int:
        """Pixels that something is drawn in; 0 if there is no depth to tell."""
        return 0 if self.depth is None else int(np.count_nonzero(self.depth))

    def write(self, pixels: Bytes) -> None:
        """Write blue, green, red and 255 into an array of shape (height, width, 4)."""
        bright = np.float32(255) if self.light is None else self.light * np.float32(255)
        for channel in range(3):
            values = self.colours[..., channel] * bright
            values += np.float32(0.5)
            pixels[..., 2 - channel] = values
        pixels[..., 3] = 255


def moving(
    subject: Subject, canvas: Canvas, camera: Camera, size: Size, pace: Pace, with_depth: bool = False
) -> Picture:
    """Draw as much as the pace allows; depth costs time, and only some need it."""
    few = subject.count <= pace.points
    drawn = min(subject.count, pace.points)
    rows = slice(None) if few else subject.order[:drawn]
    mesh = subject.level(pace.triangles)
    points = subject.put_points(canvas, "all" if few else drawn, rows)
    triangles = subject.put_mesh(canvas, mesh)
    subject.put_lines(canvas)
    colours = canvas.shoot(camera, size, subject.span, _point_size(subject, drawn, camera, size))
    depth = canvas.depth(camera, size, subject.span) if with_depth else None
    limited = not few or pace.scale > 1 or (mesh is not None and mesh is not subject.scene.meshes[0])
    return Picture(colours, depth, None, points, triangles, limited)


def at_rest(
    subject: Subject, canvas: Canvas, camera: Camera, size: Size, look_up: Callable[[], None]
) -> Picture:
    """Draw what shows of the finest mesh and a point for every pixel the cloud covers, lit by its own depth.

    Raises
    ------
    Overtaken
        By ``look_up``, which is called every now and then.
    """
    mesh = _finest(subject, camera, size, look_up)
    rows: Indices | slice = slice(None)
    front: Singles | None = None
    if subject.count > FEW or (subject.count and mesh):
        nearest_rows, front = _nearest(subject, camera, size, look_up)
        rows = nearest_rows if subject.count > FEW else rows
    look_up()
    if isinstance(rows, slice):
        points = subject.put_points(canvas, "all", rows)
    else:
        points = subject.put_points(canvas, object(), rows, lambda places: settled(places, camera, size))
    triangles = subject.put_mesh(canvas, mesh)
    subject.put_lines(canvas)
    side = _point_size(subject, subject.count, camera, size, front)
    colours = canvas.shoot(camera, size, subject.span, side)
    depth = canvas.depth(camera, size, subject.span)
    if triangles and mesh is not subject.scene.meshes[0]:
        canvas.clear("mesh")  # of use for this picture only, and hundreds of megabytes
    light = _light(depth, camera, size) if points else None
    if light is not None and front is not None and mesh:
        light[~_of_points(depth, front, side, SAME * camera.metres_per_pixel(size))] = 1
    return Picture(colours, depth, light, points, triangles, False)


def _finest(subject: Subject, camera: Camera, size: Size, look_up: Callable[[], None]) -> Triangles | None:
    """Return the finest mesh, or what shows of it: of millions of triangles few have a pixel of their own."""
    mesh = subject.scene.meshes[0] if subject.scene.meshes else None
    if mesh is None or len(mesh.triangles) <= FEW:
        return mesh
    near, _ = subject.span.near_far(camera)
    return seen(mesh, camera, size, near, look_up)


def _nearest(
    subject: Subject, camera: Camera, size: Size, look_up: Callable[[], None]
) -> tuple[Indices, Singles]:
    assert subject.scene.points is not None
    near, _ = subject.span.near_far(camera)
    return nearest(subject.scene.points.places, camera, size, near, look_up)


def _point_size(
    subject: Subject, count: int, camera: Camera, size: Size, front: Singles | None = None
) -> float:
    points = subject.scene.points
    if points is None or not count:
        return 1.0
    near, _ = subject.span.near_far(camera)
    side = point_size(subject.probe, count, camera, size, near, points.size)
    return side + 1 if side < 2 and front is not None and is_speckled(front) else side


def _light(depth: Singles, camera: Camera, size: Size) -> Singles:
    relief = relief_of(depth, 2 * camera.SLOPE / size[1], camera.parallel, camera.metres_per_pixel(size))
    return shade(relief)


def _of_points(depth: Singles, front: Singles, side: float, same: float) -> NDArray[np.bool_]:
    """Tell pixels of points from those of a mesh."""
    around = minimum_filter(front, 1 + 2 * int(side / 2))
    near: NDArray[np.bool_] = np.abs(depth - around) <= same
    return near
