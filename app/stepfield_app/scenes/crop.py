"""A crop box in the hand: its handles, and what dragging one does. No screen, only arithmetic."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepfield_app.render.camera import Camera

Floats = NDArray[np.float64]
#: x0, y0, z0, x1, y1, z1 in metres.
Box = tuple[float, float, float, float, float, float]

#: A side keeps at least this share of the box's longest side.
THINNEST = 1e-3
#: An axis seen so nearly end-on (this share of its full length) does not follow the hand: it would leap.
END_ON = 0.15


@dataclass(frozen=True)
class Handle:
    """A place to take hold of a box.

    Attributes
    ----------
    side : tuple of 3 int
        -1 and 1 for the sides that move with it, 0 for the axes it leaves alone: (1, 0, 0) is the middle of
        the east face, (-1, -1, 1) the upper south-west corner.
    """

    side: tuple[int, int, int]

    @property
    def is_corner(self) -> bool:
        """Whether it moves two sides in the plan at once."""
        return self.side[0] != 0 and self.side[1] != 0

    def point(self, box: Box) -> Floats:
        """Where it is on a box, shape (3,), in the coordinates of the box."""
        low, high = np.array(box[:3], np.float64), np.array(box[3:], np.float64)
        point: Floats = (low + high) / 2 + (high - low) / 2 * np.array(self.side)
        return point


FACES = tuple(
    Handle((sign if axis == 0 else 0, sign if axis == 1 else 0, sign if axis == 2 else 0))
    for axis, sign in product(range(3), (-1, 1))
)
CORNERS = tuple(Handle((x, y, z)) for x, y, z in product((-1, 1), repeat=3))
#: Pairs of indices of :data:`CORNERS`: the twelve edges.
EDGES = tuple(
    (one, other)
    for one, other in combinations(range(8), 2)
    if sum(a != b for a, b in zip(CORNERS[one].side, CORNERS[other].side, strict=True)) == 1
)
#: Corners first: where a corner and a face are close on the screen, the corner is meant.
HANDLES = CORNERS + FACES


def dragged(box: Box, handle: Handle, from_point: ArrayLike, to_point: ArrayLike) -> Box:
    """Return the box after its handle was dragged from one place to another; it keeps an inside.

    Parameters
    ----------
    box : tuple of 6 floats
    handle : Handle
    from_point, to_point : array_like of shape (3,)
        Metres, in any one system of coordinates.
    """
    step = np.asarray(to_point, np.float64) - np.asarray(from_point, np.float64)
    low, high = np.array(box[:3], np.float64), np.array(box[3:], np.float64)
    least = thinnest(box)
    for axis, sign in enumerate(handle.side):
        if sign < 0:
            low[axis] = min(low[axis] + step[axis], high[axis] - least)
        elif sign > 0:
            high[axis] = max(high[axis] + step[axis], low[axis] + least)
    return _box(low, high)


def moved(box: Box, step: ArrayLike) -> Box:
    """Return the box moved as a whole by (3,) metres."""
    return _box(np.array(box[:3]) + np.asarray(step), np.array(box[3:]) + np.asarray(step))


def slab(box: Box, low: float, high: float) -> Box:
    """Return the box between two elevations, in either order; it keeps an inside."""
    low, high = min(low, high), max(low, high)
    return (*box[:2], low, *box[3:5], max(high, low + thinnest(box)))


def within(box: Box, bounds: Box) -> Box:
    """Return the box cut to ``bounds``; a box beyond them becomes a thin one at their edge."""
    outer_low, outer_high = np.array(bounds[:3], np.float64), np.array(bounds[3:], np.float64)
    least = np.minimum(thinnest(bounds), outer_high - outer_low)
    low = np.clip(box[:3], outer_low, outer_high - least)
    return _box(low, np.clip(box[3:], low + least, outer_high))


def thinnest(box: Box) -> float:
    """Least length of a side, metres."""
    return THINNEST * max(*(high - low for low, high in zip(box[:3], box[3:], strict=True)), 1e-6)


def dragged_on_screen(
    box: Box, handle: Handle, camera: Camera, size: tuple[int, int], dx: float, dy: float
) -> Box:
    """Return the box after its handle was dragged by some pixels.

    A face moves along its axis, a corner level in the plan; axes seen nearly end-on stay.

    Parameters
    ----------
    box : tuple of 6 floats
        Local coordinates, metres, as it was when the drag began.
    handle : Handle
    camera : Camera
    size : tuple of int
        Width and height of the view, pixels.
    dx, dy : float
        Pixels to the right and down since the drag began.
    """
    point = handle.point(box)
    axes = (0, 1) if handle.is_corner else (int(np.flatnonzero(handle.side)[0]),)
    step = np.zeros(3)
    step[list(axes)] = _metres(camera, size, point, axes, dx, dy)
    return dragged(box, handle, point, point + step)


def along_axis(
    camera: Camera, size: tuple[int, int], point: ArrayLike, axis: int, dx: float, dy: float
) -> float:
    """Metres along an axis (0, 1, 2 for x, y, z) that a drag by pixels at a point means."""
    return float(_metres(camera, size, np.asarray(point, np.float64), (axis,), dx, dy)[0])


def _metres(
    camera: Camera, size: tuple[int, int], point: Floats, axes: Sequence[int], dx: float, dy: float
) -> Floats:
    """Metres along axes that come nearest to a drag on the screen."""
    reach = camera.metres_per_pixel(size)
    ends = point + reach * np.eye(3)[list(axes)]
    pixels, _ = camera.project(np.vstack([point, ends]), size)
    towards = (pixels[1:] - pixels[0]).T / reach  # (2, k): pixels a metre along each axis
    if not np.isfinite(towards).all():  # behind the eye
        return np.zeros(len(axes))
    left, strength, right = np.linalg.svd(towards, full_matrices=False)
    seen = strength > END_ON / reach
    solved: Floats = right.T @ ((left.T @ [dx, dy]) * np.where(seen, 1 / np.maximum(strength, 1e-30), 0))
    return solved


def _box(low: Floats, high: Floats) -> Box:
    (x0, y0, z0), (x1, y1, z1) = low.tolist(), high.tolist()
    return x0, y0, z0, x1, y1, z1
