"""What a 3-D view shows: plain arrays, near an origin so that float32 is exact enough.

Places are metres in *local coordinates*: scan coordinates less the scene's origin, which was subtracted in
float64. Colours are sRGB bytes as they shall appear on the screen; nothing is lit later.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Points:
    """A cloud; the renderer picks how many of them it draws.

    Attributes
    ----------
    places : ndarray of shape (N, 3), float32
    codes : ndarray of shape (N,), uint8, or of shape (N, 3)
        Rows of ``palette``, or colours of their own.
    palette : ndarray of shape (256, 3), uint8, or None
        None when ``codes`` are colours.
    size : float
        Side of a drawn point in pixels.
    """

    places: Singles
    codes: Bytes
    palette: Bytes | None = None
    size: float = 1.0


@dataclass(frozen=True, eq=False)
class Triangles:
    """A mesh with a colour at every vertex, drawn from both sides.

    Attributes
    ----------
    vertices : ndarray of shape (V, 3), float32
    triangles : ndarray of shape (T, 3), int32
    colours : ndarray of shape (V, 3), uint8
    solid : bool
        Whether they are the outside of bodies, anti-clockwise, that may be open at their foot: then nobody
        who stands above that sees a face from behind.
    """

    vertices: Singles
    triangles: NDArray[np.int32]
    colours: Bytes
    solid: bool = False


@dataclass(frozen=True, eq=False)
class Lines:
    """Line segments one pixel wide.

    Attributes
    ----------
    ends : ndarray of shape (L, 2, 3), float32
    colours : ndarray of shape (L, 3), uint8
    """

    ends: Singles
    colours: Bytes


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything one view shows.

    Attributes
    ----------
    points : Points or None
    meshes : tuple of Triangles
        The same surface in levels of detail, the finest first; one of them is drawn.
    lines : tuple of Lines
        Ground grid, boxes, outlines.
    low, high : ndarray of shape (3,)
        Bounds of what the view should frame, local coordinates.
    """

    points: Points | None = None
    meshes: tuple[Triangles, ...] = ()
    lines: tuple[Lines, ...] = ()
    low: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    high: NDArray[np.float64] = field(default_factory=lambda: np.ones(3))


EMPTY = Scene()

#: Names of the three views.
CLOUD, PILLARS, RECONSTRUCTION = VIEWS = ("cloud", "pillars", "reconstruction")


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture of a view.

    Attributes
    ----------
    pixels : ndarray of shape (height, width, 4), uint8
        BGRX, as Qt's Format_RGB32 in little-endian memory.
    depth : ndarray of shape (height, width), float32, or None
        Distance along the view direction in metres, 0 where nothing is drawn; comes with frames at rest.
    camera : Camera
        What it was drawn with.
    moving : bool
        Whether detail was left out for speed.
    points, triangles : int
        How many were drawn.
    covered : int
        Pixels that are not background; 0 for moving frames.
    seconds : float
        Time the drawing took.
    """

    pixels: Bytes
    depth: Singles | None
    camera: Any
    moving: bool
    points: int
    triangles: int
    covered: int
    seconds: float
