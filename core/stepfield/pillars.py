"""Pillars (paper 5.1 and 5.3.2): each compartment's points, parted at vertical gaps, one pillar a part."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield import walls
from stepfield.compartments import Compartments
from stepfield.parts import BOTTOM

Statistic = Literal["mean", "max", "median", "p90"]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class StepField:
    """All pillars over a grid, ordered by compartment and, within it, from the lowest up.

    Elevations are metres above the scan's lowest point; the paper's height adds alpha (Eq. 1).

    Attributes
    ----------
    compartments : Compartments
        The sorted points the pillars are made of.
    start : ndarray of shape (P + 1,), int64
        Where each pillar's points begin among the sorted points; the last entry is N.
    compartment : ndarray of shape (P,), int64
        Number of the compartment each pillar stands in.
    first : ndarray of shape (C + 1,), int64
        Index of the first pillar of each occupied compartment; the last entry is P.
    elevation : ndarray of shape (P,), float64
        The pillar's top by the chosen statistic, before alpha.
    layer_tolerance : float
        That the pillars were parted by, metres.
    share : float
        Of the scan's points; less than 1 in a preview.
    """

    compartments: Compartments
    start: Integers
    compartment: Integers
    first: Integers
    elevation: Floats
    layer_tolerance: float = math.inf
    share: float = 1.0

    def __len__(self) -> int:
        return len(self.compartment)

    @property
    def points(self) -> Integers:
        """Number of points in each pillar, shape (P,)."""
        return np.diff(self.start)

    @cached_property
    def low(self) -> Floats:
        """Lowest point of each pillar, shape (P,)."""
        return self.compartments.ticks[self.start[:-1]] * np.float64(self.compartments.tick)

    @cached_property
    def high(self) -> Floats:
        """Highest point of each pillar, shape (P,)."""
        return self.compartments.ticks[self.start[1:] - 1] * np.float64(self.compartments.tick)

    @cached_property
    def vertical(self) -> NDArray[np.bool_]:
        """Whether each pillar is a wall or a column, shape (P,): see :mod:`stepfield.walls`; read-only."""
        return walls.vertical(self.compartments, self.start, self.layer_tolerance, self.share)

    def lows(self, chosen: NDArray[np.int64]) -> Floats:
        """Lowest points of some pillars, shape (n,)."""
        return self.compartments.ticks[self.start[chosen]] * np.float64(self.compartments.tick)

    def highs(self, chosen: NDArray[np.int64]) -> Floats:
        """Highest points of some pillars, shape (n,)."""
        return self.compartments.ticks[self.start[chosen + 1] - 1] * np.float64(self.compartments.tick)

    @property
    def rank(self) -> Integers:
        """Place of each pillar in its compartment counted from the lowest, shape (P,)."""
        return np.arange(len(self)) - np.repeat(self.first[:-1], np.diff(self.first))

    def boxes(self, chosen: NDArray[np.int64]) -> Floats:
        """Return x0, y0, x1, y1, z_low, z_high of pillars in scan coordinates, shape (n, 6), metres."""
        squares = self.compartments.grid.squares(self.compartment[chosen])
        spans = np.column_stack([self.lows(chosen), self.highs(chosen)]) + self.compartments.lowest
        return np.hstack([squares, spans])

    def with_walls_to_their_tops(self) -> StepField:
        """Return the same pillars, the vertical ones at the elevation of their highest point."""
        tops = np.flatnonzero(self.vertical)
        elevation = self.elevation.copy()
        elevation[tops] = self.highs(tops)
        elevation.flags.writeable = False
        return replace(self, elevation=elevation)


def build_pillars(
    compartments: Compartments, layer_tolerance: float, statistic: Statistic = "mean", share: float = 1.0
) -> StepField:
    """Part the points of each compartment where two elevations in a row differ by more than the tolerance.

    Parameters
    ----------
    compartments : Compartments
    layer_tolerance : float
        Metres.
    statistic : str
        What the pillar's elevation is; the paper's is the mean.
    share : float
        Of the scan's points that these are.
    """
    ticks, tick = compartments.ticks, compartments.tick
    # A gap of exactly the tolerance does not part; the tiny share forgives the rounding of tolerance / tick.
    widest = int(min(layer_tolerance / tick * (1 + 1e-12), 2.0**32))
    parts = compartments.parts_for(widest)
    chosen = parts.wider_than(widest)
    start = np.append(parts.start[chosen], len(ticks))
    first = np.append(np.flatnonzero(parts.gap[chosen] == BOTTOM), len(chosen))
    compartment = np.repeat(compartments.occupied, np.diff(first))
    if statistic == "mean":
        elevation = np.diff(parts.below[np.append(chosen, len(parts.gap))]) / np.diff(start) * tick
    else:
        elevation = _quantile(ticks, start, {"max": 1.0, "median": 0.5, "p90": 0.9}[statistic]) * tick
    for array in (start, compartment, first, elevation):
        array.flags.writeable = False
    return StepField(compartments, start, compartment, first, elevation, layer_tolerance, share)


def _quantile(ticks: NDArray[np.uint32], start: Integers, share: float) -> Floats:
    """Quantile of each pillar's sorted ticks, interpolated between the two nearest points."""
    place = start[:-1] + share * (np.diff(start) - 1)
    below = np.floor(place).astype(np.int64)
    above = np.minimum(below + 1, start[1:] - 1)
    weight = place - below
    return ticks[below] * (1 - weight) + ticks[above] * weight
