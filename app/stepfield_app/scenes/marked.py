"""Selected pillars from above: which compartments hold any, in the layer shown or elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield_app.scenes.arrays import frozen

#: What a compartment holds: nothing selected, something in another layer only, something in the layer shown.
NOWHERE, ELSEWHERE, HERE = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Marked:
    """The rows of compartments around a selection.

    Attributes
    ----------
    west, north : float
        Corner of the first of them, scan coordinates, metres.
    cell_size : float
        Metres.
    cells : ndarray of shape (rows, columns), uint8
        :data:`NOWHERE`, :data:`ELSEWHERE` or :data:`HERE`; row 0 is north.
    """

    west: float
    north: float
    cell_size: float
    cells: NDArray[np.uint8]

    def has(self, x: float, y: float) -> bool:
        """Whether the compartment at a place, scan coordinates in metres, holds anything selected."""
        row, column = int((self.north - y) // self.cell_size), int((x - self.west) // self.cell_size)
        rows, columns = self.cells.shape
        return 0 <= row < rows and 0 <= column < columns and bool(self.cells[row, column])


def marked(result: Reconstruction, mask: NDArray[np.bool_], layer: int) -> Marked | None:
    """Find the compartments of selected pillars; None where nothing is selected.

    Parameters
    ----------
    result : Reconstruction
    mask : ndarray of shape (P,), bool
    layer : int
        The layer shown.
    """
    field = result.field
    grid, chosen = field.compartments.grid, np.flatnonzero(mask)
    if not len(chosen):
        return None
    compartment = field.compartment[chosen]  # in ascending order
    top, bottom = (int(end) // grid.columns for end in compartment[[0, -1]])
    cells = np.zeros((bottom + 1 - top) * grid.columns, np.uint8)
    compartment -= top * grid.columns
    cells[compartment] = ELSEWHERE
    cells[compartment[result.layering.layer[chosen] == layer]] = HERE
    north = grid.south + (grid.rows - top) * grid.cell_size
    return Marked(grid.west, north, grid.cell_size, frozen(cells.reshape(-1, grid.columns)))
