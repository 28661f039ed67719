"""Seams put in their place to the pillar: what was cut between patches is cut again in a band around it.

The band is taken in pieces of a few thousand pillars, each with what surrounds it held fast: a minimum cut
takes more than twice as long for twice as many, and scipy holds up all other threads meanwhile. A second
pass divides a narrower band elsewhere, which mends what the first left where its pieces meet.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.cuts import Ties, Wishes, settled
from stepfield.layers.patches import Surroundings

Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Pillars of a piece, at most about.
PIECE = 3000
#: For each pass: compartments on either side of a seam that belong to the band, and where what is too
#: large is divided, at this share of its pillars.
PASSES = ((8, 0.5), (2, 0.3))


def refined(
    around: Surroundings, layer: Integers, layers: int, worth: int, wishes: Sequence[Wishes]
) -> Integers:
    """Move pillars near seams by cuts of least cost.

    Parameters
    ----------
    around : Surroundings
    layer : ndarray of shape (M,), int64
    layers : int
    worth : int
        What a seam costs.
    wishes : sequence of Wishes
        Of the pillars.

    Returns
    -------
    ndarray of shape (M,), int64
    """
    layer = layer.copy()
    for reach, share in PASSES:
        cut = layer[around.links[:, 0]] != layer[around.links[:, 1]]
        if not cut.any():
            break
        band = _band(around, around.links[cut].ravel(), reach)
        for piece, links in _pieces(around, band, share):
            nodes, ties, free = _surrounded(around, piece, links, worth)
            wished = [wish.of(nodes) for wish in wishes]
            layer[nodes] = settled(ties, layer[nodes], layers, wishes=wished, free=free)
    return layer


def _band(around: Surroundings, ends: Integers, reach: int) -> Integers:
    """Pillars of the compartments that lie within reach of those of some pillars, ascending."""
    rows, columns = int(around.row[-1]) + 1, int(around.column.max()) + 1
    near = np.zeros((rows + 2 * reach, columns + 2 * reach), bool)
    near[around.row[ends] + reach, around.column[ends] + reach] = True
    for axis in (0, 1):
        spread = near.copy()
        for shift in range(1, reach + 1):
            spread |= np.roll(near, shift, axis) | np.roll(near, -shift, axis)
        near = spread
    return np.flatnonzero(near[around.row + reach, around.column + reach])


def _pieces(around: Surroundings, band: Integers, share: float) -> Iterator[tuple[Integers, Integers]]:
    """Divide a band in pieces of whole compartments; give each one's pillars and the links that touch it."""
    pieces = list(_divided(around, band, share))
    number = np.full(len(around), -1, np.int32)
    for place, piece in enumerate(pieces):
        number[piece] = place
    one, other = (number[around.links[:, end]] for end in (0, 1))
    first, second = np.flatnonzero(one >= 0), np.flatnonzero((other >= 0) & (other != one))
    touching = np.concatenate([first, second])
    owner = np.concatenate([one[first], other[second]])
    order = np.argsort(owner, kind="stable")
    bounds = np.searchsorted(owner[order], np.arange(len(pieces) + 1))
    for place, piece in enumerate(pieces):
        yield piece, around.links[touching[order[bounds[place] : bounds[place + 1]]]]


def _divided(around: Surroundings, band: Integers, share: float) -> Iterator[Integers]:
    """Divide pillars by rows or columns, whichever they are more of, until no part is too large."""
    if len(band) <= PIECE:
        yield band
        return
    row, column = around.row[band], around.column[band]
    along = row if np.ptp(row) >= np.ptp(column) else column
    place = int(len(band) * share)
    before = along < max(np.partition(along, place)[place], along.min() + 1)
    if before.all():  # a single compartment
        yield band
        return
    yield from _divided(around, band[before], share)
    yield from _divided(around, band[~before], share)


def _surrounded(
    around: Surroundings, piece: Integers, links: Integers, worth: int
) -> tuple[Integers, Ties, Mask]:
    """Return the pillars of a piece and those linked to it, what binds them, and which of them may move."""
    nodes, ends = np.unique(np.concatenate([piece, links.ravel()]), return_inverse=True)
    free = np.zeros(len(nodes), bool)
    free[ends[: len(piece)]] = True
    one, other = ends[len(piece) :].reshape(-1, 2).T
    tower = around.tower[nodes]
    below = np.flatnonzero((tower[1:] == tower[:-1]) & free[1:] & free[:-1])
    return nodes, Ties(one, other, np.full(len(one), worth), below, below + 1), free
