"""The surfaces of layers, over exactly the compartments of their pillars: corners, steps to be closed (6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.surface.corners import (
    NORTH_EAST,
    NORTH_WEST,
    SOUTH_EAST,
    SOUTH_WEST,
    Around,
    elevations,
    vertices,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Sheet:
    """The surface of one layer over exactly the compartments of its pillars.

    Attributes
    ----------
    grid : Grid
    compartment : ndarray of shape (n,), int64
        Ascending.
    top : ndarray of shape (n,), float64
        Elevations of the pillars: of the surface in the middle of each compartment, metres.
    corner : ndarray of shape (n, 4), float64
        Elevations of the surface at the corners, north-west, south-west, south-east, north-east; metres.
    vertex : ndarray of shape (n, 4), int64
        Equal where neighbours share a corner, in all sheets that were made together.
    east, south : ndarray of shape (e, 2), (s, 2), int64
        Steps to be closed by a riser: indices of the pillars west and east, north and south of it.
    """

    grid: Grid
    compartment: Integers
    top: Floats
    corner: Floats
    vertex: Integers
    east: Integers
    south: Integers


def sheets(grid: Grid, layers: Sequence[tuple[Integers, Floats]], link_step: float) -> list[Sheet]:
    """Make the surfaces of layers that were made from one step-field.

    Parameters
    ----------
    grid : Grid
    layers : sequence of tuple of ndarray
        Compartments, ascending, and elevations (metres) of each layer's pillars.
    link_step : float
        Greatest difference in elevation of two neighbours that continue each other, metres.

    Returns
    -------
    list of Sheet
        One a layer.
    """
    compartment = np.concatenate([np.zeros(0, np.int64), *(each for each, _ in layers)])
    top = np.concatenate([np.zeros(0), *(each for _, each in layers)])
    order = _order(compartment, top)
    around = Around.of(grid, compartment[order], top[order], link_step)
    vertex = vertices(around)
    corner = elevations(around, vertex)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    made, first = [], 0
    for own, tops in layers:
        at = place[first : first + len(own)]
        first += len(own)
        steps = (side.steps(around, at, vertex) for side in _sides(around))
        made.append(Sheet(grid, own, tops, corner[at], vertex[at], *steps))
    return made


def _order(compartment: Integers, top: Floats) -> Integers:
    """Return the order by compartment and elevation."""
    if len(compartment) < 2 or bool((np.diff(compartment) > 0).all()):
        return np.arange(len(compartment))
    order: Integers = np.argsort(compartment, kind="stable")  # layers are ascending runs: quickly merged
    is_next = np.diff(compartment[order]) > 0
    if bool((is_next | (np.diff(top[order]) >= 0)).all()):
        return order  # the lower layer is the lower one everywhere
    order = np.argsort(top, kind="stable")
    by_compartment: Integers = order[np.argsort(compartment[order], kind="stable")]
    return by_compartment


@dataclass(frozen=True, eq=False)
class _Side:
    """A side between two compartments: the linked neighbours over it, and the corners at its ends.

    Attributes
    ----------
    columns : int
        Of the grid.
    step : int
        How much greater the number of the compartment beyond is.
    there, back : ndarray of shape (P + 1,)
        Linked neighbours over it, one way and the other.
    ends, beyond : tuple of int
        The same two corners, as those of the compartment before and beyond it.
    """

    columns: int
    step: int
    there: Integers
    back: Integers
    ends: tuple[int, int]
    beyond: tuple[int, int]

    def steps(self, around: Around, layer: Integers, vertex: Integers) -> Integers:
        """Find neighbours of a layer whose surfaces part along the side; indices in it, shape (n, 2).

        The step stays open where a surface of other layers goes through it: a robot on that has to pass.
        """
        pairs = self._neighbours(around.compartment[layer])
        one, other = layer[pairs].T
        parts = np.zeros(len(pairs), bool)
        for end, far in zip(self.ends, self.beyond, strict=True):
            parts |= vertex[one, end] != vertex[other, far]
        pairs, one, other = pairs[parts], one[parts], other[parts]
        # Links over a side never cross, so those between two pillars are those below one less those below
        # the other; one that the lower of the two has is between them.
        through = self._below(around, other, self.back) - self._below(around, one, self.there)
        through = np.where(around.top[one] < around.top[other], through, -through)
        closed: Integers = pairs[(through <= 0) | (self.there[one] == other)]
        return closed

    def _neighbours(self, compartment: Integers) -> Integers:
        has_one = compartment % self.columns < self.columns - 1 if self.step == 1 else compartment >= 0
        one = np.flatnonzero(has_one)
        found: Integers = np.searchsorted(compartment, compartment[one] + self.step)
        found = np.minimum(found, len(compartment) - 1)
        is_there = compartment[found] == compartment[one] + self.step
        return np.column_stack([one[is_there], found[is_there]])

    def _below(self, around: Around, pillars: Integers, links: Integers) -> Integers:
        """Count the linked pillars beneath each of some in its compartment."""
        is_linked = links[:-1] < around.none
        before: Integers = np.cumsum(is_linked) - is_linked
        first = np.searchsorted(around.compartment, around.compartment[pillars])
        below: Integers = before[pillars] - before[first]
        return below


def _sides(around: Around) -> tuple[_Side, _Side]:
    columns = around.columns
    east, west = (NORTH_EAST, SOUTH_EAST), (NORTH_WEST, SOUTH_WEST)
    south, north = (SOUTH_EAST, SOUTH_WEST), (NORTH_EAST, NORTH_WEST)
    return (
        _Side(columns, 1, around.east, around.west, east, west),
        _Side(columns, columns, around.south, around.north, south, north),
    )
