"""Shapes drawn by hand over a view, in the plane of that view: what lies in them, what they touch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield_app.scenes.arrays import frozen, in_chunks
from stepfield_app.scenes.brushing import touched
from stepfield_app.scenes.winding import winds_round

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Kind = Literal["click", "rectangle", "lasso", "brush", "surface"]

#: Pixels or metres that do not count: a shape ends exactly on the middle of a cell when keys draw it.
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Shape:
    """What the hand drew.

    Attributes
    ----------
    kind : str
        A ``click`` and a ``surface`` point at the last place of the path; a ``rectangle`` lies between the
        outermost places; a ``lasso`` is closed from the end of its path to the start, and what it winds
        round twice is in it too; a ``brush`` is a disc drawn along the path.
    path : ndarray of shape (n, 2), float64
        Pixels or metres, as the view has them.
    radius : float
        Of the brush, in the same unit.
    """

    kind: Kind
    path: Floats
    radius: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "path", np.asarray(self.path, np.float64).reshape(-1, 2))

    @property
    def is_pointing(self) -> bool:
        """Whether it points at one thing rather than taking what it covers."""
        return self.kind in ("click", "surface")

    def covers(self, points: Floats) -> Mask:
        """Tell which points lie in the shape.

        Parameters
        ----------
        points : ndarray of shape (m, 2)
            NaN lies in no shape.

        Returns
        -------
        ndarray of shape (m,), bool
        """
        if self.kind not in ("rectangle", "lasso"):
            return self.touches(points, 0.0)
        covered = self._near(points)
        near = np.flatnonzero(covered)
        if self.kind == "lasso" and len(near):
            covered[near] = winds_round(self.path, points.take(near, axis=0))
        return frozen(covered)

    def touches(self, middles: Floats, half: Floats | float) -> Mask:
        """Tell which boxes a brush touches; other shapes take those whose middle they cover.

        Parameters
        ----------
        middles : ndarray of shape (m, 2)
        half : ndarray of shape (m, 2) or float
            Half the width and height of the boxes.

        Returns
        -------
        ndarray of shape (m,), bool
        """
        if self.kind in ("rectangle", "lasso"):
            return self.covers(middles)
        half = np.broadcast_to(half, middles.shape)
        taken = self._near(middles, half)
        near = np.flatnonzero(taken)
        if len(near):
            path, radius = self.path[-1:] if self.is_pointing else self.path, self.radius + ROUNDING
            taken[near] = touched(path, radius, middles.take(near, axis=0), half.take(near, axis=0))
        return frozen(taken)

    def _near(self, points: Floats, half: Floats | None = None) -> Mask:
        """Mask of the points, or boxes around them, that meet the smallest box around the shape."""
        near = np.zeros(len(points), bool)
        if not len(self.path):
            return near
        margin = ROUNDING + (self.radius if self.kind == "brush" else 0.0)
        low, high = self.path.min(axis=0) - margin, self.path.max(axis=0) + margin

        def look(part: slice) -> None:
            inside = near[part]
            inside[:] = True
            for axis in range(2):
                along, wide = points[part, axis], 0.0 if half is None else half[part, axis]
                inside &= (along >= low[axis] - wide) & (along <= high[axis] + wide)

        in_chunks(len(points), look)
        return near
