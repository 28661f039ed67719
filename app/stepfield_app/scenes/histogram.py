"""How the points of a scan spread over elevation, layer by layer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.pillars import StepField
from stepfield.reconstruction import Reconstruction
from stepfield_app.scenes.arrays import frozen, robust_range, sample

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Points that stand for all of them: beyond it, counts are estimates.
SAMPLE = 250_000
BINS = 128
#: Share of the points at either end that may lie beyond the bins, and room beside the others.
STRAYS, MARGIN = 0.001, 0.1


@dataclass(frozen=True, eq=False)
class Elevations:
    """Points by elevation.

    Attributes
    ----------
    edges : ndarray of shape (bins + 1,), float64
        Scan coordinates, metres, ascending.
    counts : ndarray of shape (layers + 1, bins), float64
        Points of each layer, lowest layer first, and Unassigned last; estimated from a sample when the
        scan is large.
    averages : ndarray of shape (layers,), float64
        Average elevation of each layer's pillars, scan coordinates, metres; NaN for an empty layer.
    exact : bool
        Whether every point was counted.
    """

    edges: Floats
    counts: Floats
    averages: Floats
    exact: bool

    @property
    def total(self) -> Floats:
        """Points of all layers together, shape (bins,)."""
        total: Floats = self.counts.sum(axis=0)
        return total


@dataclass(frozen=True, eq=False)
class Sample:
    """Some of a step-field's points: their bins, and the pillars they belong to, whatever layer those are in.

    Attributes
    ----------
    field : StepField
    edges : ndarray of shape (bins + 1,), float64
        Metres above the lowest point.
    column : ndarray of shape (n,), int64
        Points beyond the edges are in the bins at the ends.
    pillar : ndarray of shape (n,), int64
    each : float
        How many points one of them stands for.
    """

    field: StepField
    edges: Floats
    column: Integers
    pillar: Integers
    each: float

    @classmethod
    def of(cls, field: StepField, bins: int = BINS) -> Sample:
        """Draw a sample."""
        cells = field.compartments
        part = sample(len(cells.ticks), SAMPLE)
        distance = cells.ticks[part] * np.float64(cells.tick)
        edges = _edges(distance, bins)
        pillar = np.searchsorted(field.start, np.arange(0, len(cells.ticks), part.step), side="right") - 1
        place = (distance - edges[0]) * (bins / (edges[-1] - edges[0]))
        column = np.clip(place, 0, bins - 1).astype(np.int64)
        return cls(field, edges, column, pillar, len(cells.ticks) / len(distance))


def of_layers(result: Reconstruction, bins: int = BINS, known: Sample | None = None) -> Elevations:
    """Count the points of each layer, from the points sorted by compartment.

    Parameters
    ----------
    result : Reconstruction
    bins : int
    known : Sample, optional
        Of the step-field, drawn for an earlier result: edits move no points.
    """
    some = known or Sample.of(result.field, bins)
    layering, lowest = result.layering, result.field.compartments.lowest
    rows, bins = layering.count + 1, len(some.edges) - 1
    row = layering.layer[some.pillar] % rows  # Unassigned comes last
    counted = np.bincount(row * bins + some.column, minlength=rows * bins)
    counts = counted.reshape(rows, bins) * np.float64(some.each)
    averages = np.array([_average(layer.elevation) for layer in result.layers]) + lowest
    return Elevations(
        frozen(some.edges + lowest), frozen(counts), frozen(averages), exact=bool(some.each == 1)
    )


def _average(elevation: Floats) -> float:
    return float(elevation.mean()) if len(elevation) else np.nan


def _edges(distance: Floats, bins: int) -> Floats:
    """Bins over nearly all points: a few strays far above would leave everything else a handful of bins."""
    low, high = robust_range(distance, STRAYS)
    margin = MARGIN * (high - low)
    first, last = max(float(distance.min()), low - margin), min(float(distance.max()), high + margin)
    return np.linspace(first, last if last > first else first + 1e-3, bins + 1)
