"""What is under the cursor: the compartment and its pillars."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepfield.reconstruction import Reconstruction


@dataclass(frozen=True)
class PillarAt:
    """A pillar of the compartment asked for.

    Attributes
    ----------
    pillar : int
        Index into the step-field.
    layer : int
        -1 for none.
    elevation, low, high : float
        Scan coordinates, metres.
    points : int
    is_vertical : bool
        Whether it is a wall or a column.
    """

    pillar: int
    layer: int
    elevation: float
    low: float
    high: float
    points: int
    is_vertical: bool = False


def compartment_at(result: Reconstruction, x: float, y: float) -> tuple[int, int] | None:
    """Row and column of the compartment at a place in scan coordinates, metres; None beside the grid."""
    grid = result.field.compartments.grid
    east, north = x - grid.west, y - grid.south
    width, depth = grid.columns * grid.cell_size, grid.rows * grid.cell_size
    if not (0 <= east <= width and 0 <= north <= depth):
        return None
    row, column = grid.row_column(grid.compartment(np.array([east]), np.array([north])))
    return int(row[0]), int(column[0])


def pillars_at(result: Reconstruction, x: float, y: float) -> tuple[PillarAt, ...]:
    """Return the pillars of the compartment at a place in scan coordinates, from the lowest up."""
    place, field = compartment_at(result, x, y), result.field
    if place is None:
        return ()
    occupied = field.compartments.occupied
    number = place[0] * field.compartments.grid.columns + place[1]
    at = int(np.searchsorted(occupied, number))
    if at == len(occupied) or occupied[at] != number:
        return ()
    return tuple(_row(result, pillar) for pillar in range(field.first[at], field.first[at + 1]))


def filled_at(result: Reconstruction, x: float, y: float) -> dict[int, float]:
    """Return the layers that were filled at a place in scan coordinates, and how high they were made."""
    place, cells = compartment_at(result, x, y), result.field.compartments
    if place is None:
        return {}
    number, found = place[0] * cells.grid.columns + place[1], {}
    for layer in result.layers:
        at = int(np.searchsorted(layer.filled.compartment, number))
        if at < len(layer.filled.compartment) and layer.filled.compartment[at] == number:
            found[layer.index] = float(layer.filled.elevation[at] + cells.lowest)
    return found


def _row(result: Reconstruction, pillar: int) -> PillarAt:
    field = result.field
    cells = field.compartments
    low, high = (int(cells.ticks[at]) for at in (field.start[pillar], field.start[pillar + 1] - 1))
    return PillarAt(
        pillar=int(pillar),
        layer=int(result.layering.layer[pillar]),
        elevation=float(field.elevation[pillar] + cells.lowest),
        low=low * cells.tick + cells.lowest,
        high=high * cells.tick + cells.lowest,
        points=int(field.start[pillar + 1] - field.start[pillar]),
        is_vertical=bool(field.vertical[pillar]),
    )
