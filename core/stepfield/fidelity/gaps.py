"""Gaps near the tolerance: where a small move of its slider would part pillars, or join them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.compartments import Compartments
from stepfield.parts import BOTTOM

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: A gap is near the tolerance when it differs from it by no more than this share of it.
NEAR = 0.25


@dataclass(frozen=True, eq=False)
class Gaps:
    """Compartments with a vertical gap near the tolerance; read-only.

    Attributes
    ----------
    compartment : ndarray of shape (n,), int64
        Ascending.
    gap : ndarray of shape (n,), float64
        The one of the compartment that is nearest to the tolerance, metres: a smaller one would part pillars
        if the tolerance were as small, a greater one would join them if it were as great.
    """

    compartment: Integers
    gap: Floats


def near_gaps(compartments: Compartments, tolerance: float, near: float = NEAR) -> Gaps:
    """Find the gaps between two consecutive points of a compartment that are near the tolerance.

    Parameters
    ----------
    compartments : Compartments
    tolerance : float
        Metres.
    near : float
        Share of the tolerance.
    """
    low, high = (min(tolerance * (1 + sign * near) / compartments.tick, 2.0**32) for sign in (-1, 1))
    parts = compartments.parts_for(max(int(np.ceil(low)) - 1, 0))
    chosen = np.flatnonzero((parts.gap >= low) & (parts.gap <= high) & (parts.gap != BOTTOM))
    gap: Floats = parts.gap[chosen] * np.float64(compartments.tick)
    place = np.searchsorted(compartments.start, parts.start[chosen], side="right") - 1
    order = np.lexsort((np.abs(gap - tolerance), place))
    order = order[np.diff(place[order], prepend=-1) > 0]
    found = Gaps(compartments.occupied[place[order]], gap[order])
    for array in (found.compartment, found.gap):
        array.flags.writeable = False
    return found
