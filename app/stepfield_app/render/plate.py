"""A picture as it was drawn, kept so that other outlines can be painted over it without drawing it again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stepfield_app.render.camera import Camera, Size
from stepfield_app.render.outline import KINDS, Outline, paint
from stepfield_app.render.picture import Picture
from stepfield_app.render.scene import Bytes, Singles


@dataclass(frozen=True, eq=False)
class Plate:
    """The newest picture of a view, without outlines.

    Attributes
    ----------
    key : object
        What it shows: pictures of equal keys are equal.
    camera : Camera
    pixels : ndarray of shape (height, width, 4), uint8
        Blue, green, red and 255.
    depth : ndarray of shape (height, width), float32, or None
        Metres, 0 where nothing is drawn.
    points, triangles, covered : int
    """

    key: object
    camera: Camera
    pixels: Bytes
    depth: Singles | None
    points: int
    triangles: int
    covered: int

    @classmethod
    def of(cls, picture: Picture, key: object, camera: Camera, last: Plate | None) -> Plate:
        """Keep a picture, in the memory of the last one if it has the same size."""
        height, width = picture.colours.shape[:2]
        fits = last is not None and last.pixels.shape[:2] == (height, width)
        pixels = last.pixels if last is not None and fits else np.empty((height, width, 4), np.uint8)
        picture.write(pixels)
        return cls(key, camera, pixels, picture.depth, picture.points, picture.triangles, picture.covered)

    @property
    def size(self) -> Size:
        """Width and height in pixels."""
        height, width = self.pixels.shape[:2]
        return width, height

    def serves(self, key: object, outlines: Mapping[str, Outline]) -> bool:
        """Whether it shows what is asked for, and knows enough to paint outlines over it."""
        return self.key == key and (self.depth is not None or not outlines)

    def print(self, pixels: Bytes, outlines: Mapping[str, Outline]) -> None:
        """Write it with outlines into an array of its shape."""
        pixels[:] = self.pixels
        for kind in KINDS:
            if kind in outlines:
                paint(pixels, self.depth, self.camera, outlines[kind], kind)
