"""Are the clearance maps of a stack true: against the layers above, as far as images can tell."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from stepfield.stack.entries import ClearanceEntry, LayerEntry
from stepfield.stack.read import Stack

Floats = NDArray[np.float64]


def clearance_faults(stack: Stack, layer: LayerEntry) -> Iterator[str]:
    """Say what is wrong with the map of the room above a layer, one sentence each."""
    room, entry = stack.clearances(layer), layer.clearance
    gray = stack.clearance_gray(layer)
    if room is None or gray is None or entry is None:
        return
    if wrong := np.count_nonzero((gray > 0) & ~stack.mask(layer)):
        yield f"{entry.image}: {wrong} pixels have room above where {layer.mask} has no pillar"
    yield from _said_faults(entry, room[np.isfinite(room)])
    if stack.manifest.complex is not None:
        return  # what hangs above may be in the mesh
    above = _next_above(stack, layer)
    if wrong := np.count_nonzero(np.isfinite(room) != np.isfinite(above)):
        yield f"{entry.image}: {wrong} pixels disagree with the layers on whether something is above"
    slack = entry.scale + max(each.scale for each in stack.manifest.layers)
    if wrong := np.count_nonzero(room[np.isfinite(room)] > above[np.isfinite(room)] + slack):
        yield f"{entry.image}: {wrong} pixels have more room than there is below the next layer"


def _said_faults(entry: ClearanceEntry, room: Floats) -> Iterator[str]:
    if len(room) != entry.pillars:
        yield f"{entry.image}: {len(room)} pixels where the manifest says {entry.pillars} pillars"
    elif len(room):
        for name, found, said in (
            ("least", room.min(), entry.least),
            ("greatest", room.max(), entry.greatest),
        ):
            if said is None or abs(found - said) > entry.scale * (1 + 1e-9):
                yield f"{entry.image}: the {name} room is {found:g} m where the manifest says {said} m"


def _next_above(stack: Stack, layer: LayerEntry) -> Floats:
    """How far up the next pillar of any layer ends, shape (rows, columns); infinite where none is."""
    own = stack.elevations(layer)
    nearest = np.full(own.shape, np.inf)
    for other in stack.manifest.layers:
        if other.index != layer.index:
            up = stack.elevations(other) - own
            np.copyto(nearest, up, where=(up > 0) & (up < nearest))
    return nearest
