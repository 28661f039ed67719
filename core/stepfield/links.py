"""Links between neighbouring pillars: which of them continue each other.

Two pillars in compartments that share a side are linked when each is the other's nearest in elevation and
they differ by no more than the link step. A link whose two pillars are in different layers is a seam: there
the surfaces of the simulator have a hole (paper section 6, figure 4).
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.pillars import StepField

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Stands for the compartment beyond the edge of the grid.
_NOWHERE = -1


@dataclass(frozen=True, eq=False)
class Links:
    """The linked pairs of a step-field, found when first asked for: most looks at a result need none.

    Attributes
    ----------
    field : StepField
    taking_part : ndarray of shape (P,), bool
    link_step : float
        Greatest difference in elevation, metres.
    """

    field: StepField
    taking_part: NDArray[np.bool_]
    link_step: float

    @cached_property
    def pairs(self) -> Integers:
        """As :func:`link` returns them; read-only."""
        pairs = link(self.field, self.taking_part, self.link_step)
        pairs.flags.writeable = False
        return pairs


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
    east, south = linked(
        field.compartments.grid, field.compartment[chosen], field.elevation[chosen], link_step
    )
    return chosen[np.vstack([east, south])]


def linked(
    grid: Grid, compartment: Integers, elevation: Floats, link_step: float
) -> tuple[Integers, Integers]:
    """Find the linked pairs of pillars that are ordered by compartment and elevation.

    Parameters
    ----------
    grid : Grid
    compartment : ndarray of shape (P,), int64
    elevation : ndarray of shape (P,), float64
        Metres above the lowest of them or something deeper.
    link_step : float
        Greatest difference in elevation, metres.

    Returns
    -------
    tuple of ndarray of shape (n, 2), int64
        Indices: west and east, then north and south.
    """
    _, column = grid.row_column(compartment)
    east = np.where(column < grid.columns - 1, compartment + 1, _NOWHERE)
    south = np.where(compartment < len(grid) - grid.columns, compartment + grid.columns, _NOWHERE)
    with ThreadPoolExecutor(2) as pool:
        pairs = list(pool.map(lambda there: _mutual(compartment, elevation, there, link_step), (east, south)))
    return pairs[0], pairs[1]


def _mutual(compartment: Integers, elevation: Floats, neighbour: Integers, link_step: float) -> Integers:
    """Pairs of a pillar and one of its neighbouring compartment that are each other's nearest.

    Pillars are ordered by compartment and elevation, so one search finds a pillar's two candidates; and it
    is the nearest of its partner exactly if neither the pillar below nor the one above it is nearer.
    """
    partner = _nearest(compartment, elevation, neighbour)
    seeker = np.flatnonzero(partner >= 0)
    found = partner[seeker]
    distance = np.abs(elevation[seeker] - elevation[found])
    close = distance <= link_step * (1 + 1e-12)
    seeker, found, distance = seeker[close], found[close], distance[close]
    last = len(compartment) - 1
    below, above = np.maximum(seeker - 1, 0), np.minimum(seeker + 1, last)
    rival_below = (below < seeker) & (compartment[below] == compartment[seeker])
    rival_above = (above > seeker) & (compartment[above] == compartment[seeker])
    nearest = ~(rival_below & (np.abs(elevation[below] - elevation[found]) <= distance))  # ties to the lower
    nearest &= ~(rival_above & (np.abs(elevation[above] - elevation[found]) < distance))
    return np.column_stack([seeker[nearest], found[nearest]])


def _nearest(compartment: Integers, elevation: Floats, neighbour: Integers) -> Integers:
    """Index of the pillar of ``neighbour`` nearest in elevation, ties to the lower; -1 for none."""
    if not len(compartment):
        return compartment
    # Whole steps of 2^-31 of the range: pillars of a compartment are further apart than that.
    steps = (elevation * ((2**31 - 1) / max(float(elevation.max()), 1e-30))).astype(np.int64)
    above = np.searchsorted(compartment << 32 | steps, neighbour << 32 | steps)
    below = above - 1
    above = np.minimum(above, len(compartment) - 1)
    fits_below = (compartment[below] == neighbour) & (below >= 0)
    fits_above = compartment[above] == neighbour
    nearer_above = np.abs(elevation[above] - elevation) < np.abs(elevation[below] - elevation)
    chosen = np.where(fits_above & (nearer_above | ~fits_below), above, below)
    chosen[~(fits_above | fits_below)] = -1
    return chosen
