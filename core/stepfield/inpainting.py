"""Biharmonic inpainting of a raster's holes, some at a time: as all at once, but can be stopped between."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.progress import Progress, silent

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Pixels that are solved at a time, at least: fewer cost more than they let anybody stop sooner.
LEAST = 1000
#: Parts at most: each may look at all of a raster.
MOST_PARTS = 32
#: How far the equations of a pixel reach.
_REACH = 2


def inpainted(raster: Floats, is_hole: Flags, progress: Progress = silent) -> Floats:
    """Continue slopes into holes, within the span of what is known (Damelin and Hoang, 2018).

    Parameters
    ----------
    raster : ndarray of shape (rows, columns)
        Two columns or more. Whatever it holds in holes is not looked at.
    is_hole : ndarray of shape (rows, columns), bool
    progress : Progress
        Asked before every part.

    Returns
    -------
    ndarray of shape (rows, columns)
    """
    from skimage.restoration import inpaint_biharmonic

    if not is_hole.any():
        return raster.copy()
    span = raster[~is_hole].min(), raster[~is_hole].max()
    solved, part = np.where(is_hole, span[0], raster), _parts(is_hole)
    numbers = np.unique(part[is_hole])
    for done, number in enumerate(numbers):
        progress(done / len(numbers), "filling holes")
        mine = part == number
        window = _window(mine)
        known, own = solved[window].copy(), mine[window]
        if window.start > 0:
            known[0, :2] = span  # which is what the solution is clipped to
        elif window.stop < len(raster):
            known[-1, :2] = span
        solved[window][own] = inpaint_biharmonic(known, own)[own]
    return solved


def _parts(is_hole: Flags) -> Integers:
    """Number holes by the part that they are solved in; -1 elsewhere.

    Holes that are within reach of each other's equations are solved together.
    """
    from scipy.ndimage import binary_dilation, label

    region, _ = label(binary_dilation(is_hole), np.ones((3, 3)))
    region[~is_hole] = 0
    size = np.bincount(region.ravel())[1:]
    part: Integers = (np.cumsum(size) - size) // max(LEAST, size.sum() // MOST_PARTS)
    numbers: Integers = np.append(-1, part)[region]
    return numbers


def _window(mine: Flags) -> slice:
    """Rows that a part needs, and one more on each side, on which nothing depends, where there is one."""
    rows = np.flatnonzero(mine.any(axis=1))
    return slice(max(int(rows[0]) - _REACH - 1, 0), min(int(rows[-1]) + _REACH + 2, len(mine)))
