"""Small reconstructions with known answers for the tests of the scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction

#: Far from zero, as national grids are: float32 alone would be wrong by a quarter of a metre here.
UTM = (432_100.0, 5_411_300.0, 212.0)


def reconstruct(folder: Path, points: Any, **parameters: object) -> Reconstruction:
    """Run the method on points of shape (n, 3)."""
    path = folder / "scan.npy"
    np.save(path, np.asarray(points, np.float64))
    return Pipeline().run([path], Parameters.checked(**parameters))


def table(shift: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Points of an 8 x 6 m floor with a 3 x 2 m table-top a metre above it, four points a half-metre."""
    step = np.arange(0.125, 8, 0.25)
    x, y = (grid.ravel() for grid in np.meshgrid(step, step[step < 6]))
    above = (x > 2) & (x < 5) & (y > 2) & (y < 4)
    floor = np.column_stack([x, y, np.zeros_like(x)])
    top = np.column_stack([x[above], y[above], np.ones(above.sum())])
    corners = [[0.0, 0.0, 0.0], [8.0, 6.0, 0.0]]
    points: np.ndarray = np.vstack([floor, top, corners]) + shift
    return points


def table_result(folder: Path, shift: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Reconstruction:
    """Reconstruct the table with cells of half a metre: layer 0 is the floor, layer 1 the top."""
    return reconstruct(folder, table(shift), cell_size=0.5, layer_tolerance=0.3, alpha=0.5)
