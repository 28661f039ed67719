"""Fragments: small pieces that no link binds to anything go to the layer they lie nearest to.

Any layer that the pillars beneath and above them leave free costs as much. Taking the lowest would scatter
what a scanner saw of a shelf, a canopy or a slab in pieces over the layers of whatever is beneath it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.patches import Surroundings
from stepfield.layers.sheets import FRAGMENT

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Sides of the squares, in compartments, over which a layer's elevation near a fragment is averaged: the
#: smallest in which the layer is.
NEAR = (16, 64, 256)


def gathered(
    around: Surroundings, elevation: Floats, layer: Integers, layers: int, piece: Integers
) -> Integers:
    """Move fragments to the layers nearest in elevation.

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
    small = np.bincount(piece) < FRAGMENT
    small[piece[around.links[_is_cut(around.links, layer), 0]]] = False  # held in place by its seams
    among = np.flatnonzero(small[piece])
    if not len(among) or len(among) == len(layer):
        return layer
    near = _near(around, elevation, layer, layers, among, ~small[piece])
    away = np.abs(near - elevation[among, np.newaxis])
    _, member = np.unique(piece[among], return_inverse=True)
    cost = np.stack([np.bincount(member, column) for column in np.nan_to_num(away, nan=np.inf).T])
    wished = np.argmin(cost, axis=0)
    return _moved(around, layer, layers, among, member, wished)


def _is_cut(links: Integers, layer: Integers) -> Mask:
    cut: Mask = layer[links[:, 0]] != layer[links[:, 1]]
    return cut


def _near(
    around: Surroundings, elevation: Floats, layer: Integers, layers: int, among: Integers, firm: Mask
) -> Floats:
    """Average elevation of the firm pillars of each layer near each fragment, shape (n, layers); or NaN."""
    near = np.full((len(among), layers), np.nan)
    for side in (*NEAR, None):
        if side is None:
            square = np.zeros(len(layer), np.int64)
        else:
            across = int(around.column.max()) // side + 1
            square = around.row // side * across + around.column // side
        place = square * layers + layer
        size = (int(square.max()) + 1) * layers
        members = np.bincount(place[firm], minlength=size)
        sums = np.bincount(place[firm], elevation[firm], minlength=size)
        averages = np.divide(sums, members, out=np.full(size, np.nan), where=members > 0)
        found = averages.reshape(-1, layers)[square[among]]
        np.copyto(near, found, where=np.isnan(near))
    return near


def _moved(
    around: Surroundings, layer: Integers, layers: int, among: Integers, member: Integers, wished: Integers
) -> Integers:
    """Move fragments as near to their wishes as their neighbours above and below allow, up first."""
    layer = layer.copy()
    number = np.full(len(layer), -1)
    number[among] = member
    below, above = around.stacked
    for moving, barrier, way in ((below, above, 1), (above, below, -1)):
        held = number[moving] >= 0
        who, wall = number[moving[held]], barrier[held]
        for _ in range(layers):
            # Whatever moves the same way only makes room, so all can move at once.
            limit = np.full(len(wished), layers - 1 if way > 0 else 0)
            nearest = np.minimum if way > 0 else np.maximum
            nearest.at(limit, who, layer[wall] - way)
            goal = nearest(wished, limit)[member]
            ahead = (goal - layer[among]) * way > 0
            if not ahead.any():
                break
            layer[among[ahead]] = goal[ahead]
    return layer
