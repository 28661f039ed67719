"""The grid of compartments (paper 5.1): the only place where metres become rows and columns."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.errors import GridError

#: More compartments than this are a mistake in the cell size, not a wish.
MOST_COMPARTMENTS = 2**27
#: Longest side, so that an image and its padding stay within what PNG readers take.
LONGEST_SIDE = 2**16
#: A column that would only hold a rounding error is not made (SPEC: ceil(u / cell - 1e-6)).
SLACK = 1e-6


@dataclass(frozen=True, slots=True)
class Grid:
    """Square compartments over the scan's plan. Row 0 is north, column 0 is west.

    Attributes
    ----------
    west, south : float
        Edges of the grid in scan coordinates, metres.
    cell_size : float
        Side of a compartment, metres.
    columns, rows : int
    """

    west: float
    south: float
    cell_size: float
    columns: int
    rows: int

    @classmethod
    def over(cls, west: float, south: float, width: float, depth: float, cell_size: float) -> Grid:
        """Cover ``width`` by ``depth`` metres from the south-west corner with compartments.

        Raises
        ------
        GridError
            When there would be absurdly many.
        """
        columns, rows = (_steps(length, cell_size) for length in (width, depth))
        if columns > LONGEST_SIDE or rows > LONGEST_SIDE or columns * rows > MOST_COMPARTMENTS:
            least = max(
                width / LONGEST_SIDE, depth / LONGEST_SIDE, math.sqrt(width * depth / MOST_COMPARTMENTS)
            )
            raise GridError(
                f"cell size {cell_size:g} m makes {columns:.4g} x {rows:.4g} compartments over "
                f"{width:.4g} x {depth:.4g} m; use at least {_rounded_up(least):g} m or crop the scan"
            )
        return cls(west, south, cell_size, int(columns), int(rows))

    def __len__(self) -> int:
        return self.columns * self.rows

    def compartment(self, east: NDArray[np.float64], north: NDArray[np.float64]) -> NDArray[np.int64]:
        """Compartment numbers (row * columns + column) of places metres east and north of the corner."""
        column = self._step(east, self.columns)
        row = self.rows - 1 - self._step(north, self.rows)
        return row * self.columns + column

    def _step(self, distance: NDArray[np.float64], count: int) -> NDArray[np.int64]:
        steps = distance / self.cell_size
        np.clip(steps, 0, count - 1, out=steps)
        return steps.astype(np.int64)  # the floor, as nothing is negative

    def row_column(self, compartment: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
        """Row and column of compartment numbers."""
        row = compartment // self.columns
        return row, compartment - row * self.columns  # eight times as quick as divmod

    def squares(self, compartment: NDArray[Any]) -> NDArray[np.float64]:
        """Return the west, south, east and north edges of compartments, shape (n, 4), metres."""
        row, column = self.row_column(compartment)
        west = self.west + column * self.cell_size
        south = self.south + (self.rows - 1 - row) * self.cell_size
        return np.column_stack([west, south, west + self.cell_size, south + self.cell_size])

    def lines(self, compartment: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the lines around compartments: west and east, south and north, each of shape (n, 2), metres.

        Unlike ``squares``, neighbours get the very same number for the line between them.
        """
        row, column = self.row_column(compartment)
        sides = np.array([0, 1])
        x = self.west + (column[:, np.newaxis] + sides) * self.cell_size
        y = self.south + (self.rows - 1 - row[:, np.newaxis] + sides) * self.cell_size
        return x, y

    def centres(self, compartment: NDArray[Any]) -> NDArray[np.float64]:
        """Return the middles of compartments, shape (n, 2), metres."""
        squares = self.squares(compartment)
        return (squares[:, :2] + squares[:, 2:]) / 2


def _steps(length: float, cell_size: float) -> float:
    """Count the compartments along ``length``; a float, as it may be beyond all integers."""
    return max(1.0, float(np.ceil(length / cell_size - SLACK)))


def _rounded_up(value: float) -> float:
    """Round up to two digits, so that an advised number is sure to be enough."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1) if value > 0 else 1.0
    return math.ceil(value / unit) * unit
