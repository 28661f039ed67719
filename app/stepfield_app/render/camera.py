"""Where a 3-D view is seen from: a turntable camera, z up, and its arithmetic between metres and pixels.

Pixels are measured from the upper left corner of the picture, y down; the middle of the first pixel is at
(0.5, 0.5). Depths are metres from the eye along the view direction, in both projections.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from math import cos, radians, sin, tan
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Point = tuple[float, float, float]
Doubles = NDArray[np.float64]
Size = tuple[int, int]

#: Degrees of a turn for one pixel of a drag.
DEGREES_PER_PIXEL = 0.3
#: Share of the picture left free on each side by :meth:`Camera.fitting`.
MARGIN = 0.05
#: Least distance of a fitting camera, in depths of the box's farthest corner from its middle.
LEAST_DISTANCE, LEAST_PARALLEL = 1.05, 0.05
#: Metres between eye and centre: nearer or farther, float32 places have no meaning.
NEAREST, FARTHEST = 1e-3, 1e6


@dataclass(frozen=True)
class Camera:
    """A camera that turns around a point.

    Attributes
    ----------
    centre : tuple of 3 floats
        What the camera turns around and looks at; local coordinates, metres.
    azimuth, elevation : float
        Degrees. Azimuth 0 looks north, 90 east; elevation 90 looks straight down.
    distance : float
        Metres from the eye to the centre.
    parallel : bool
        Whether lines of sight are parallel; the scale is then that of a perspective at the centre.
    """

    centre: Point
    azimuth: float
    elevation: float
    distance: float
    parallel: bool = False

    #: Degrees, vertical.
    FIELD_OF_VIEW: ClassVar[float] = 45.0
    #: Half of a picture's height, in distances from the eye.
    SLOPE: ClassVar[float] = tan(radians(FIELD_OF_VIEW / 2))

    @classmethod
    def fitting(
        cls,
        low: ArrayLike,
        high: ArrayLike,
        size: Size,
        azimuth: float = 0.0,
        elevation: float = 90.0,
        parallel: bool = False,
    ) -> Camera:
        """Camera that shows a box as large as the picture allows, 5 % free at each side.

        Parameters
        ----------
        low, high : array_like of shape (3,)
            Corners of the box, metres.
        size : tuple of int
            Width and height of the picture, pixels.
        azimuth, elevation : float
            Degrees.
        parallel : bool
        """
        low, high = np.asarray(low, float), np.asarray(high, float)
        middle = (low + high) / 2
        camera = cls(_point(middle), azimuth, _elevation(elevation), 1.0, parallel)
        corners = np.array(list(product(*zip(low, high, strict=True)))) - middle
        across, along = corners @ camera._rows[:2].T, corners @ camera.forward
        width, height = size
        slopes = cls.SLOPE * (1 - 2 * MARGIN) * np.array([width / max(height, 1), 1.0])
        needed = np.abs(across) / slopes - (0 if parallel else along[:, np.newaxis])
        # a box seen end-on has next to no width: stay outside of it nevertheless
        outside = np.abs(along).max() * (LEAST_PARALLEL if parallel else LEAST_DISTANCE)
        distance = float(max(needed.max(), outside))
        return replace(camera, distance=_distance(distance) if distance > NEAREST else 1.0)

    @property
    def forward(self) -> Doubles:
        """Unit vector along the view direction."""
        azimuth, elevation = radians(self.azimuth), radians(self.elevation)
        return np.array([sin(azimuth) * cos(elevation), cos(azimuth) * cos(elevation), -sin(elevation)])

    @property
    def right(self) -> Doubles:
        """Unit vector to the right of the picture; always level."""
        return np.array([cos(radians(self.azimuth)), -sin(radians(self.azimuth)), 0.0])

    @property
    def up(self) -> Doubles:
        """Unit vector to the top of the picture."""
        return np.cross(self.right, self.forward)

    @property
    def eye(self) -> Doubles:
        """Place of the eye, metres."""
        return np.asarray(self.centre) - self.distance * self.forward

    @property
    def _rows(self) -> Doubles:
        """Right, up and forward as rows."""
        return np.array([self.right, self.up, self.forward])

    def orbited(self, dx: float, dy: float) -> Camera:
        """Camera after a drag by some pixels that turns the scene: its near side follows the hand."""
        return self.looking(self.azimuth + dx * DEGREES_PER_PIXEL, self.elevation + dy * DEGREES_PER_PIXEL)

    def panned(self, dx: float, dy: float, size: Size) -> Camera:
        """Camera after a drag by some pixels that moves the scene; what is at the centre follows the hand."""
        step = self.metres_per_pixel(size)
        return self.with_centre(np.asarray(self.centre) + step * (dy * self.up - dx * self.right))

    def zoomed(self, factor: float, towards: Point | None = None) -> Camera:
        """Camera ``factor`` times as near; the point ``towards`` stays where it is in the picture."""
        distance = _distance(self.distance / factor)
        centre = np.asarray(self.centre)
        if towards is not None:
            fixed = np.asarray(towards)
            centre = fixed + (centre - fixed) * (distance / self.distance)
        return replace(self, centre=_point(centre), distance=distance)

    def looking(self, azimuth: float, elevation: float) -> Camera:
        """Camera with another view direction, degrees; it stops at straight down and straight up."""
        return replace(self, azimuth=azimuth % 360, elevation=_elevation(elevation))

    def with_centre(self, point: ArrayLike) -> Camera:
        """Camera moved so that it turns around another point."""
        return replace(self, centre=_point(np.asarray(point, float)))

    def metres_per_pixel(self, size: Size) -> float:
        """Size of a pixel at the depth of the centre."""
        return 2 * self.SLOPE * self.distance / max(size[1], 1)

    def project(self, points: ArrayLike, size: Size) -> tuple[Doubles, Doubles]:
        """Find points in the picture.

        Parameters
        ----------
        points : array_like of shape (n, 3) or (3,)
            Metres, local coordinates.
        size : tuple of int
            Width and height of the picture.

        Returns
        -------
        pixels : ndarray of shape (n, 2)
            NaN for points behind the eye of a perspective.
        depth : ndarray of shape (n,)
            Metres.
        """
        seen = (np.asarray(points, float).reshape(-1, 3) - self.eye) @ self._rows.T
        depth = seen[:, 2]
        scale = 1 / self._metres_per_pixel_at(depth, size)
        x, y = seen[:, 0] * scale, seen[:, 1] * scale
        return np.column_stack([size[0] / 2 + x, size[1] / 2 - y]), depth

    def unproject(self, x: float, y: float, depth: float, size: Size) -> Point:
        """Find the point at a place and depth of the picture: the inverse of :meth:`project`."""
        scale = self.distance if self.parallel else depth
        scale *= 2 * self.SLOPE / max(size[1], 1)
        across = (x - size[0] / 2) * scale * self.right + (size[1] / 2 - y) * scale * self.up
        return _point(self.eye + across + depth * self.forward)

    def _metres_per_pixel_at(self, depth: Doubles, size: Size) -> Doubles:
        if self.parallel:
            return np.full(depth.shape, self.metres_per_pixel(size))
        return np.where(depth > 0, depth, np.nan) * (2 * self.SLOPE / max(size[1], 1))


def _point(values: Doubles) -> Point:
    x, y, z = values.tolist()
    return x, y, z


def _elevation(degrees: float) -> float:
    return min(max(degrees, -90.0), 90.0)


def _distance(metres: float) -> float:
    return min(max(metres, NEAREST), FARTHEST)
