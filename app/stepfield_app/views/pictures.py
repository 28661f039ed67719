"""What the plots show: finished, read-only values."""

from __future__ import annotations

import math
from dataclasses import dataclass
from dataclasses import field as made_by

import numpy as np
from numpy.typing import NDArray

from stepfield.pillars import StepField
from stepfield_app.scenes.legend import Legend

Place = tuple[float, float]
#: Ways to draw a map, what the window calls them, and what they show.
MODES = {
    "gray": ("As exported", "The gray levels of the exported image"),
    "colour": ("Elevation", "Colours by elevation"),
    "hillshade": ("Hillshade", "Colours by elevation, with light from the north-west"),
    "error": ("Error", "How far the points of each compartment are above or below the layer, on average"),
    "seams": ("Seams", "Where a surface goes on in another layer"),
    "holes": ("Holes", "Empty compartments that the layer encloses"),
    "gaps": ("Close gaps", "Where a vertical gap is so near the tolerance that a small move of it tells"),
    "clearance": ("Clearance", "Room up to what is above: does a robot fit?"),
    "lost": ("Not drawn", "What a simulator that puts a vertex into each pixel does not draw"),
}
#: The modes that mark what is wrong.
OVERLAYS = ("error", "seams", "holes", "gaps", "clearance", "lost")


@dataclass(frozen=True, eq=False)
class MapPicture:
    """A layer from above.

    Attributes
    ----------
    layer : int
        -1 for the pillars in no layer.
    name, colour : str
        Of the layer.
    pixels : ndarray of shape (rows, columns, 4), uint8
        Red, green, blue, opacity; row 0 is north. Opacity is 0 or 255.
    west, south, east, north : float
        Edges of the picture, scan coordinates, metres.
    cell_size : float
        Metres.
    legend : Legend or None
    values : ndarray of shape (rows, columns), float32, or None
        What an overlay's colours stand for, NaN where there is none.
    names : tuple of str
        What ``values`` stand for where they are places in it.
    mode : str
        One of :data:`MODES`.
    """

    layer: int
    name: str
    colour: str
    pixels: NDArray[np.uint8]
    west: float
    south: float
    east: float
    north: float
    cell_size: float
    legend: Legend | None = None
    values: NDArray[np.float32] | None = None
    names: tuple[str, ...] = ()
    mode: str = ""

    def value_at(self, x: float, y: float) -> float:
        """Return the overlay's value at a place in scan coordinates, metres; NaN where it has none."""
        if self.values is None or not (self.west <= x < self.east and self.south <= y < self.north):
            return math.nan
        rows, columns = self.values.shape
        row = int((self.north - y) / (self.north - self.south) * rows)
        column = int((x - self.west) / (self.east - self.west) * columns)
        return float(self.values[min(row, rows - 1), min(column, columns - 1)])


@dataclass(frozen=True, eq=False)
class Section:
    """Points and pillars in a band along a line.

    Attributes
    ----------
    start, end : tuple of float
        Ends of the line (x, y), scan coordinates, metres.
    width : float
        Of the band, metres.
    distance, elevation : ndarray of shape (n,), float64
        Of the points: metres from the start along the line, and scan elevations.
    codes : ndarray of shape (n,), uint8
        Row of ``colours`` of each point.
    spans : ndarray of shape (m, 4), float64
        From and to along the line, lowest and highest elevation of each pillar, metres.
    tops : ndarray of shape (m,), float64
        The elevations the pillars have in the height-map.
    pillar_codes : ndarray of shape (m,), uint8
        Row of ``colours`` of each pillar.
    colours : ndarray of shape (layers + 1, 3), uint8
        Of the layers, of Unassigned in the last row.
    total : int
        Points in the band, of which ``distance`` may be a sample.
    pillars : ndarray of shape (m,), int64
        Indices of the pillars into the step-field.
    field : StepField or None
        The step-field they are of.
    vertical : ndarray of shape (m,), bool
        Which pillars are walls; empty where none is.
    """

    start: Place
    end: Place
    width: float
    distance: NDArray[np.float64]
    elevation: NDArray[np.float64]
    codes: NDArray[np.uint8]
    spans: NDArray[np.float64]
    tops: NDArray[np.float64]
    pillar_codes: NDArray[np.uint8]
    colours: NDArray[np.uint8]
    total: int
    pillars: NDArray[np.int64] = made_by(default_factory=lambda: np.zeros(0, np.int64))
    field: StepField | None = None
    vertical: NDArray[np.bool_] = made_by(default_factory=lambda: np.zeros(0, bool))


@dataclass(frozen=True, eq=False)
class Histogram:
    """How many points there are at each elevation.

    Attributes
    ----------
    edges : ndarray of shape (B + 1,), float64
        Elevations, scan coordinates, metres.
    counts : ndarray of shape (rows, B), int64
        Points of each layer, the lowest layer first, and of Unassigned last.
    colours : tuple of str
        One a row of ``counts``.
    levels : tuple of (str, str, float)
        Name, colour and average elevation of each layer, the lowest first; NaN for an empty one.
    """

    edges: NDArray[np.float64]
    counts: NDArray[np.int64]
    colours: tuple[str, ...]
    levels: tuple[tuple[str, str, float], ...] = ()
