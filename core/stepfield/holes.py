"""Holes: empty compartments that a layer encloses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid

Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Holes:
    """The holes of a layer; arrays are read-only.

    Attributes
    ----------
    count : int
        Regions of empty compartments, joined over their sides, from which no way leads out of the grid.
    compartment : ndarray of shape (n,), int64
        The compartments in them, ascending.
    region : ndarray of shape (n,), int64
        Which of the holes each is in, 0 to ``count`` - 1.
    """

    count: int
    compartment: Integers
    region: Integers

    def __post_init__(self) -> None:
        for array in (self.compartment, self.region):
            array.flags.writeable = False


def holes(grid: Grid, compartment: Integers) -> Holes:
    """Find the holes of a layer with pillars in some compartments."""
    from scipy import ndimage

    empty = np.ones((grid.rows, grid.columns), bool)
    empty.ravel()[compartment] = False
    regions, count = ndimage.label(empty)
    outside = np.zeros(count + 1, bool)
    for edge in (regions[0], regions[-1], regions[:, 0], regions[:, -1]):
        outside[edge] = True
    outside[0] = True  # what is occupied
    inside = np.flatnonzero(~outside[regions].ravel())
    number = np.cumsum(~outside) - 1
    return Holes(int(np.count_nonzero(~outside)), inside, number[regions.ravel()[inside]])
