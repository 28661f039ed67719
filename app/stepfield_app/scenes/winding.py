"""Which points a closed path winds round, quick for a million of them.

Squares are laid over the path. Most of them it does not cross: their middle speaks for every point in them.
For the points of the others only those edges are looked at that pass at their height.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield_app.scenes.arrays import in_chunks

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Squares along the longer side of the path.
SQUARES = 768


def winds_round(path: Floats, points: Floats) -> Mask:
    """Tell which points a path winds round, closed from its end to its start.

    Parameters
    ----------
    path : ndarray of shape (n, 2)
    points : ndarray of shape (m, 2)
        Within the smallest box around the path.

    Returns
    -------
    ndarray of shape (m,), bool
    """
    wound, unsure = np.zeros(len(points), bool), np.zeros(len(points), bool)
    low, span = path.min(axis=0), np.ptp(path, axis=0)
    side = float(span.max()) / SQUARES
    if not side:
        return wound
    closed = (np.vstack([path, path[:1]]) - low) / side
    across, down = (int(count) for count in np.ceil(span / side) + 1)
    whole, crossed = _middles_within(closed, across, down), _crossed(closed, across, down)

    def look(part: slice) -> None:
        at = (points[part] - low) / side
        np.clip(at, 0, (across - 1, down - 1), out=at)
        place = at[:, 1].astype(np.int64) * across + at[:, 0].astype(np.int64)
        whole.take(place, out=wound[part])
        crossed.take(place, out=unsure[part])

    in_chunks(len(points), look)
    close = np.flatnonzero(unsure)
    wound[close] = _turns(closed, down, (points.take(close, axis=0) - low) / side) != 0
    return wound


def along(path: Floats, step: float) -> Floats:
    """Places along a path, its corners among them, no further apart than ``step``; shape (n, 2)."""
    if len(path) < 2:
        return path
    edges = np.diff(path, axis=0)
    pieces = np.maximum(np.ceil(np.hypot(*edges.T) / step), 1).astype(np.int64)
    edge, nth = _repeated(pieces)
    places = path[edge] + (nth / pieces[edge])[:, np.newaxis] * edges[edge]
    return np.vstack([places, path[-1:]])


def _crossed(closed: Floats, across: int, down: int) -> Mask:
    """Tell which squares a path may cross, shape (down * across,)."""
    from scipy.ndimage import binary_dilation  # no window waits for it

    crossed = np.zeros((down, across), bool)
    column, row = along(closed, 0.5).astype(np.int64).T
    crossed[row, column] = True
    widened: Mask = binary_dilation(crossed, np.ones((3, 3), bool))
    return widened.reshape(-1)


def _middles_within(closed: Floats, across: int, down: int) -> Mask:
    """Tell round the middles of which squares a path winds, shape (down * across,)."""
    start, end = closed[:-1], closed[1:]
    edge, row = _rows(start[:, 1], end[:, 1], 0.5)
    share = (row + 0.5 - start[edge, 1]) / (end[edge, 1] - start[edge, 1])
    x = start[edge, 0] + share * (end[edge, 0] - start[edge, 0])
    column = np.clip(np.ceil(x - 0.5), 0, across).astype(np.int64)
    turns = np.zeros((down, across + 1), np.int32)
    np.add.at(turns, (row, column), np.where(end[edge, 1] > start[edge, 1], 1, -1))
    within: Mask = np.cumsum(turns, axis=1)[:, :across] != 0
    return within.reshape(-1)


def _turns(closed: Floats, down: int, points: Floats) -> Integers:
    """How often a path winds round each point, by the edges that pass at its height to the right of it."""
    start, end = closed[:-1], closed[1:]
    low, high = np.minimum(start[:, 1], end[:, 1]), np.maximum(start[:, 1], end[:, 1])
    edge, row = _rows(np.floor(low), np.floor(high) + 1, 0.0)
    edge = edge[np.argsort(row, kind="stable")]
    held = np.bincount(row, minlength=down)
    first = np.cumsum(held) - held
    at = np.clip(points[:, 1], 0, down - 1).astype(np.int64)
    point, nth = _repeated(held[at])
    edge = edge[first[at[point]] + nth]
    (x, y), (x1, y1), (x2, y2) = points[point].T, start[edge].T, end[edge].T
    left = (x2 - x1) * (y - y1) - (x - x1) * (y2 - y1)
    upward, downward = (y1 <= y) & (y2 > y) & (left > 0), (y2 <= y) & (y1 > y) & (left < 0)
    ups, downs = (np.bincount(point[way], minlength=len(points)) for way in (upward, downward))
    return ups - downs


def _rows(begin: Floats, end: Floats, offset: float) -> tuple[Integers, Integers]:
    """Pair every edge with the rows whose line, ``offset`` into the row, it crosses: indices of both."""
    first = np.ceil(np.minimum(begin, end) - offset).astype(np.int64)
    edge, nth = _repeated(np.ceil(np.maximum(begin, end) - offset).astype(np.int64) - first)
    return edge, first[edge] + nth


def _repeated(counts: Integers) -> tuple[Integers, Integers]:
    """Repeat each index as often as said, and count the repetitions from 0."""
    index = np.repeat(np.arange(len(counts)), counts)
    return index, np.arange(len(index)) - np.repeat(np.cumsum(counts) - counts, counts)
