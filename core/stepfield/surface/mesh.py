"""Triangles, the common currency of surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Mesh:
    """Triangles in scan coordinates, counter-clockwise seen from outside.

    Attributes
    ----------
    vertices : ndarray of shape (V, 3), float64
        Metres.
    triangles : ndarray of shape (T, 3), int64
    """

    vertices: Floats
    triangles: Integers

    @property
    def plan_area(self) -> float:
        """Area the upward triangles cover in the plan, square metres."""
        a, b, c = (self.vertices[self.triangles[:, i], :2] for i in range(3))
        doubled = np.cross(np.c_[b - a, np.zeros(len(a))], np.c_[c - a, np.zeros(len(a))])[:, 2]
        return float(doubled[doubled > 0].sum() / 2)
