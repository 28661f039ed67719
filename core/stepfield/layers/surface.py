"""Classification by surface: a continuous surface stays in one layer, whatever elevations it crosses.

Not in the paper, which says where its classification fails (section 6, figure 4): an inclined plane falls
into as many layers as elevations it crosses, with a hole along every cut. Here neighbouring pillars that
continue each other are linked, and the layers are those that cut the fewest links: one pillar a compartment a
layer, in order of height. A ramp that winds over itself is cut where it would come to lie above itself.

The cuts are minimum cuts, found among patches of pillars (:mod:`patches`, :mod:`cuts`), adjusted so that
sheets stay whole (:mod:`sheets`), moved to the pillar in a band around them (:mod:`bands`); what nothing
binds then joins the layer it lies nearest to (:mod:`loose`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.layers.bands import refined
from stepfield.layers.cuts import UP, Ties, lowest, settled
from stepfield.layers.elevation import by_elevation
from stepfield.layers.loose import gathered
from stepfield.layers.patches import Surroundings, apart, between, bound, patches, pieces
from stepfield.layers.sheets import AWAY_A_SEAM, Votes, whole
from stepfield.layers.towers import Towers

Integers = NDArray[np.int64]

#: Rise by run of a gentle link, at most.
STEEPEST = 1 / 3
#: Pillars that are asked for their layer by elevation, about.
VOTERS = 100_000


def by_surface(grid: Grid, towers: Towers, links: Integers, layers: int) -> Integers:
    """Return the layer of each pillar that takes part, shape (M,).

    Parameters
    ----------
    grid : Grid
    towers : Towers
    links : ndarray of shape (L, 2), int64
        Pillars that continue each other, numbered among those that take part: all west and east ones, then
        all north and south ones, each ascending.
    layers : int
        No compartment has more pillars.
    """
    around = _surroundings(grid, towers, links)
    patch = patches(around, layers)
    piece = pieces(patch, links)
    patch = apart(around, patch, piece)
    ties, size = between(around, patch, links), np.bincount(patch)
    rise = np.abs(np.subtract(*towers.elevation[links].T))
    gentle = Ties(*bound(patch, links[rise <= STEEPEST * grid.cell_size]), ties.below, ties.above)
    fewest = settled(ties, lowest(len(size), ties.below, ties.above, layers), layers, (UP,))
    found = whole(ties, gentle, fewest, layers, size, _by_elevation(towers, layers, patch))
    wishes = found.by_elevation.of(patch), found.own.of(patch)
    layer = refined(around, found.layer[patch], layers, AWAY_A_SEAM, wishes)
    return gathered(around, towers.elevation, layer, layers, piece)


def _by_elevation(towers: Towers, layers: int, patch: Integers) -> Votes:
    """Ask the paper's classification, for as many pillars as tell what most are for."""
    few, where = towers.every(max(1, len(patch) // VOTERS))
    return Votes(patch[where], by_elevation(few, layers).layer)


def _surroundings(grid: Grid, towers: Towers, links: Integers) -> Surroundings:
    row, column = grid.row_column(towers.compartment)
    tower = np.repeat(np.arange(len(towers.size)), towers.size)
    return Surroundings(row, column, tower, links, int(towers.size.max()))
