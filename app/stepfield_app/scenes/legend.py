"""What the colours of a view stand for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Colour = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class Legend:
    """A ramp between two numbers, or a list of colours with their names; never both.

    Attributes
    ----------
    title : str
    unit : str
        Of ``low`` and ``high``; empty where there is none.
    ramp : ndarray of shape (256, 3), uint8, or None
    entries : tuple of (colour, str)
    low, high : float
        What the ends of the ramp stand for; values beyond take the colour of the end.
    note : str
        What else the colours of a ramp say; each after a comma goes on a line of its own.
    """

    title: str
    unit: str = ""
    ramp: NDArray[np.uint8] | None = None
    entries: tuple[tuple[Colour, str], ...] = ()
    low: float = 0.0
    high: float = 1.0
    note: str = ""
