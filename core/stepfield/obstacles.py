"""Layers of obstacles: walls and columns taken out of the surfaces, so that none is a pit or a tower there.

The other pillars are classified as if there were no walls; where a wall stood the surface has a hole. The
walls follow in layers of their own, as many as the most that stand above each other in a compartment,
from the lowest up, and have the last numbers. The operator's cap holds for surfaces and for obstacles, each
apart.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from stepfield.layers import Layering, Method, classify, layer_count, strongest
from stepfield.layers.classify import Linked
from stepfield.pillars import StepField


def classify_apart(
    field: StepField,
    method: Method = "elevation",
    *,
    linked: Linked | None = None,
    min_points: int = 1,
    max_layers: int | Literal["auto", "none"] = "auto",
) -> Layering:
    """Give every pillar its layer, vertical ones in layers of obstacles.

    Parameters
    ----------
    field : StepField
    method, linked, min_points, max_layers
        As in :func:`stepfield.layers.classify`.
    """
    surfaces = classify(
        field,
        method,
        linked=linked,
        min_points=min_points,
        max_layers=max_layers,
        leaving_out=field.vertical,
    )
    enough = field.vertical & (field.points >= min_points)
    count = layer_count(field, enough, max_layers)
    walls = strongest(field, enough, count)
    first = np.flatnonzero(np.diff(field.compartment[walls], prepend=-1))
    above = np.arange(len(walls)) - np.repeat(first, np.diff(np.append(first, len(walls))))
    layer = surfaces.layer.copy()
    layer[walls] = surfaces.count + above
    layer.flags.writeable = False
    numbers = tuple(range(surfaces.count, surfaces.count + count))
    return replace(surfaces, layer=layer, count=surfaces.count + count, obstacles=numbers)
