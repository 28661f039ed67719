"""Stray points before they are dropped: how many, and where."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.parameters import Parameters
from stepfield.progress import Progress, silent
from stepfield.scan import Scan, clean
from stepfield.scan.cleaning import isolated_points, sparse_points


@dataclass(frozen=True, eq=False)
class StrayQuestion:
    """Which points a filter would drop is asked.

    Attributes
    ----------
    scan : Scan
        As it was read.
    parameters : Parameters
        The rest of the cleaning; its own choice of outliers does not count.
    mode : str
        The filter to look at.
    """

    scan: Scan
    parameters: Parameters
    mode: Literal["radius", "isolated"]


@dataclass(frozen=True, eq=False)
class Stray:
    """What a filter would drop.

    Attributes
    ----------
    mode : str
    places : ndarray of shape (n, 3), float64
        Scan coordinates, metres.
    among : int
        Points the filter would look at.
    """

    mode: str
    places: NDArray[np.float64]
    among: int

    def __len__(self) -> int:
        return len(self.places)


def find_stray(question: StrayQuestion, progress: Progress = silent) -> Stray:
    """Find the points a filter would drop; the work of a thread of its own, as millions take their time."""
    others = question.parameters.model_copy(update={"outliers": "off"})
    scan = clean(question.scan, others, progress)
    progress(0.1, "looking for outliers")
    find = {"radius": sparse_points, "isolated": isolated_points}[question.mode]
    places = scan.points(np.flatnonzero(find(scan)))
    places.flags.writeable = False
    return Stray(question.mode, places, len(scan))
