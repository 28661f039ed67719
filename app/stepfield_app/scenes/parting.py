"""A layer that is to be parted at an elevation: how its pillars spread, and how many lie on each side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield_app.scenes.arrays import frozen

Floats = NDArray[np.float64]

BINS = 96
#: Metres by which the range of a flat layer is widened.
FLAT = 0.01


@dataclass(frozen=True, eq=False)
class Parting:
    """Pillars of a layer by elevation.

    Attributes
    ----------
    elevation : ndarray of shape (n,), float64
        Of each pillar, scan coordinates, metres.
    edges : ndarray of shape (BINS + 1,), float64
    counts : ndarray of shape (BINS,), int64
        Pillars between the edges.
    """

    elevation: Floats
    edges: Floats
    counts: NDArray[np.int64]

    @property
    def low(self) -> float:
        """Where the histogram begins, metres."""
        return float(self.edges[0])

    @property
    def high(self) -> float:
        """Where it ends, metres."""
        return float(self.edges[-1])

    def above(self, elevation: float) -> int:
        """How many pillars lie above an elevation."""
        return int(np.count_nonzero(self.elevation > elevation))

    def suggested(self) -> float:
        """Elevation that parts the layer best: least spread within both parts (Otsu), amid the gap."""
        counts, middles = self.counts.astype(np.float64), (self.edges[1:] + self.edges[:-1]) / 2
        below, above = np.cumsum(counts)[:-1], np.cumsum(counts[::-1])[::-1][1:]
        if not (np.minimum(below, above) > 0).any():
            return (self.low + self.high) / 2
        moment = np.cumsum(counts * middles)
        with np.errstate(invalid="ignore", divide="ignore"):
            apart = np.square(moment[:-1] / below - (moment[-1] - moment[:-1]) / above)
        between = np.nan_to_num(below * above * apart)
        best = np.flatnonzero(between >= between.max() * (1 - 1e-9))
        return float((self.edges[best[0] + 1] + self.edges[best[-1] + 1]) / 2)


def parting(result: Reconstruction, layer: int) -> Parting:
    """Look at a layer that is to be parted."""
    elevation = result.layers[layer].elevation + result.field.compartments.lowest
    low, high = (float(elevation.min()), float(elevation.max())) if len(elevation) else (0.0, 0.0)
    if high - low < FLAT:
        low, high = low - FLAT / 2, high + FLAT / 2
    counts, edges = np.histogram(elevation, BINS, (low, high))
    return Parting(frozen(elevation), frozen(edges), frozen(counts))
