"""What is wrong with a layer, seen from above: drawn over its relief in gray."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from stepfield.clearance import clearance
from stepfield.fidelity import holes, near_gaps
from stepfield.fidelity.gaps import NEAR
from stepfield.layers import UNASSIGNED
from stepfield.reconstruction import Reconstruction
from stepfield.surface.simulator import simulator_quads
from stepfield_app.ramps import ramp
from stepfield_app.scenes.arrays import frozen, robust_range, steps
from stepfield_app.scenes.legend import Colour, Legend
from stepfield_app.scenes.raster import hillshade, thinned_elevations
from stepfield_app.theme import OVERLAYS, rgb

Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]
Integers = NDArray[np.int64]
Kind = Literal["error", "seams", "holes", "gaps", "clearance", "lost"]

KINDS: tuple[Kind, ...] = get_args(Kind)
#: Gray of level ground under an overlay.
GROUND = 120
#: Errors span this share of a layer's pillars either way, and are never stretched beyond a millimetre.
ERROR_SHARE, LEAST_ERROR = 0.02, 0.001


@dataclass(frozen=True, eq=False)
class Overlay:
    """A picture of what is wrong and the numbers in it.

    Attributes
    ----------
    pixels : ndarray of shape (rows, columns, 4), uint8
        Red, green, blue, opacity (0 where nothing is drawn).
    values : ndarray of shape (rows, columns), float32
        What the colours stand for; NaN where there is only the ground.
    legend : Legend
    names : tuple of str
        What ``values`` stand for where they are the places in a list; empty where they are numbers.
    """

    pixels: Bytes
    values: Singles
    legend: Legend
    names: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class _Marks:
    """Values of compartments and how they are coloured: by a ramp, or by names."""

    compartment: Integers
    values: NDArray[np.floating]
    legend: Legend
    names: tuple[str, ...] = ()


def overlay(
    result: Reconstruction,
    layer: int,
    kind: Kind,
    errors: Sequence[Singles],
    colours: Bytes,
    stride: int = 1,
) -> Overlay:
    """Draw a layer from above with what is wrong in it.

    Parameters
    ----------
    result : Reconstruction
    layer : int
        -1 for the pillars in no layer, of which only the relief is drawn.
    kind : str
        ``error``: mean error of each pillar. ``seams``: where a surface goes on in another layer. ``holes``:
        empty compartments that the layer encloses. ``gaps``: vertical gaps near the tolerance.
        ``clearance``: room up to what is above. ``lost``: what a simulator does not draw.
    errors : sequence of ndarray
        Of the pillars of each layer, metres; nothing while they are not known.
    colours : ndarray of shape (layers + 1, 3), uint8
    stride : int
        Every how manieth row and column is drawn.
    """
    marks = _marks(result, layer, kind, errors, colours)
    grid, heights = thinned_elevations(result, layer, stride)
    pixels = _relief(heights, grid.cell_size)
    values = _placed(result, marks, stride, heights.shape)
    marked = ~np.isnan(values)
    pixels[marked, :3] = _colours(marks, values[marked])
    pixels[marked, 3] = 255
    return Overlay(frozen(pixels), frozen(values), marks.legend, marks.names)


def _marks(
    result: Reconstruction, layer: int, kind: Kind, errors: Sequence[Singles], colours: Bytes
) -> _Marks:
    if layer == UNASSIGNED or (kind == "error" and layer >= len(errors)):
        return _Marks(np.zeros(0, np.int64), np.zeros(0), Legend(""))
    if kind == "seams":
        return _seams(result, layer, colours)
    make = {"holes": _holes, "gaps": _gaps, "clearance": _clearance, "lost": _lost}
    return _errors(result, layer, errors[layer]) if kind == "error" else make[kind](result, layer)


def _errors(result: Reconstruction, layer: int, errors: Singles) -> _Marks:
    low, high = robust_range(errors, ERROR_SHARE)
    most = max(abs(low), abs(high), LEAST_ERROR) if np.isfinite(errors).any() else LEAST_ERROR
    legend = Legend("Scan above or below", "m", ramp("error"), low=-most, high=most)
    return _Marks(result.field.compartment[result.layers[layer].pillars], errors, legend)


def _seams(result: Reconstruction, layer: int, colours: Bytes) -> _Marks:
    """Pillars that are linked to another layer's, by that layer; the highest of several."""
    of = result.layering.layer
    both = np.vstack([result.seams, result.seams[:, ::-1]])
    own = both[of[both[:, 0]] == layer]
    other = of[own[:, 1]]
    order = np.argsort(other, kind="stable")
    names = tuple(f"goes on in {each.name}" for each in result.layers)
    entries = tuple((_colour(colours[n]), names[n]) for n in np.unique(other).tolist())
    legend = Legend("Seams", entries=entries or ((_colour(colours[layer]), "none in this layer"),))
    return _Marks(result.field.compartment[own[order, 0]], other[order].astype(np.float64), legend, names)


def _holes(result: Reconstruction, layer: int) -> _Marks:
    """Holes, those that were filled in another colour."""
    grid, own = result.field.compartments.grid, result.layers[layer]
    found = holes(grid, result.field.compartment[own.pillars])
    filled = np.isin(found.compartment, own.filled.compartment, assume_unique=True)
    names = ("hole", "filled") if result.parameters.fill == "none" else ("left open", "filled")
    texts = ("enclosed by the layer" if names[0] == "hole" else names[0], names[1])
    there = [kind for kind in (0, 1) if (filled == kind).any()]
    entries = tuple((rgb(OVERLAYS[("hole", "filled")[kind]]), texts[kind]) for kind in there)
    none = ((rgb(OVERLAYS["hole"]), "none in this layer"),)
    return _Marks(
        found.compartment, filled.astype(np.float64), Legend("Holes", entries=entries or none), names
    )


def _gaps(result: Reconstruction, layer: int) -> _Marks:
    tolerance = float(result.parameters.layer_tolerance)
    found = near_gaps(result.field.compartments, tolerance)
    low, high = (tolerance * (1 + sign * NEAR) for sign in (-1, 1))
    legend = Legend("Gap near the tolerance", "m", ramp("error"), low=low, high=high)
    return _Marks(found.compartment, found.gap, legend)


def _clearance(result: Reconstruction, layer: int) -> _Marks:
    pillars = result.layers[layer].pillars
    room = clearance(result.field, result.layering.layer)[pillars]
    limited = np.isfinite(room)
    low, high = robust_range(room[limited])
    legend = Legend("Clearance", "m", ramp("clearance"), low=low, high=high)
    if not limited.any():
        legend = Legend("Clearance", entries=(((GROUND,) * 3, "nothing above this layer"),))
    return _Marks(result.field.compartment[pillars[limited]], room[limited], legend)


def _lost(result: Reconstruction, layer: int) -> _Marks:
    """Share of each compartment that no quad of four pillars reaches."""
    compartment = result.field.compartment[result.layers[layer].pillars]
    quads = simulator_quads(result.field.compartments.grid, compartment)
    share = 1 - np.bincount(quads.ravel(), minlength=len(compartment)) / 4
    chosen = np.flatnonzero(share > 0)
    legend = Legend("Not drawn by a simulator", "%", ramp("lost"), low=0, high=100)
    return _Marks(compartment[chosen], 100 * share[chosen], legend)


def _relief(heights: Singles, cell_size: float) -> Bytes:
    """Gray relief, transparent in holes."""
    light = np.rint(GROUND * hillshade(heights, cell_size)).astype(np.uint8)
    pixels = np.empty((*heights.shape, 4), np.uint8)
    pixels[:, :, :3] = light[:, :, np.newaxis]
    pixels[:, :, 3] = 255
    pixels[np.isnan(heights)] = 0
    return pixels


def _placed(result: Reconstruction, marks: _Marks, stride: int, shape: tuple[int, ...]) -> Singles:
    """Values of every ``stride``-th row and column; NaN where there is none."""
    row, column = result.field.compartments.grid.row_column(marks.compartment)
    kept = (row % stride == 0) & (column % stride == 0)
    values = np.full(shape, np.nan, np.float32)
    values[row[kept] // stride, column[kept] // stride] = marks.values[kept]
    return values


def _colours(marks: _Marks, values: Singles) -> Bytes:
    legend = marks.legend
    if legend.ramp is not None:
        return legend.ramp[steps(values, legend.low, legend.high, len(legend.ramp))]
    if not marks.names:
        return np.zeros((len(values), 3), np.uint8)
    by_name = {name: colour for colour, name in legend.entries}
    first = legend.entries[0][0]
    palette = np.array([by_name.get(name, first) for name in marks.names], np.uint8)
    return palette[values.astype(np.int64)]


def _colour(row: NDArray[np.uint8]) -> Colour:
    red, green, blue = (int(part) for part in row)
    return red, green, blue
