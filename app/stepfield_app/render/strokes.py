"""Line segments as pixels of a picture: projected, cut to its frame, sampled once a pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield_app.render.camera import Camera, Size
from stepfield_app.render.scene import Singles

Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: A perspective shows nothing nearer to the eye than this share of the distance to the centre.
NEAR_SHARE = 1e-3
#: Pixels at each edge that no sample lies in, so that every sample has neighbours to paint.
BORDER = 2


@dataclass(frozen=True, eq=False)
class Strokes:
    """Samples of segments.

    Attributes
    ----------
    pixel : ndarray of shape (m,), int64
        Row times width plus column.
    depth : ndarray of shape (m,), float32
        Metres from the eye along the view direction.
    along : ndarray of shape (m,), int32
        Column or row, of whichever the segment crosses more: for patterns that go on from one to the next.
    """

    pixel: Indices
    depth: Singles
    along: NDArray[np.int32]

    def of(self, chosen: Mask) -> Strokes:
        """Return some of the samples."""
        return Strokes(self.pixel[chosen], self.depth[chosen], self.along[chosen])


def strokes(segments: Singles, camera: Camera, size: Size) -> Strokes:
    """Find the pixels of segments, shape (n, 2, 3), local coordinates."""
    tails, tips = _framed(*_projected(segments, camera, size), size)
    return _sampled(tails, tips, camera.parallel, size)


def _projected(segments: Singles, camera: Camera, size: Size) -> tuple[Singles, Singles]:
    """Return the ends of the segments before the eye, each of shape (3, n): column, row, linear depth.

    Linear along a line of the picture is depth in a parallel projection, its inverse in a perspective.
    """
    turn = np.array([camera.right, camera.up, camera.forward], np.float32)
    seen = turn @ segments.reshape(-1, 3).T
    seen -= (turn.astype(np.float64) @ camera.eye).astype(np.float32)[:, np.newaxis]
    tails, tips = seen[:, ::2], seen[:, 1::2]
    if not camera.parallel:
        tails, tips = _before_the_eye(tails, tips, np.float32(NEAR_SHARE * camera.distance))
    return _on_the_picture(tails, camera, size), _on_the_picture(tips, camera, size)


def _before_the_eye(tails: Singles, tips: Singles, near: np.float32) -> tuple[Singles, Singles]:
    """Leave out what is behind the near plane, and cut what goes through it."""
    some = np.maximum(tails[2], tips[2]) > near
    if not some.all():
        tails, tips = tails[:, some], tips[:, some]
    if not (np.minimum(tails[2], tips[2]) <= near).any():
        return tails, tips
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (near - tails[2]) / (tips[2] - tails[2])
    cut = tails + share * (tips - tails)
    cut[2] = near
    return np.where(tails[2] < near, cut, tails), np.where(tips[2] < near, cut, tips)


def _on_the_picture(places: Singles, camera: Camera, size: Size) -> Singles:
    metres = np.float32(camera.metres_per_pixel(size))
    drawn = np.empty_like(places)
    if camera.parallel:
        scale, drawn[2] = 1 / metres, places[2]
    else:
        np.divide(1, places[2], out=drawn[2])
        scale = drawn[2] * np.float32(camera.distance / metres)
    np.multiply(places[:2], scale, out=drawn[:2])
    drawn[0] += np.float32(size[0] / 2)
    np.subtract(np.float32(size[1] / 2), drawn[1], out=drawn[1])
    return drawn


def _framed(tails: Singles, tips: Singles, size: Size) -> tuple[Singles, Singles]:
    """Leave out segments beyond the frame, and cut those that cross it (Liang and Barsky)."""
    low, high = np.minimum(tails[:2], tips[:2]), np.maximum(tails[:2], tips[:2])
    most = np.array(size, np.float32)[:, np.newaxis] - BORDER
    meets = ((high >= BORDER) & (low < most)).all(axis=0)
    if not meets.all():
        tails, tips, low, high = tails[:, meets], tips[:, meets], low[:, meets], high[:, meets]
    crossing = np.flatnonzero(((low < BORDER) | (high >= most)).any(axis=0))
    if len(crossing):
        cut = _cut(tails[:, crossing].astype(np.float64), tips[:, crossing].astype(np.float64), most)
        tails, tips = tails.copy(), tips.copy()
        tails[:, crossing], tips[:, crossing] = cut
    return tails, tips


def _cut(
    tails: NDArray[np.float64], tips: NDArray[np.float64], most: NDArray[np.float32]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    step = tips - tails
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.stack([(BORDER - tails[:2]) / step[:2], (most - 1e-3 - tails[:2]) / step[:2]])
    shares = np.where(step[:2] == 0, np.array([0.0, 1.0])[:, np.newaxis, np.newaxis], shares)
    enter = np.clip(shares.min(axis=0).max(axis=0), 0, 1)
    leave = np.clip(shares.max(axis=0).min(axis=0), enter, 1)
    return tails + enter * step, tails + leave * step


def _sampled(tails: Singles, tips: Singles, parallel: bool, size: Size) -> Strokes:
    width, height = size
    step = tips - tails
    is_steep = np.abs(step[1]) > np.abs(step[0])
    last = np.ceil(np.abs(step[:2]).max(axis=0, initial=0)).astype(np.int32)
    of = np.repeat(np.arange(len(last)), last + 1)
    starts = np.cumsum(last + 1) - (last + 1)
    share = (np.arange(len(of)) - starts[of]).astype(np.float32)
    share /= np.maximum(last, 1).astype(np.float32)[of]
    column = _between(tails[0], step[0], of, share).astype(np.int32)
    row = _between(tails[1], step[1], of, share).astype(np.int32)
    depth = _between(tails[2], step[2], of, share)
    inside = (column >= BORDER) & (column < width - BORDER) & (row >= BORDER) & (row < height - BORDER)
    pixel = row.astype(np.int64) * width + column
    along = np.where(is_steep[of], row, column)
    if not parallel:
        np.reciprocal(depth, out=depth)
    made = Strokes(pixel, depth, along)
    return made if inside.all() else made.of(inside)


def _between(tail: Singles, step: Singles, of: Indices, share: Singles) -> Singles:
    between: Singles = step[of]
    between *= share
    between += tail[of]
    return between
