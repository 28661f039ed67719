"""The stages of the method in order, each remembered until something it depends on changes.

    scan -> sorted compartments -> step-field -> layering -> links -> moves -> height-maps

A new tolerance re-parts sorted points but does not sort again; a new alpha changes heights only; a move
re-runs what follows the layering. The one memo per stage is keyed by values, the stage before it included.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from stepfield import suggest
from stepfield.compartments import sort_into_compartments
from stepfield.errors import ParameterError
from stepfield.heightmap import Frame, GrayScale, HeightMap, draw
from stepfield.layers import UNASSIGNED, Layering, classify
from stepfield.links import link, seams
from stepfield.moves import Outcome, apply_moves
from stepfield.parameters import Parameters
from stepfield.pillars import StepField, build_pillars
from stepfield.progress import Progress, part, silent
from stepfield.project import LayerStyle, Move
from stepfield.scan import Scan, open_scan

Stage = TypeVar("Stage")
Floats = NDArray[np.float64]


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
    """

    index: int
    name: str
    pillars: NDArray[np.int64]
    elevation: Floats
    alpha: float
    white: float

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
    links, seams : ndarray of shape (n, 2), int64
        Pairs of pillars.
    outcomes : tuple of Outcome
        One a move.
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
    links: NDArray[np.int64]
    seams: NDArray[np.int64]
    outcomes: tuple[Outcome, ...]
    layers: tuple[Layer, ...]
    base_elevation: float
    max_height: float
    frame: Frame

    def height_map(self, layer: Layer) -> HeightMap:
        """Draw one layer (5.2); drawn on demand, as images of large grids would not fit side by side."""
        grid, compartment = self.field.compartments.grid, self.field.compartment[layer.pillars]
        return draw(grid, self.frame, compartment, layer.heights, self.scale(layer))

    def scale(self, layer: Layer) -> GrayScale:
        """How the heights of a layer become gray."""
        return GrayScale(layer.white, self.parameters.bits)

    def height_maps(self) -> Iterator[HeightMap]:
        """Draw the layers one after the other, the lowest first."""
        return (self.height_map(layer) for layer in self.layers)


class Pipeline:
    """Runs the method, remembering the last result of each stage. For one thread at a time."""

    def __init__(self) -> None:
        self._memo: dict[str, tuple[Any, Any]] = {}

    def run(
        self,
        scans: Sequence[Path],
        parameters: Parameters,
        moves: Sequence[Move] = (),
        styles: Sequence[LayerStyle] = (),
        progress: Progress = silent,
    ) -> Reconstruction:
        """Make the layered step-fields of a scan (5.1 to 5.3).

        Parameters
        ----------
        scans : sequence of Path
            Files of one scan.
        parameters : Parameters
        moves : sequence of Move
            Pillars put into other layers by hand.
        styles : sequence of LayerStyle
            The operator's names of layers.
        progress : Progress
            Called between chunks; may raise Cancelled.

        Raises
        ------
        StepfieldError
            In one sentence.
        """
        # The prerequisite (2): the point cloud, cleaned
        source = (_stamps(scans), parameters.unit, parameters.up, *_cleaning(parameters))
        scan = self._once("scan", source, lambda: open_scan(scans, parameters, part(progress, 0, 0.5)))
        # Compartments and pillars (5.1, 5.3.2)
        cell, tolerance = self._sizes(source, scan, parameters)
        sorted_key = (source, cell)
        compartments = self._once(
            "compartments", sorted_key, lambda: sort_into_compartments(scan, cell, part(progress, 0.5, 0.8))
        )
        progress(0.8, "building pillars")
        field_key = (sorted_key, tolerance, parameters.pillar_height)
        field = self._once(
            "field", field_key, lambda: build_pillars(compartments, tolerance, parameters.pillar_height)
        )
        # Classification of pillars (5.3.3), then the operator's moves
        progress(0.85, "classifying pillars")
        layer_key = (field_key, parameters.layering, parameters.min_points, parameters.max_layers)
        automatic = self._once("layers", layer_key, lambda: _classified(field, parameters))
        moved_key = (layer_key, tuple(moves))
        edited = self._once("moves", moved_key, lambda: apply_moves(field, automatic, moves))
        step = tolerance if parameters.link_step == "auto" else parameters.link_step
        linked_key = (moved_key, step)
        links, cut = self._once("links", linked_key, lambda: _linked(field, edited.layering, step))
        members = self._once("members", moved_key, lambda: _members(field, edited.layering))
        # Height-maps (5.2): heights above the base plane of Eq. 1
        alpha = _alpha(parameters, scan, cell)
        picked = {"cell_size": cell, "layer_tolerance": tolerance, "link_step": step, "alpha": alpha}
        resolved = parameters.model_copy(update=picked | {"unit": scan.unit})
        layers = _layers(members, alpha, resolved, _names(edited.names, styles))
        progress(1.0, "done")
        return Reconstruction(
            scan=scan,
            parameters=resolved,
            field=field,
            automatic=automatic,
            layering=edited.layering,
            links=links,
            seams=cut,
            outcomes=edited.outcomes,
            layers=layers,
            base_elevation=compartments.lowest - alpha,
            max_height=alpha + max(member.greatest for member in members),
            frame=Frame.around(compartments.grid, resolved.pad),
        )

    def _once(self, stage: str, key: Any, make: Callable[[], Stage]) -> Stage:
        """Return the stage's last result if its key is unchanged, else make it anew."""
        known = self._memo.get(stage)
        if known is not None and known[0] == key:
            result: Stage = known[1]
            return result
        self._memo.pop(stage, None)  # let the old one go before the new one needs its memory
        result = make()
        self._memo[stage] = (key, result)
        return result

    def _sizes(self, source: Any, scan: Scan, parameters: Parameters) -> tuple[float, float]:
        """Return cell size and tolerance, picked from the scan where the operator leaves them to it."""
        cell, tolerance = parameters.cell_size, parameters.layer_tolerance
        if cell == "auto":
            cell = self._once("auto cell", source, lambda: suggest.cell_size(scan))
        side = float(cell)
        if tolerance == "auto":
            tolerance = self._once(
                "auto tolerance", (source, side), lambda: suggest.layer_tolerance(scan, side)
            )
        return side, float(tolerance)


def _cleaning(parameters: Parameters) -> tuple[Any, ...]:
    return parameters.crop, parameters.classes, parameters.outliers


def _stamps(scans: Sequence[Path]) -> tuple[Any, ...]:
    """Identify files by place, size and time of change, so that a file saved anew is read anew."""
    stamps = []
    for path in scans:
        stat = path.stat() if path.exists() else None
        stamps.append((path, stat and (stat.st_size, stat.st_mtime_ns)))
    return tuple(stamps)


def _classified(field: StepField, parameters: Parameters) -> Layering:
    layering = classify(
        field,
        parameters.layering,
        min_points=parameters.min_points,
        max_layers=parameters.max_layers,
    )
    if not layering.count:
        most = int(field.points.max())
        raise ParameterError(
            f"no pillar has {parameters.min_points} points, the fullest has {most}; lower min_points or "
            f"enlarge the cell size"
        )
    return layering


def _alpha(parameters: Parameters, scan: Scan, cell: float) -> float:
    if parameters.alpha != "auto":
        return parameters.alpha
    return suggest.alpha(cell, scan.z.span())


def _names(made: dict[int, str], styles: Sequence[LayerStyle]) -> dict[int, str]:
    return made | {style.index: style.name for style in styles if style.name}


def _linked(
    field: StepField, layering: Layering, link_step: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Links among the exported pillars, and the seams among them."""
    links = link(field, layering.layer != UNASSIGNED, link_step)
    return links, seams(links, layering)


@dataclass(frozen=True)
class _Member:
    """What a layer is before alpha: which pillars, their elevations, the greatest of them."""

    pillars: NDArray[np.int64]
    elevation: Floats
    greatest: float


def _members(field: StepField, layering: Layering) -> list[_Member]:
    """Cut the step-field into one step-field a layer (5.3.2)."""
    chosen = [layering.members(index) for index in range(layering.count)]
    elevations = [field.elevation[pillars] for pillars in chosen]
    return [
        _Member(pillars, elevation, float(elevation.max(initial=0.0)))
        for pillars, elevation in zip(chosen, elevations, strict=True)
    ]


def _layers(
    members: Sequence[_Member], alpha: float, parameters: Parameters, names: dict[int, str]
) -> tuple[Layer, ...]:
    """Name the layers and say which height is white in each (5.2)."""
    shared = max(member.greatest for member in members)
    return tuple(
        Layer(
            index=index,
            name=names.get(index, f"Layer {index + 1}"),
            pillars=member.pillars,
            elevation=member.elevation,
            alpha=alpha,
            white=alpha + (member.greatest if parameters.range == "layer" else shared),
        )
        for index, member in enumerate(members)
    )
