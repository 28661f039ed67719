"""Which points to draw: a random few while the hand moves, one for each pixel they cover when it rests."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from math import sqrt
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield_app.render.camera import Camera, Size
from stepfield_app.render.scene import Bytes, Points, Singles

Indices = NDArray[np.int64]

#: Points projected at a time: few enough for the processor's cache.
CHUNK = 50_000
#: More would take the processor from the window.
THREADS = 2
#: Points that tell how densely a cloud covers its part of the picture.
PROBE = 20_000
#: Side in pixels of the squares that part is counted in.
BLOCK = 24
LARGEST_POINT = 3.0
#: Share of a pixel that points keep from its border.
BORDER = np.float32(1 / 64)
#: Pixels that points should cover for each there is: scattered points leave exp(-DENSITY) of them open.
DENSITY = 3.0
#: Share of a surface's pixels through which the one behind may be seen, and how much farther that is.
SPECKS, BEHIND = 2e-3, 1.01
#: Above any depth and any row: no point yet.
NONE = np.iinfo(np.uint64).max


class Overtaken(Exception):
    """There is something newer to draw."""


def colours_of(points: Points, rows: NDArray[np.integer] | slice) -> Bytes:
    """Colours of some points, shape (n, 3)."""
    codes = points.codes[rows]
    return codes if points.palette is None else points.palette[codes]


def shuffled(count: int, most: int) -> Indices:
    """Rows of up to ``most`` points, spread evenly, in random order: any first few are a sample."""
    rng = np.random.default_rng(count)
    if count <= most:
        return rng.permutation(count)
    stride = count / most
    rows = np.arange(most) * stride + rng.random(most) * (stride - 1)  # at least 1 apart
    return rng.permutation(rows.astype(np.int64))


def pixels_of(
    places: Singles, camera: Camera, size: Size, near: float
) -> tuple[Indices, Singles, NDArray[np.bool_]]:
    """Find the pixel of each point in single precision.

    Returns
    -------
    pixel : ndarray of shape (m,)
        Row times width plus column, of the points in the picture.
    depth : ndarray of shape (m,), float32
        Metres from the near plane, at least 0.
    inside : ndarray of shape (n,), bool
        Which points are in the picture.
    """
    turn = np.array([camera.right, camera.up, camera.forward], np.float32)
    seen = places @ turn.T
    seen -= np.float32(turn.astype(np.float64) @ camera.eye)
    x, y, depth = seen[:, 0], seen[:, 1], seen[:, 2]
    width, height = size
    with np.errstate(all="ignore"):
        scale: Any = np.float32(1 / camera.metres_per_pixel(size))
        if not camera.parallel:
            scale = np.float32(camera.distance) * scale / depth
        column = np.floor(x * scale + np.float32(width / 2))
        row = np.floor(np.float32(height / 2) - y * scale)
        inside = (column >= 0) & (column < width) & (row >= 0) & (row < height) & (depth >= np.float32(near))
    pixel = row[inside].astype(np.int64) * width + column[inside].astype(np.int64)
    return pixel, depth[inside] - np.float32(near), inside


def nearest(
    places: Singles, camera: Camera, size: Size, near: float, look_up: Callable[[], None]
) -> tuple[Indices, Singles]:
    """Find the nearest point of every pixel.

    Parameters
    ----------
    places : ndarray of shape (N, 3), float32
    camera, size, near
        The view, and the depth of its near plane.
    look_up : callable
        Called every now and then; may raise :class:`Overtaken`.

    Returns
    -------
    rows : ndarray of shape (n,)
        Rows of ``places``, in the order of their pixels.
    depth : ndarray of shape (height, width), float32
        Metres from the eye, infinite where no point is.
    """
    best = np.full(size[0] * size[1], NONE, np.uint64)
    turn = Lock()

    def enter(start: int) -> None:
        pixel, depth, inside = pixels_of(places[start : start + CHUNK], camera, size, near)
        # depth above, row below: one minimum finds both, for positive floats are ordered as their bits
        keys = depth.view(np.uint32).astype(np.uint64) << np.uint64(32)
        keys |= (np.flatnonzero(inside) + start).astype(np.uint64)
        with turn:
            np.minimum.at(best, pixel, keys)

    with ThreadPoolExecutor(THREADS) as pool:
        try:
            for _ in pool.map(enter, range(0, len(places), CHUNK)):
                look_up()
        finally:
            pool.shutdown(cancel_futures=True)
    hit = best != NONE
    depth_of = np.full(best.shape, np.inf, np.float32)
    depth_of[hit] = (best[hit] >> np.uint64(32)).astype(np.uint32).view(np.float32) + np.float32(near)
    return (best[hit] & np.uint64(0xFFFFFFFF)).astype(np.int64), depth_of.reshape(size[1], size[0])


def settled(places: Singles, camera: Camera, size: Size) -> Singles:
    """Move points off the borders of their pixels, by less than an eye could tell.

    The nearest point of a slanted surface is always at the edge of its pixel, where a device that rounds
    coordinates draws it in the next one and leaves a hole.
    """
    turn = np.array([camera.right, camera.up, camera.forward], np.float32)
    seen = places @ turn.T
    seen -= np.float32(turn.astype(np.float64) @ camera.eye)
    metres = np.float32(camera.metres_per_pixel(size))
    pixel = metres if camera.parallel else metres / np.float32(camera.distance) * seen[:, 2]
    moved = places.copy()
    for axis, length in enumerate(size):
        at = seen[:, axis] / pixel + np.float32(length / 2)
        within = at - np.floor(at)
        step = np.clip(within, BORDER, 1 - BORDER, dtype=np.float32) - within
        moved += (step * pixel)[:, np.newaxis] * turn[axis]
    return moved


def point_size(sample: Singles, count: int, camera: Camera, size: Size, near: float, least: float) -> float:
    """Choose the side of drawn points so that a sparse cloud is seen and a dense one stays sharp.

    Parameters
    ----------
    sample : ndarray of shape (n, 3), float32
        Any of the points, evenly spread.
    count : int
        How many will be drawn.
    least : float
        What the scene asks for, pixels; more only as far as LARGEST_POINT.
    """
    pixel, _, inside = pixels_of(sample[:PROBE], camera, size, near)
    if not len(pixel):
        return least
    blocks = np.unique((pixel // size[0] // BLOCK) * size[0] + pixel % size[0] // BLOCK)
    expected = count * len(pixel) / len(inside)
    side = sqrt(DENSITY * len(blocks) * BLOCK**2 / expected)
    return max(least, min(float(round(side)), LARGEST_POINT))


def is_speckled(depth: Singles) -> bool:
    """Tell whether what lies behind shows between the points of a surface.

    Parameters
    ----------
    depth : ndarray of shape (height, width), float32
        As :func:`nearest` returns it.
    """
    beside = np.maximum(depth[:, :-2], depth[:, 2:])
    surface = np.isfinite(beside)
    open_pixels = surface & (depth[:, 1:-1] > beside + (BEHIND - 1) * np.abs(beside))
    return int(np.count_nonzero(open_pixels)) > SPECKS * int(np.count_nonzero(surface))
