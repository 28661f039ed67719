"""Suspicious pillars from above: which compartments of a layer to mark, and with what."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield.suspects import CLOSE, ISOLATED, SEAMS
from stepfield_app.scenes.arrays import frozen

#: The kinds in the order they are marked where a pillar is of several: the most telling last.
ORDER = (ISOLATED, CLOSE, SEAMS)


@dataclass(frozen=True, eq=False)
class Cells:
    """Marked compartments.

    Attributes
    ----------
    west, north : ndarray of shape (n,), float64
        Their corners, scan coordinates, metres.
    kind : ndarray of shape (n,), uint8
        Places in :data:`ORDER`.
    cell_size : float
        Metres.
    """

    west: NDArray[np.float64]
    north: NDArray[np.float64]
    kind: NDArray[np.uint8]
    cell_size: float


def cells(
    result: Reconstruction, masks: Mapping[str, NDArray[np.bool_]], kinds: Collection[str], layer: int
) -> Cells:
    """Find the compartments to mark in the map of a layer.

    Parameters
    ----------
    result : Reconstruction
    masks : mapping of str to ndarray of shape (P,), bool
        Suspicious pillars by kind.
    kinds : collection of str
        Those to mark.
    layer : int
    """
    field = result.field
    code = np.full(len(field), len(ORDER), np.uint8)
    for number, kind in enumerate(ORDER):
        if kind in kinds:
            code[masks[kind]] = number
    chosen = np.flatnonzero((code < len(ORDER)) & (result.layering.layer == layer))
    squares = field.compartments.grid.squares(field.compartment[chosen])
    cell_size = field.compartments.grid.cell_size
    return Cells(frozen(squares[:, 0].copy()), frozen(squares[:, 3].copy()), frozen(code[chosen]), cell_size)
