"""What the layers panel tells of a layer."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

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
    vertical : int
        Pillars that are walls or columns.
    is_obstacles : bool
        Whether it is a layer of them alone.
    """

    index: int
    name: str
    pillars: int
    elevation: float
    vertical: int = 0
    is_obstacles: bool = False


def summaries(result: Reconstruction) -> tuple[LayerSummary, ...]:
    """Summarise the layers, the lowest first, Unassigned last."""
    lowest, total, vertical = result.field.compartments.lowest, len(result.field), result.field.vertical
    layers = [
        LayerSummary(
            layer.index,
            layer.name,
            len(layer.pillars),
            float(layer.elevation.mean()) + lowest if len(layer.pillars) else math.nan,
            int(np.count_nonzero(vertical[layer.pillars])),
            layer.is_obstacles,
        )
        for layer in result.layers
    ]
    rest = total - sum(layer.pillars for layer in layers)
    return (*layers, LayerSummary(UNASSIGNED, REST, rest, math.nan))
