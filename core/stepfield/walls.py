"""Which pillars are walls: columns of points that run upwards, not surfaces that lie near each other.

The mean of a wall's points is the height of nothing. But a pillar that is higher than the tolerance need
not be a wall: a hillside climbs through a coarse compartment, and two floors closer than the tolerance are
one pillar. A pillar is *vertical* when its points run on for more than the tolerance, and for more than two
compartments: steeper than 63 degrees right across one. Points run on where the next one is no further up
than a compartment is wide; wider gaps, as between the two faces of a slab, do not count.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.compartments import Compartments

Integers = NDArray[np.int64]

#: Compartments that points must run upwards: more is steeper than any ground a robot takes.
STEEP = 2.0


def vertical(
    compartments: Compartments, start: Integers, layer_tolerance: float, share: float = 1.0
) -> NDArray[np.bool_]:
    """Tell which pillars are vertical.

    Parameters
    ----------
    compartments : Compartments
    start : ndarray of shape (P + 1,), int64
        Where each pillar's points begin.
    layer_tolerance : float
        Metres.
    share : float
        Of the scan's points that these are, in a preview: the next point up is as much further away.

    Returns
    -------
    ndarray of shape (P,), bool
    """
    cell = compartments.grid.cell_size
    least = max(layer_tolerance, STEEP * cell) / compartments.tick
    # A length of exactly so much is not more; the tiny share forgives the rounding of the division.
    least *= 1 + 1e-12
    ticks = compartments.ticks
    is_vertical: NDArray[np.bool_] = ticks[start[1:] - 1] - ticks[start[:-1]] > least
    if layer_tolerance > cell / share:  # else no gap within a pillar is too wide
        high = np.flatnonzero(is_vertical)
        is_vertical[high] = _run(compartments, start, high, cell / share) > least
    is_vertical.flags.writeable = False
    return is_vertical


def _run(compartments: Compartments, start: Integers, pillars: Integers, step: float) -> Integers:
    """Ticks that the points of some pillars run upwards: from end to end without the wide gaps."""
    ticks, parts = compartments.ticks, compartments.parts
    widest = int(min(step / compartments.tick * (1 + 1e-12), 2.0**32))
    gaps = np.where(parts.gap > np.uint64(widest), parts.gap, np.uint64(0)).astype(np.int64)
    below = np.append(0, np.cumsum(gaps))
    first, last = (np.searchsorted(parts.start, start[at]) for at in (pillars, pillars + 1))
    span = (ticks[start[pillars + 1] - 1] - ticks[start[pillars]]).astype(np.int64)
    run: Integers = span - (below[last] - below[first + 1])
    return run
