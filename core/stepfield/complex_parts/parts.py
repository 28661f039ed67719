"""What is known of the complex parts of a reconstruction, and what the height-maps are without them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Layer, Reconstruction
from stepfield.surface import Mesh

Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class ComplexParts:
    """Pillars that a mesh stands in for.

    Attributes
    ----------
    found : ndarray of shape (P,), bool
        Pillars whose points the height-maps are too far from.
    replaced : ndarray of shape (P,), bool
        Those of them that the mesh is nearer to: the height-maps have holes there.
    mesh : Mesh
        Scan coordinates, metres; reaches a compartment beyond what was found, so that no crack remains.
    """

    found: Flags
    replaced: Flags
    mesh: Mesh

    @property
    def count(self) -> int:
        """Number of pillars that the mesh stands in for."""
        return int(np.count_nonzero(self.replaced))


def without(result: Reconstruction, parts: ComplexParts) -> Reconstruction:
    """Return the reconstruction with holes where the mesh stands in for pillars."""
    return replace(result, layers=tuple(_without(layer, parts.replaced) for layer in result.layers))


def _without(layer: Layer, replaced: Flags) -> Layer:
    stays = ~replaced[layer.pillars]
    return replace(layer, pillars=layer.pillars[stays], elevation=layer.elevation[stays])
