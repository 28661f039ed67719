"""What the method makes of a scan: the layers, and all that led to them, from one set of parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count

import numpy as np
from numpy.typing import NDArray

from stepfield.filling import NOTHING, Filled, Ground, fill
from stepfield.heightmap import Frame, GrayScale, HeightMap, draw, with_filled
from stepfield.layers import Layering
from stepfield.links import Links
from stepfield.moves import Outcome
from stepfield.parameters import Parameters
from stepfield.pillars import StepField
from stepfield.progress import Progress, silent
from stepfield.scan import Scan

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Layer:
    """One layer of the result: its pillars and how their heights become gray.

    Attributes
    ----------
    index : int
        0 is the lowest.
    name : str
    pillars : ndarray of shape (n,), int64
        Indices into the step-field, in order of compartment.
    elevation : ndarray of shape (n,), float64
        Metres above the scan's lowest point.
    alpha : float
        Metres from there down to the base plane (Eq. 1).
    white : float
        The height that is white in the layer's image, metres.
    is_obstacles : bool
        Whether it holds walls and columns, solid from their lowest points up.
    filled : Filled
        Compartments of its holes that were filled, and their elevations above the scan's lowest point.
    """

    index: int
    name: str
    pillars: Integers
    elevation: Floats
    alpha: float
    white: float
    is_obstacles: bool = False
    filled: Filled = NOTHING

    @property
    def heights(self) -> Floats:
        """Heights above the base plane, shape (n,), metres."""
        return self.elevation + self.alpha


@dataclass(frozen=True)
class Reconstruction:
    """Everything made from one scan with one set of parameters and moves.

    Attributes
    ----------
    scan : Scan
        After cleaning.
    parameters : Parameters
        With every ``auto`` replaced by the number picked from the data (``max_layers`` stays as asked).
    field : StepField
    automatic, layering : Layering
        Before and after the moves.
    linked : Links
        Among the exported pillars.
    outcomes : tuple of Outcome
        One a move.
    made : dict of int to str
        Names by which moves call the layers they made, whatever the operator calls them since.
    layers : tuple of Layer
    base_elevation : float
        Elevation of the base plane (Eq. 1), scan coordinates, metres.
    max_height : float
        Greatest height of the exported pillars (H_max of Eq. 2), metres.
    frame : Frame
        Size of the images.
    """

    scan: Scan
    parameters: Parameters
    field: StepField
    automatic: Layering
    layering: Layering
    linked: Links
    outcomes: tuple[Outcome, ...]
    made: dict[int, str]
    layers: tuple[Layer, ...]
    base_elevation: float
    max_height: float
    frame: Frame

    @property
    def links(self) -> Integers:
        """Neighbouring pillars that continue each other, shape (n, 2), int64; found when first asked for."""
        return self.linked.pairs

    @cached_property
    def seams(self) -> Integers:
        """Links that the layering cuts, shape (n, 2), int64; found when first asked for."""
        return self.layering.seams(self.links)

    def height_map(self, layer: Layer) -> HeightMap:
        """Draw one layer (5.2); drawn on demand, as images of large grids would not fit side by side."""
        grid, compartment = self.field.compartments.grid, self.field.compartment[layer.pillars]
        image = draw(grid, self.frame, compartment, layer.heights, self.scale(layer))
        if not len(layer.filled.compartment):
            return image
        filled, scale = layer.filled, self.scale(layer)
        heights = filled.elevation + layer.alpha
        return with_filled(image, draw(grid, self.frame, filled.compartment, heights, scale))

    def bottom_map(self, layer: Layer) -> HeightMap:
        """Draw the lower ends of a layer's pillars, by the scale of the layer."""
        field, scale = self.field, self.scale(layer)
        lows = field.lows(layer.pillars) + layer.alpha
        return draw(field.compartments.grid, self.frame, field.compartment[layer.pillars], lows, scale)

    def scale(self, layer: Layer) -> GrayScale:
        """How the heights of a layer become gray."""
        return GrayScale(layer.white, self.parameters.bits)

    def height_maps(self) -> Iterator[HeightMap]:
        """Draw the layers one after the other, the lowest first."""
        return (self.height_map(layer) for layer in self.layers)


@dataclass(frozen=True)
class Members:
    """A layer before alpha is known: its pillars, their elevations, the greatest of them, its kind."""

    pillars: Integers
    elevation: Floats
    greatest: float
    is_obstacles: bool = False


class Cutting:
    """Cuts a step-field into one step-field a layer (5.3.2). For one thread at a time.

    Layers that are those of the last layering stay the very same values: an edit concerns two of many.

    Parameters
    ----------
    field : StepField
    """

    def __init__(self, field: StepField) -> None:
        self._field = field
        self._last: tuple[Layering, list[Members]] | None = None

    def members(self, layering: Layering) -> list[Members]:
        """Cut by a layering."""
        known = self._known(layering)
        made = [known.get(index) or self._cut(layering, index) for index in range(layering.count)]
        self._last = layering, made
        return made

    def _known(self, layering: Layering) -> dict[int, Members]:
        """Layers that are as they were."""
        if self._last is None:
            return {}
        before, members = self._last
        differs = np.flatnonzero(before.layer != layering.layer)
        count = min(before.count, layering.count)
        touched = np.zeros(max(before.count, layering.count) + 1, bool)  # the last one is of Unassigned
        touched[before.layer[differs]] = touched[layering.layer[differs]] = True
        return {
            index: members[index]
            for index in np.flatnonzero(~touched[:count]).tolist()
            if members[index].is_obstacles == (index in layering.obstacles)
        }

    def _cut(self, layering: Layering, index: int) -> Members:
        pillars = layering.members(index)
        elevation = self._field.elevation[pillars]
        return Members(pillars, elevation, float(elevation.max(initial=0.0)), index in layering.obstacles)


def members_of(field: StepField, layering: Layering) -> list[Members]:
    """Cut a step-field by one layering."""
    return Cutting(field).members(layering)


def filled_of(
    field: StepField, members: Sequence[Members], parameters: Parameters, progress: Progress = silent
) -> tuple[Filled, ...]:
    """Fill the holes of the layers that are surfaces, as the parameters say."""
    if parameters.fill == "none":
        return (NOTHING,) * len(members)
    grounds = [
        Ground(
            field.compartment[member.pillars],
            field.lows(member.pillars) if member.is_obstacles else member.elevation,
            member.elevation,
            is_filled=not member.is_obstacles,
        )
        for member in members
    ]
    size, clearance = float(parameters.fill_size), float(parameters.layer_tolerance)
    return fill(field.compartments.grid, grounds, parameters.fill, size, clearance, progress)


def layers_of(
    members: Sequence[Members],
    alpha: float,
    parameters: Parameters,
    names: dict[int, str],
    filled: Sequence[Filled],
) -> tuple[Layer, ...]:
    """Name the layers and say which height is white in each (5.2)."""
    shared = max(member.greatest for member in members)
    named = all_named(len(members), names, [n for n, member in enumerate(members) if member.is_obstacles])
    return tuple(
        Layer(
            index=index,
            name=named[index],
            pillars=member.pillars,
            elevation=member.elevation,
            alpha=alpha,
            white=alpha + (member.greatest if parameters.range == "layer" else shared),
            is_obstacles=member.is_obstacles,
            filled=filled[index],
        )
        for index, member in enumerate(members)
    )


def all_named(layers: int, chosen: Mapping[int, str], obstacles: Sequence[int] = ()) -> dict[int, str]:
    """Name all layers: those without a name of their own by number, or by the first that is free."""
    named = {index: name for index, name in chosen.items() if index < layers}
    for index in obstacles:
        alike = ("Obstacles", *(f"Obstacles {number}" for number in range(2, layers + 2)))
        named.setdefault(index, next(name for name in alike if name not in named.values()))
    for index in range(layers):
        default = f"Layer {index + 1}"
        if index not in named and default not in named.values():
            named[index] = default
    free = (name for number in count(1) if (name := f"Layer {number}") not in named.values())
    return named | {index: next(free) for index in range(layers) if index not in named}
