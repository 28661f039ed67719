"""Which boxes a round brush touches on its way, quick for a million of them.

The way is laid out in dots. Squares over it tell of most boxes: from the distance of a square's middle to the
nearest dot follow bounds for all within it. Only for the others the nearest dot is looked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stepfield_app.scenes.arrays import in_chunks
from stepfield_app.scenes.winding import along

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Dots for each radius travelled (or half a box where that is larger), and at most.
DOTS, MOST_DOTS = 8, 20_000
#: Squares along the longer side of the way, and boxes that are worth laying them.
SQUARES, MANY = 384, 20_000


def touched(path: Floats, radius: float, middles: Floats, half: Floats) -> Mask:
    """Tell which boxes a disc touches that is drawn along a path.

    Parameters
    ----------
    path : ndarray of shape (n, 2)
        At least one place.
    radius : float
        Above zero.
    middles, half : ndarray of shape (m, 2)
        Of at least one box: its middle, half its width and height.

    Returns
    -------
    ndarray of shape (m,), bool
    """
    from scipy.spatial import cKDTree  # half a second that no window waits for

    length = float(np.hypot(*np.diff(path, axis=0).T).sum())
    dots = along(path, max(max(radius, half.min()) / DOTS, length / MOST_DOTS))
    widest = half[:, 0].max(), half[:, 1].max()  # ten times as quick as both at once
    tree, farthest = cKDTree(dots), radius + float(np.hypot(*widest))
    near, taken = _unsure(tree, middles, radius, farthest)
    place, side = middles.take(near, axis=0), half.take(near, axis=0)
    gap = tree.query(place, distance_upper_bound=farthest, workers=-1)[0] - radius
    taken[near] = gap <= side.min(axis=1)
    corner = ~taken[near] & (gap <= np.hypot(*side.T))
    near, place, side = near[corner], place[corner], side[corner]
    pairs = cKDTree(place).sparse_distance_matrix(tree, farthest, output_type="ndarray")
    box, dot = pairs["i"], pairs["j"]
    beyond = np.maximum(np.abs(place[box] - dots[dot]) - side[box], 0)
    taken[near[box[np.hypot(*beyond.T) <= radius]]] = True
    return taken


def _unsure(tree: cKDTree, places: Floats, radius: float, farthest: float) -> tuple[Integers, Mask]:
    """Return which places are neither surely within ``radius`` of a dot nor surely beyond ``farthest``.

    The mask is of those that are surely within.
    """
    if len(places) < MANY:
        return np.arange(len(places)), np.zeros(len(places), bool)
    low, span = tree.mins - farthest, tree.maxes - tree.mins + 2 * farthest
    side = float(span.max()) / SQUARES
    across, down = (int(count) for count in np.ceil(span / side) + 1)
    middles = low + (np.indices((across, down)).reshape(2, -1).T + 0.5) * side
    around = side / np.sqrt(2)  # from the middle of a square to its corners
    distance, _ = tree.query(middles, distance_upper_bound=farthest + around, workers=-1)
    within, maybe = distance + around <= radius, distance - around <= farthest
    taken, unsure = np.empty(len(places), bool), np.empty(len(places), bool)

    def look(part: slice) -> None:
        at = np.clip((places[part] - low) / side, 0, (across - 1, down - 1)).astype(np.int64)
        square = at[:, 0] * down + at[:, 1]
        taken[part], unsure[part] = within.take(square), maybe.take(square)

    in_chunks(len(places), look)
    return np.flatnonzero(unsure & ~taken), taken
