"""Which triangles of a mesh can leave a trace in a picture: the others need not be drawn.

A triangle leaves none if it lies outside the picture, if no pixel has its middle in it, or if it is a face of
a solid that looks away. Of blocks hardly wider than a pixel these are most.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from stepfield_app.render.camera import Camera, Size
from stepfield_app.render.detail import CHUNK, THREADS
from stepfield_app.render.scene import Singles, Triangles

Look = Callable[[], None]
Mask = NDArray[np.bool_]

#: Pixels by which a device may place a corner elsewhere: it rounds coordinates.
ROUNDING = np.float32(1 / 16)


def seen(mesh: Triangles, camera: Camera, size: Size, near: float, look_up: Look) -> Triangles:
    """Return the part of a mesh that can show.

    Parameters
    ----------
    mesh : Triangles
    camera, size, near
        The view, and the depth of its near plane.
    look_up : callable
        Called every now and then; may raise :class:`~stepfield_app.render.detail.Overtaken`.
    """
    if not len(mesh.triangles):
        return mesh
    x, y = _pixels(mesh.vertices, camera, size, near, look_up)
    is_solid = mesh.solid and _is_above(mesh, camera)
    chosen = np.empty(len(mesh.triangles), bool)

    def choose(start: int) -> None:
        corners = np.ascontiguousarray(mesh.triangles[start : start + CHUNK].T)
        across, down = ([along.take(corner) for corner in corners] for along in (x, y))
        shows = ~(np.isnan(across[0]) & np.isnan(across[1]) & np.isnan(across[2]))
        shows &= _meets(across, size[0])
        shows &= _meets(down, size[1])
        if is_solid:
            shows &= _looks_here(across, down)
        chosen[start : start + CHUNK] = shows

    _in_chunks(choose, len(chosen), look_up)
    return _part(mesh, np.flatnonzero(chosen))


def _pixels(
    places: Singles, camera: Camera, size: Size, near: float, look_up: Look
) -> tuple[Singles, Singles]:
    """Pixels right of and below the middle of the picture; NaN nearer than the near plane."""
    turn = np.array([camera.right, -camera.up, camera.forward], np.float32)
    eye = camera.eye.astype(np.float32)
    x, y = np.empty((2, len(places)), np.float32)
    scale = np.float32(1 / camera.metres_per_pixel(size))

    def place(start: int) -> None:
        part = slice(start, start + CHUNK)
        across, down, depth = (turn @ (places[part] - eye).T).astype(np.float32)
        with np.errstate(all="ignore"):
            shrink = scale if camera.parallel else np.float32(camera.distance) * scale / depth
            shrink = np.where(depth >= np.float32(near), shrink, np.float32(np.nan))
            np.multiply(across, shrink, out=x[part])
            np.multiply(down, shrink, out=y[part])

    _in_chunks(place, len(places), look_up)
    return x, y


def _meets(corners: list[Singles], length: int) -> Mask:
    """Tell which triangles reach over the middle of a pixel along one axis, or are partly behind the eye."""
    low = np.minimum(np.minimum(corners[0], corners[1]), corners[2])
    high = np.maximum(np.maximum(corners[0], corners[1]), corners[2])
    outside = (high < -length / 2 - 1) | (low > length / 2 + 1)
    low -= np.float32(0.5) + ROUNDING
    high -= np.float32(0.5) - ROUNDING
    outside |= np.floor(high) < np.ceil(low)
    return ~outside


def _looks_here(x: list[Singles], y: list[Singles]) -> Mask:
    """Tell which triangles have their outside in sight: anti-clockwise, or unknown; y points down here."""
    turn = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    away: Mask = turn > 0
    return ~away


def _is_above(mesh: Triangles, camera: Camera) -> bool:
    """Whether the view is from above the foot of a solid, which is open below."""
    if camera.parallel:
        return bool(camera.forward[2] <= 0)
    return bool(camera.eye[2] > mesh.vertices[:, 2].min())


def _part(mesh: Triangles, rows: NDArray[np.int64]) -> Triangles:
    """Return some triangles with the vertices they need."""
    triangles = mesh.triangles.take(rows, axis=0)
    needed = np.zeros(len(mesh.vertices), bool)
    needed[triangles] = True
    vertices = np.flatnonzero(needed)
    number = np.cumsum(needed, dtype=np.int32)
    number -= 1
    return Triangles(
        mesh.vertices.take(vertices, axis=0),
        number.take(triangles),
        mesh.colours.take(vertices, axis=0),
        mesh.solid,
    )


def _in_chunks(work: Callable[[int], None], length: int, look_up: Look) -> None:
    """Call ``work`` with where each chunk starts, on as many threads as the drawing may take."""
    starts: Iterable[int] = range(0, length, CHUNK)
    with ThreadPoolExecutor(THREADS) as pool:
        try:
            for _ in pool.map(work, starts):
                look_up()
        finally:
            pool.shutdown(cancel_futures=True)
