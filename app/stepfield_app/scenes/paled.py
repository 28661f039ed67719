"""What was filled, in a colour that nothing measured has: nobody is to take it for a part of the scan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Layer, Reconstruction
from stepfield_app.theme import FILLED_COLOUR, rgb

Bytes = NDArray[np.uint8]
Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]

#: How much what was filled has of a colour that is far from all that heights have, lit or in shadow.
PALE = 0.65


def paled(colours: Bytes) -> Bytes:
    """Mix colours with that of what was filled; of the same shape (..., 3)."""
    mixed: Bytes = np.rint(colours * (1 - PALE) + np.array(rgb(FILLED_COLOUR)) * PALE).astype(np.uint8)
    return mixed


def on_filled(result: Reconstruction, layer: Layer, places: Floats) -> Flags:
    """Tell which places, shape (n, 2) in scan coordinates, are in holes of a layer that were filled."""
    grid = result.field.compartments.grid
    is_filled = np.zeros(len(grid), bool)
    is_filled[layer.filled.compartment] = True
    east, north = (places - [grid.west, grid.south]).T
    found: Flags = is_filled[grid.compartment(east, north)]
    return found
