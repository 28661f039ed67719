"""What the layers panel tells of a layer."""

from __future__ import annotations

import math
from dataclasses import dataclass

from stepfield.layers import UNASSIGNED
from stepfield.reconstruction import Reconstruction

#: What the pillars in no layer are called.
REST = "Unassigned"


@dataclass(frozen=True)
class LayerSummary:
    """A layer in figures.

    Attributes
    ----------
    index : int
        0 is the lowest; -1 is Unassigned.
    name : str
    pillars : int
    elevation : float
        Average, scan coordinates, metres; NaN without pillars.
    """

    index: int
    name: str
    pillars: int
    elevation: float


def summaries(result: Reconstruction) -> tuple[LayerSummary, ...]:
    """Summarise the layers, the lowest first, Unassigned last."""
    lowest, total = result.field.compartments.lowest, len(result.field)
    layers = [
        LayerSummary(
            layer.index,
            layer.name,
            len(layer.pillars),
            float(layer.elevation.mean()) + lowest if len(layer.pillars) else math.nan,
        )
        for layer in result.layers
    ]
    rest = total - sum(layer.pillars for layer in layers)
    return (*layers, LayerSummary(UNASSIGNED, REST, rest, math.nan))
