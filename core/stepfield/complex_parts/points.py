"""The points of a scan again, pillar by pillar: compartments keep their elevations only."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.compartments import TICK_BITS
from stepfield.pillars import StepField
from stepfield.progress import Progress
from stepfield.scan import Scan

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Points handled at once; bounds the memory whatever the scan's size.
CHUNK = 1 << 19


@dataclass(frozen=True, eq=False)
class Owned:
    """Some points and their pillars.

    Attributes
    ----------
    places : ndarray of shape (n, 3), float64
        Metres east, north and up from the scan's lowest coordinates.
    pillar : ndarray of shape (n,), int64
    """

    places: Floats
    pillar: Integers


def owned_points(scan: Scan, field: StepField, progress: Progress) -> Iterator[Owned]:
    """Yield all points of the scan a step-field was made of, some at a time, with their pillars.

    Places and ticks are worked out as the compartments were, so that every point finds its own pillar.
    """
    compartments, bits = field.compartments, np.uint64(TICK_BITS)
    lowest = compartments.ticks[field.start[:-1]].astype(np.uint64)
    bottoms = field.compartment.astype(np.uint64) << bits | lowest
    measures = [axis.measure() for axis in scan.axes]
    for start in range(0, len(scan), CHUNK):
        progress(start / len(scan), "looking for complex parts")
        places = np.column_stack([measure(slice(start, start + CHUNK)) for measure in measures])
        key = compartments.grid.compartment(places[:, 0], places[:, 1]).astype(np.uint64) << bits
        key |= np.rint(places[:, 2] / compartments.tick).astype(np.uint64)
        yield Owned(places, np.searchsorted(bottoms, key, side="right") - 1)
