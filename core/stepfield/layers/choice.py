"""How many layers there are, and which pillars find a place in them (paper 5.3.2)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.pillars import StepField

Integers = NDArray[np.int64]

#: ``max_layers = auto`` never takes more layers than this ...
MOST_AUTOMATIC_LAYERS = 9
#: ... and leaves at most this share of the occupied compartments with more pillars than layers.
CROWDED_SHARE = 0.005


def layer_count(
    field: StepField, enough: NDArray[np.bool_], max_layers: int | Literal["auto", "none"]
) -> int:
    """Count the layers: the most pillars in a compartment (5.3.2), or what the operator's cap leaves."""
    held = _held(field, enough)
    most = int(held.max())
    if max_layers == "none":
        return most
    if max_layers != "auto":
        return min(most, max_layers)
    crowded = len(held) - np.cumsum(np.bincount(held))  # compartments that hold more than 0, 1, 2 ... pillars
    fits = np.flatnonzero(crowded < CROWDED_SHARE * np.count_nonzero(held))
    return min(int(fits[0]), most, MOST_AUTOMATIC_LAYERS) if len(fits) else most


def strongest(field: StepField, enough: NDArray[np.bool_], count: int) -> Integers:
    """Indices of the at most ``count`` pillars a compartment keeps: most points first, ties to the lower."""
    held = _held(field, enough)
    crowded = enough & np.repeat(held > count, np.diff(field.first))
    amid = np.flatnonzero(crowded)
    compartment = field.compartment[amid]
    order = np.lexsort((field.rank[amid], -field.points[amid], compartment))
    starts = np.flatnonzero(np.diff(compartment[order], prepend=-1))
    place = np.arange(len(order)) - np.repeat(starts, np.diff(np.append(starts, len(order))))
    chosen = enough & ~crowded
    chosen[amid[order[place < count]]] = True
    return np.flatnonzero(chosen)


def _held(field: StepField, enough: NDArray[np.bool_]) -> Integers:
    """Count the pillars with enough points in each occupied compartment."""
    if enough.all():
        return np.diff(field.first)
    held: Integers = np.add.reduceat(enough, field.first[:-1], dtype=np.int64)
    return held
