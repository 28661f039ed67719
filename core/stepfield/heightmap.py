"""Height-maps (paper 5.2): one pixel a compartment, gray levels by Eq. 2 or its 16-bit sister."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid

Floats = NDArray[np.float64]
Bits = Literal[8, 16]


@dataclass(frozen=True, slots=True)
class GrayScale:
    """How heights above the base plane become gray levels and back.

    Attributes
    ----------
    max_height : float
        The height that is white (H_max of Eq. 2), metres above the base plane.
    bits : int
        8, as in the paper, or 16.
    """

    max_height: float
    bits: Bits

    @property
    def step(self) -> float:
        """Metres in one gray level."""
        return self.max_height / (256 if self.bits == 8 else 65535)

    @property
    def zero(self) -> float:
        """Height that gray 0 decodes to: Eq. 2 rounds down, so an 8-bit level stands for its middle."""
        return self.step / 2 if self.bits == 8 else 0.0

    def encode(self, heights: Floats) -> NDArray[np.int64]:
        """Gray levels of heights in metres above the base plane, before occupied zeros are lifted."""
        if self.bits == 8:  # Eq. 2; H_max itself would be level 256, which does not exist
            return np.minimum(255, np.floor(heights * 256 / self.max_height)).astype(np.int64)
        return np.rint(heights * 65535 / self.max_height).astype(np.int64)

    def decode(self, gray: NDArray[np.integer]) -> Floats:
        """Heights in metres above the base plane, within half a level of what was encoded."""
        return self.zero + self.step * gray.astype(np.float64)


@dataclass(frozen=True, slots=True)
class Frame:
    """The size of the images and where the grid's north-west compartment sits in them."""

    width: int
    height: int
    column: int
    row: int

    @classmethod
    def around(cls, grid: Grid, pad: Literal["pow2", "none"]) -> Frame:
        """Centre the grid in the smallest powers of two that hold it; an odd pixel goes right and below."""
        if pad == "none":
            return cls(grid.columns, grid.rows, 0, 0)
        width, height = (1 << (side - 1).bit_length() for side in (grid.columns, grid.rows))
        return cls(width, height, (width - grid.columns) // 2, (height - grid.rows) // 2)


@dataclass(frozen=True)
class HeightMap:
    """One layer as an image.

    Attributes
    ----------
    gray : ndarray of shape (height, width), uint8 or uint16
        0 in holes and padding, never 0 in an occupied pixel.
    mask : ndarray of shape (height, width), bool
        True in occupied pixels.
    lifted : int
        Occupied and filled pixels that would have been 0 and became 1.
    filled : ndarray of shape (height, width), bool, or None
        True in pixels that were empty and have a level all the same; never where ``mask`` is.
    """

    gray: NDArray[np.uint8] | NDArray[np.uint16]
    mask: NDArray[np.bool_]
    lifted: int
    filled: NDArray[np.bool_] | None = None


def with_filled(measured: HeightMap, filled: HeightMap) -> HeightMap:
    """Put what was filled into the holes of what was measured, known apart by a mask of its own."""
    gray = np.maximum(measured.gray, filled.gray)
    return HeightMap(gray, measured.mask, measured.lifted + filled.lifted, filled.mask)


def draw(
    grid: Grid, frame: Frame, compartment: NDArray[np.int64], heights: Floats, scale: GrayScale
) -> HeightMap:
    """Draw one layer's pillars (at most one a compartment) as a height-map.

    Parameters
    ----------
    grid, frame : Grid, Frame
    compartment : ndarray of shape (P,)
    heights : ndarray of shape (P,)
        Metres above the base plane.
    scale : GrayScale
    """
    row, column = grid.row_column(compartment)
    pixel = (row + frame.row, column + frame.column)
    levels = scale.encode(heights)
    gray = np.zeros((frame.height, frame.width), np.uint8 if scale.bits == 8 else np.uint16)
    gray[pixel] = np.maximum(levels, 1)
    mask = np.zeros(gray.shape, bool)
    mask[pixel] = True
    return HeightMap(gray, mask, int(np.count_nonzero(levels == 0)))
