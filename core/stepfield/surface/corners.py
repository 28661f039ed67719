"""The corners of compartments: averages of the pillars that touch them and continue each other (6).

At most four compartments meet at a corner of the grid, each with several pillars. Those that are linked
around the corner are one continuous surface there and share its vertex, whichever layers they are in; all
others have vertices of their own, so that a cliff stays a cliff. Where fewer than four share one, the surface
ends, and goes on to its rim as it comes there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.links import linked

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Corners of a compartment, counter-clockwise seen from above.
NORTH_WEST, SOUTH_WEST, SOUTH_EAST, NORTH_EAST = range(4)
#: Which of the sides west, east, south, north meet in each of them.
_SIDES = (0, 3), (0, 2), (1, 2), (1, 3)


@dataclass(frozen=True, eq=False)
class Around:
    """Linked neighbours of pillars in order of compartment and elevation; the last place stands for none.

    Attributes
    ----------
    columns : int
    compartment : ndarray of shape (P,)
    top : ndarray of shape (P,)
    east, west, south, north : ndarray of shape (P + 1,)
        Indices of pillars, P for none.
    """

    columns: int
    compartment: Integers
    top: Floats
    east: Integers
    west: Integers
    south: Integers
    north: Integers

    @classmethod
    def of(cls, grid: Grid, compartment: Integers, top: Floats, link_step: float) -> Around:
        """Link pillars that are in order of compartment and elevation."""
        none = len(top)
        sides = []
        for pairs in linked(grid, compartment, top - top.min(initial=np.inf), link_step):
            there, back = np.full(none + 1, none), np.full(none + 1, none)
            there[pairs[:, 0]], back[pairs[:, 1]] = pairs[:, 1], pairs[:, 0]
            sides += [there, back]
        return cls(grid.columns, compartment, top, *sides)

    @property
    def none(self) -> int:
        """The index that stands for no pillar."""
        return len(self.top)


def vertices(around: Around) -> Integers:
    """Number the vertices, shape (P, 4): around a corner, linked pillars have one and the same.

    Going round the corner from its north-west compartment counter-clockwise, a pillar takes the number of
    the one before it if they are linked. The link that closes the round joins what is left, unless the
    surface winds upwards around the corner and would meet itself above or below.
    """
    size = around.none + 1
    own = np.arange(4 * size).reshape(4, size)  # at the corner's NW, SW, SE, NE compartment
    number = own.copy()
    for place, before in ((1, around.north), (2, around.west), (3, around.south)):
        number[place] = np.where(before < around.none, number[place - 1][before], own[place])
    last = own[0]  # where the round ends that starts in each north-west pillar
    for place, after in enumerate((around.south, around.east, around.north)):
        pillar = after[np.where(last >= place * size, last - place * size, around.none)]
        last = np.where(pillar < around.none, own[place + 1][pillar], last)
    start = np.flatnonzero(around.east[:-1] < around.none)
    joined = number[3][around.east[start]]
    fits = joined // size > last[start] // size
    merged = np.arange(4 * size)
    merged[joined[fits]] = start[fits]
    number = merged[number]
    # The corner that a pillar has to its south-east is the one whose north-west compartment it is in.
    return np.column_stack([number[place, :-1] for place in (2, 3, 0, 1)])


def elevations(around: Around, vertex: Integers) -> Floats:
    """Average the pillars that share each vertex; return it for every corner, shape (P, 4), metres.

    Where fewer than four do, they are not all around it: each counts as high as its slope is at the sides
    that nothing continues.
    """
    if not around.none:
        return np.zeros((0, 4))
    lowest = around.top.min()
    height = around.top - lowest
    pillars = np.bincount(vertex.ravel())
    total = np.bincount(vertex.ravel(), np.repeat(height, 4))
    sharing = pillars[vertex]
    rises = _rises(around, height)
    for corner, (one, other) in enumerate(_SIDES):
        rim = np.flatnonzero(sharing[:, corner] < 4)
        np.add.at(total, vertex[rim, corner], rises[one, rim] + rises[other, rim])
    average: Floats = total[vertex] / sharing + lowest
    return average


def _rises(around: Around, height: Floats) -> Floats:
    """How far surfaces rise from the middles of pillars to their west, east, south and north sides, metres.

    Shape (4, P); 0 where they go on beyond the side. The slope is that of the two links before the rim: the
    gentler one, and level where they disagree, so that neither noise nor a step is carried on; half of that
    of one link, which no other confirms. So no side is further up or down than half the link step.
    """
    padded = np.append(height, 0.0)
    rises = np.zeros((4, around.none))
    there = (around.west, around.east, around.south, around.north)
    back = (around.east, around.west, around.north, around.south)
    for rise, outwards, inwards in zip(rises, there, back, strict=True):
        ends = np.flatnonzero((outwards[:-1] == around.none) & (inwards[:-1] < around.none))
        one = inwards[ends]
        two = inwards[one]
        last, before = padded[ends] - padded[one], padded[one] - padded[two]
        gentler = np.where(np.abs(before) < np.abs(last), before, last)
        slope = np.where(last * before > 0, gentler, 0)
        rise[ends] = np.where(two < around.none, slope, last / 2) / 2
    return rises
