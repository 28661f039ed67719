"""Selected pillars of one result, counted, and how they follow to another result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield.selecting import Mask, at_places, places
from stepfield_app.scenes.arrays import frozen


@dataclass(frozen=True, eq=False)
class Selected:
    """Selected pillars of one result.

    Attributes
    ----------
    result : Reconstruction
    mask : ndarray of shape (P,), bool
        Read-only.
    by_layer : mapping of int to int
        How many of each layer that has any, -1 for Unassigned.
    places : ndarray of shape (n, 6), optional
        Where they were when they were selected, if that was in another step-field: pillars that the present
        one has lost come back with a later one.
    """

    result: Reconstruction
    mask: Mask
    by_layer: Mapping[int, int]
    places: NDArray[np.float64] | None = None

    @classmethod
    def of(cls, result: Reconstruction, mask: Mask, places: NDArray[np.float64] | None = None) -> Selected:
        """Count the pillars of a mask."""
        counts = np.bincount(result.layering.layer[mask] + 1).tolist()
        return cls(
            result, frozen(mask), {layer - 1: count for layer, count in enumerate(counts) if count}, places
        )

    @property
    def count(self) -> int:
        """How many there are."""
        return sum(self.by_layer.values())

    @property
    def is_empty(self) -> bool:
        """Whether nothing was selected, rather than lost."""
        return not self.by_layer and self.places is None

    def over(self, result: Reconstruction) -> Selected:
        """Return the same selection over another result."""
        if result is self.result:
            return self
        if result.field is self.result.field:
            return Selected.of(result, self.mask, self.places)
        boxes = places(self.result, self.mask) if self.places is None else self.places
        return Selected.of(result, at_places(result, boxes), boxes)
