"""Loose pieces: surfaces that nothing binds to a layer go to the one they lie nearest to.

A table over a floor that was not seen, a canopy, a slab seen in scraps: any layer that the pillars beneath
and above leave free costs as few seams. Each goes to the layer whose surfaces nearby have its elevation, as
the paper's classification does with every pillar (5.3.3): round after round, until nothing changes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.patches import FRAGMENT, Surroundings

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Sides of the squares, in compartments, over which a layer's elevation near a piece is averaged: the
#: smallest in which the layer is; at last the whole grid.
NEAR = (16, 64, 256)
MOST_ROUNDS = 4


def gathered(
    around: Surroundings, elevation: Floats, layer: Integers, layers: int, piece: Integers
) -> Integers:
    """Move loose pieces to the layers nearest in elevation.

    Parameters
    ----------
    around : Surroundings
    elevation : ndarray of shape (M,)
        Metres.
    layer : ndarray of shape (M,), int64
    layers : int
    piece : ndarray of shape (M,), int64
        Which connected piece each pillar belongs to, whatever cuts it.

    Returns
    -------
    ndarray of shape (M,), int64
    """
    one, other = around.links.T
    loose = np.ones(int(piece.max()) + 1, bool)
    loose[piece[one[layer[one] != layer[other]]]] = False
    low, high = _bounds(around, layers, piece)
    loose &= low < high
    if not loose.any():
        return layer
    firm = np.bincount(piece) >= FRAGMENT
    patchwork = _Patchwork.of(around, elevation, layer, piece)
    own = np.zeros(len(loose), np.int64)
    own[piece] = layer  # right for loose pieces, which are in one layer
    anchors = firm & ~loose
    for _ in range(MOST_ROUNDS):
        wished = patchwork.nearest(np.where(loose, own, -1), layers, anchors)
        moved = _moved(around, layer, layers, piece, np.where(loose, wished, own), loose)
        if np.array_equal(moved, layer):
            break
        own[piece] = layer = moved
        anchors = firm
    return layer


def _bounds(around: Surroundings, layers: int, piece: Integers) -> tuple[Integers, Integers]:
    """Lowest and highest layer of each piece that the pillars beneath and above its own leave free."""
    first = np.flatnonzero(np.diff(around.tower, prepend=-1))
    size = np.diff(np.append(first, len(around)))
    rank = np.arange(len(around)) - np.repeat(first, size)
    low, above = np.zeros((2, int(piece.max()) + 1), np.int64)
    np.maximum.at(low, piece, rank)
    np.maximum.at(above, piece, np.repeat(size, size) - 1 - rank)
    return low, layers - 1 - above


@dataclass(frozen=True, eq=False)
class _Patchwork:
    """Pieces cut along squares of the plan and by layers, and what is in each of these cuttings."""

    piece: Integers  # (C,) of each cutting
    layer: Integers  # (C,) of its pillars, before any piece moves
    squares: tuple[Integers, ...]  # (C,) where it is, the small squares first; the last is the whole grid
    members: Floats  # (C,) pillars
    sums: Floats  # (C,) of their elevations

    @classmethod
    def of(cls, around: Surroundings, elevation: Floats, layer: Integers, piece: Integers) -> _Patchwork:
        across = int(around.column.max()) // NEAR[0] + 1
        square = around.row // NEAR[0] * across + around.column // NEAR[0]
        key = (piece * (int(layer.max()) + 1) + layer) * (int(square.max()) + 1) + square
        _, first, cutting = np.unique(key, return_index=True, return_inverse=True)
        row, column = around.row[first], around.column[first]
        squares = [row // side * (int(column.max()) // side + 1) + column // side for side in NEAR]
        return cls(
            piece[first],
            layer[first],
            (*squares, np.zeros(len(first), np.int64)),
            np.bincount(cutting).astype(np.float64),
            np.bincount(cutting, elevation).astype(np.float64),
        )

    def nearest(self, own: Integers, layers: int, anchors: Mask) -> Integers:
        """Return the layer nearest to each piece, or its own where that has no other anchor.

        Parameters
        ----------
        own : ndarray of shape (pieces,)
            Present layer of each loose piece; -1 for others, which are where they were.
        layers : int
        anchors : ndarray of shape (pieces,), bool
            Pieces that make out where layers are.
        """
        layer = np.where(own[self.piece] >= 0, own[self.piece], self.layer)
        near = np.full((len(self.piece), layers), np.nan)
        for square in self.squares:
            others = self._averages(square, layer, layers, anchors[self.piece])
            np.copyto(near, others, where=np.isnan(near))
        mean = self.sums / self.members
        away = np.abs(near - mean[:, np.newaxis]) * self.members[:, np.newaxis]
        cost = np.stack([np.bincount(self.piece, column, len(own)) for column in away.T], axis=1)
        cost[np.isnan(cost)] = np.inf
        stays = np.isinf(cost[np.arange(len(own)), own])
        return np.where(stays, own, np.argmin(cost, axis=1))

    def _averages(self, square: Integers, layer: Integers, layers: int, anchored: Mask) -> Floats:
        """Average elevation of each layer's other pieces in each cutting's square, shape (C, layers)."""
        count = int(square.max()) + 1
        where = square[anchored] * layers + layer[anchored]
        members, sums = (
            np.bincount(where, of[anchored], count * layers).astype(np.float64).reshape(-1, layers)[square]
            for of in (self.members, self.sums)
        )
        # Less what the piece adds itself, in all its cuttings of the same square and layer.
        _, group = np.unique((self.piece * count + square) * layers + layer, return_inverse=True)
        mine = np.flatnonzero(anchored)
        members[mine, layer[mine]] -= np.bincount(group, self.members)[group[mine]]
        sums[mine, layer[mine]] -= np.bincount(group, self.sums)[group[mine]]
        averages: Floats = np.divide(sums, members, out=np.full(members.shape, np.nan), where=members > 0.5)
        return averages


def _moved(
    around: Surroundings, layer: Integers, layers: int, piece: Integers, wished: Integers, loose: Mask
) -> Integers:
    """Move loose pieces as near to their wishes as their neighbours above and below allow, up first."""
    layer = layer.copy()
    below, above = around.stacked
    among = np.flatnonzero(loose[piece])
    member = piece[among]
    for moving, barrier, way in ((below, above, 1), (above, below, -1)):
        held = loose[piece[moving]]
        who, wall = piece[moving[held]], barrier[held]
        nearest = np.minimum if way > 0 else np.maximum
        for _ in range(layers):
            # Whatever moves the same way only makes room, so all can move at once.
            limit = np.full(len(wished), layers - 1 if way > 0 else 0)
            nearest.at(limit, who, layer[wall] - way)
            goal = nearest(wished, limit)[member]
            ahead = (goal - layer[among]) * way > 0
            if not ahead.any():
                break
            layer[among[ahead]] = goal[ahead]
    return layer
