"""Eye-dome lighting: what lies behind its neighbours is darkened, which shows shape without normals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Singles = NDArray[np.float32]

#: Neighbours, rows and columns away.
CIRCLE = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))
NEIGHBOURS = (*CIRCLE, (0, 2), (2, 0), (0, -2), (-2, 0))
REACH = 2
#: The darkest a pixel becomes: colours must stay recognisable.
DARKEST = 0.42
#: How soon: of pixels of depth between a pixel and its neighbours, on average.
STRENGTH = 0.22
#: Depth steps larger than this many pixels say no more than this.
STEP_LIMIT = 24.0


def shade(relief: Singles) -> Singles:
    """Brightness of every pixel.

    Parameters
    ----------
    relief : ndarray of shape (height, width), float32
        Depth in units in which a slope of 45 degrees is 1 a pixel; infinite where nothing is drawn.

    Returns
    -------
    ndarray of shape (height, width), float32
        Between DARKEST and 1.
    """
    height, width = relief.shape
    padded = np.pad(relief, REACH, constant_values=np.float32(np.inf))
    inner = np.where(np.isfinite(relief), relief, -np.float32(np.inf))  # never behind anything
    behind, step = np.zeros_like(relief), np.empty_like(relief)
    for down, right in NEIGHBOURS:
        beside = padded[REACH + down : REACH + down + height, REACH + right : REACH + right + width]
        np.subtract(inner, beside, out=step)
        step /= max(abs(down), abs(right))
        np.clip(step, 0, STEP_LIMIT, out=step)
        behind += step
    behind *= np.float32(-STRENGTH / len(NEIGHBOURS))
    np.exp(behind, out=behind)
    behind *= np.float32(1 - DARKEST)
    behind += np.float32(DARKEST)
    return behind


def relief_of(depth: Singles, slope: float, parallel: bool, metres_per_pixel: float) -> Singles:
    """Turn depth in metres into what :func:`shade` takes.

    Parameters
    ----------
    depth : ndarray of shape (height, width), float32
        Metres, 0 where nothing is drawn.
    slope : float
        Metres a pixel measures for each metre of depth, in a perspective.
    parallel : bool
    metres_per_pixel : float
        For a parallel projection.
    """
    drawn = depth != 0
    if parallel:
        return np.where(drawn, depth / np.float32(metres_per_pixel), np.float32(np.inf))
    # in a perspective a pixel grows with depth: the integral of d(depth) / (slope * depth)
    relief = np.full(depth.shape, np.inf, np.float32)
    np.log(depth, out=relief, where=drawn)
    relief *= np.float32(1 / slope)
    return relief
