"""What a profile shows of pillars, as boxes in its own plane: those under the line, and those in its band."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield_app.scenes.section import cut

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Place = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Slices:
    """Boxes of pillars: metres along the line across, elevation in scan coordinates up.

    Attributes
    ----------
    pillar : ndarray of shape (n,), int64
        Index into the step-field.
    middle, half : ndarray of shape (n, 2), float64
        Middle of the box, and half its width and height.
    top : ndarray of shape (n, 2), float64
        Middle of the pillar's top.
    """

    pillar: Integers
    middle: Floats
    half: Floats
    top: Floats

    @classmethod
    def under(cls, result: Reconstruction, start: Place, end: Place) -> Slices:
        """Slices of the pillars that a line passes over, as the profile draws them."""
        found = cut(result, np.asarray(start, float), np.asarray(end, float))
        foot = np.where(found.standing, result.base_elevation, found.low)
        low = np.column_stack([found.start, foot])
        high = np.column_stack([found.end, np.maximum(found.high, found.elevation)])
        return cls._between(found.pillar, low, high, found.elevation)

    @classmethod
    def near(cls, result: Reconstruction, start: Place, end: Place, width: float) -> Slices:
        """Slices of those, then of all whose compartment has its middle in a band along the line."""
        under, beside = cls.under(result, start, end), cls._beside(result, start, end, width)
        new = ~np.isin(beside.pillar, under.pillar)
        pairs = ((getattr(under, name), getattr(beside, name)[new]) for name in cls.__dataclass_fields__)
        return cls(*(np.concatenate(pair) for pair in pairs))

    @classmethod
    def _beside(cls, result: Reconstruction, start: Place, end: Place, width: float) -> Slices:
        field, cells = result.field, result.field.compartments
        along, aside = _from_line(cells.grid.centres(cells.occupied), start, end)
        length = float(np.hypot(*np.subtract(end, start)))
        inside = (along >= 0) & (along <= length) & (np.abs(aside) <= width / 2) & (length > 0)
        pillar = np.flatnonzero(np.repeat(inside, np.diff(field.first)))
        at = np.repeat(along, np.diff(field.first))[pillar]
        half, lowest = cells.grid.cell_size / 2, cells.lowest
        low = np.column_stack([at - half, field.low[pillar] + lowest])
        high = np.column_stack([at + half, field.high[pillar] + lowest])
        return cls._between(pillar, low, high, field.elevation[pillar] + lowest)

    @classmethod
    def _between(cls, pillar: Integers, low: Floats, high: Floats, elevation: Floats) -> Slices:
        middle = (low + high) / 2
        return cls(pillar, middle, (high - low) / 2, np.column_stack([middle[:, 0], elevation]))


def _from_line(places: Floats, start: Place, end: Place) -> tuple[Floats, Floats]:
    """Metres along a line from its start, and to the right of it."""
    line = np.subtract(end, start)
    east, north = line / max(float(np.hypot(*line)), 1e-30)
    x, y = (places - start).T
    return x * east + y * north, x * north - y * east
