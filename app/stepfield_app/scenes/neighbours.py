"""What stands around a block: which walls it hides and how much light it takes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from stepfield_app.scenes.stacks import Stack

Singles = NDArray[np.float32]

#: Row and column steps to the neighbours: the sides first, then the corners.
SIDES = ((-1, 0), (0, 1), (1, 0), (0, -1))
CORNERS = ((-1, 1), (1, 1), (1, -1), (-1, -1))
NORTH, EAST, SOUTH, WEST, NORTH_EAST, SOUTH_EAST, SOUTH_WEST, NORTH_WEST = range(8)

#: A block of the same layer shades what lies this share of a cell below its bottom, or higher.
REACH = 0.5


class Surroundings:
    """Heights of the eight neighbours of every block of a stack.

    They are the columns on the base plane, of whichever layer, and the blocks of its own layer.

    Attributes
    ----------
    bottom, top : ndarray of shape (n,), float32
        Of the blocks themselves.
    column : ndarray of shape (8, n), float32
        Top of the neighbouring column; -inf where there is none.
    low, high : ndarray of shape (8, n), float32
        Of the neighbouring block of the same layer; inf and -inf where there is none.
    """

    def __init__(self, stack: Stack) -> None:
        self.cell_size = stack.lattice.cell_size
        self.bottom, self.top = stack.bottom.astype(np.float32), stack.top.astype(np.float32)
        rows, columns = stack.lattice.shape
        row, column = np.divmod(stack.compartment, columns)
        # A free compartment on every side spares asking who stands at the edge.
        place, wide = (row + 1) * (columns + 2) + column + 1, columns + 2
        around = [place + down * wide + right for down, right in SIDES + CORNERS]
        free = (rows + 2) * wide
        self.column = self._columns(stack, place, around, free)
        self.low, self.high = self._own_layer(stack, place, around, free)

    def _columns(
        self, stack: Stack, place: NDArray[np.int64], around: list[NDArray[np.int64]], free: int
    ) -> Singles:
        tops = np.full(free, -np.inf, np.float32)
        np.maximum.at(tops, place[stack.standing], self.top[stack.standing])
        return np.stack([tops[there] for there in around])

    def _own_layer(
        self, stack: Stack, place: NDArray[np.int64], around: list[NDArray[np.int64]], free: int
    ) -> tuple[Singles, Singles]:
        low, high = (np.empty((8, len(stack)), np.float32) for _ in range(2))
        lows, highs = np.full(free, np.inf, np.float32), np.full(free, -np.inf, np.float32)
        cuts = np.flatnonzero(np.diff(stack.layer, prepend=-2, append=-2))
        for part in (slice(a, b) for a, b in pairwise(cuts)):
            lows[place[part]], highs[place[part]] = self.bottom[part], self.top[part]
            for k, there in enumerate(around):
                low[k, part], high[k, part] = lows[there[part]], highs[there[part]]
            lows[place[part]], highs[place[part]] = np.inf, -np.inf
        return low, high

    def wall(self, side: int) -> tuple[Singles, Singles]:
        """Foot and head of what the neighbour on a side leaves to see; nothing where foot >= head."""
        low, high = self.low[side], self.high[side]
        foot = np.maximum(self.bottom, self.column[side])
        foot = np.where((low <= foot) & (high > foot), high, foot)
        head = np.where((high >= self.top) & (low < self.top), low, self.top)
        return foot, head

    def shadow(self) -> Singles:
        """How far each neighbour stands above a block's top, as a share of a cell, 0 to 1; shape (8, n)."""
        near = self.low <= self.top + REACH * self.cell_size
        higher = np.maximum(self.column, np.where(near, self.high, -np.inf))
        higher -= self.top
        higher *= np.float32(1 / self.cell_size)
        return np.clip(higher, 0, 1, out=higher)
