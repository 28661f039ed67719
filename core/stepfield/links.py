"""Links between neighbouring pillars and the seams where a layering cuts them.

Two pillars in compartments that share a side are linked when each is the other's nearest in elevation and
they differ by no more than the link step. A seam is a link whose two pillars are in different layers: there
the surfaces of the simulator have a hole (paper section 6, figure 4).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import Layering
from stepfield.pillars import StepField

Integers = NDArray[np.int64]


def link(field: StepField, taking_part: NDArray[np.bool_], link_step: float) -> Integers:
    """Find the linked pairs among the pillars that take part.

    Parameters
    ----------
    field : StepField
    taking_part : ndarray of shape (P,), bool
    link_step : float
        Greatest difference in elevation, metres.

    Returns
    -------
    ndarray of shape (L, 2), int64
        Pillar indices: west and east, then north and south.
    """
    chosen = np.flatnonzero(taking_part)
    compartment = field.compartment[chosen]
    grid = field.compartments.grid
    _, column = grid.row_column(compartment)
    east = np.where(column < grid.columns - 1, compartment + 1, -1)
    south = np.where(compartment < len(grid) - grid.columns, compartment + grid.columns, -1)
    west = np.where(column > 0, compartment - 1, -1)
    north = compartment - grid.columns
    elevation = field.elevation[chosen]
    pairs = []
    for there, back in ((east, west), (south, north)):
        to = _nearest(compartment, elevation, there)
        fro = _nearest(compartment, elevation, back)
        ahead = np.flatnonzero(to >= 0)
        mutual = ahead[fro[to[ahead]] == ahead]
        close = mutual[np.abs(elevation[mutual] - elevation[to[mutual]]) <= link_step * (1 + 1e-12)]
        pairs.append(np.column_stack([chosen[close], chosen[to[close]]]))
    return np.vstack(pairs)


def seams(links: Integers, layering: Layering) -> Integers:
    """Return the links whose two pillars are in different layers, shape (S, 2)."""
    layer = layering.layer[links]
    cut: Integers = links[(layer[:, 0] != layer[:, 1]) & (layer >= 0).all(axis=1)]
    return cut


def _nearest(compartment: Integers, elevation: NDArray[np.float64], neighbour: Integers) -> Integers:
    """Index of the pillar of ``neighbour`` nearest in elevation, ties to the lower; -1 for none."""
    first = np.searchsorted(compartment, neighbour)
    last = np.searchsorted(compartment, neighbour, side="right")
    nearest = np.where(first < last, first, -1)
    seeker = np.flatnonzero(first < last)
    least = np.abs(elevation[seeker] - elevation[first[seeker]])
    step = 1
    while True:
        further = first[seeker] + step < last[seeker]
        seeker, least = seeker[further], least[further]
        if not len(seeker):
            return nearest
        candidate = first[seeker] + step
        distance = np.abs(elevation[seeker] - elevation[candidate])
        closer = distance < least
        nearest[seeker[closer]] = candidate[closer]
        least = np.minimum(least, distance)
        step += 1
