"""The stages of the method in order, each remembered until something it depends on changes.

    scan -> sorted compartments -> step-field -> layering -> moves -> links -> layers

A new tolerance re-parts sorted points but does not sort again; a new alpha changes heights only; a move
re-runs what follows the layering.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from stepfield import suggest
from stepfield.compartments import sort_into_compartments
from stepfield.errors import ParameterError
from stepfield.heightmap import Frame
from stepfield.layers import UNASSIGNED, Layering, classify
from stepfield.links import link, seams
from stepfield.moves import apply_moves
from stepfield.parameters import Parameters
from stepfield.pillars import StepField, build_pillars
from stepfield.progress import Progress, part, silent
from stepfield.project import LayerStyle, Move
from stepfield.reconstruction import Reconstruction, layers_of, members_of
from stepfield.scan import Scan, open_scan

Made = TypeVar("Made")


@dataclass(frozen=True)
class Stage(Generic[Made]):
    """The result of a stage and the values it was made from, those of the stages before it included."""

    key: Any
    made: Made


class Pipeline:
    """Runs the method, remembering the last result of each stage. For one thread at a time."""

    def __init__(self) -> None:
        self._stages: dict[str, Stage[Any]] = {}

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
        scan = self._scan(scans, parameters, part(progress, 0, 0.5))
        parameters = self._resolved(scan, parameters)
        field = self._step_field(scan, parameters, part(progress, 0.5, 0.85))
        progress(0.85, "classifying pillars")
        automatic = self._classified(field, parameters)
        edited = self._once(
            "moves", (automatic.key, tuple(moves)), lambda: apply_moves(field.made, automatic.made, moves)
        )
        layering = edited.made.layering
        links, cut = self._once(
            "links",
            (edited.key, parameters.link_step),
            lambda: _linked(field.made, layering, _metres(parameters.link_step)),
        ).made
        members = self._once("members", edited.key, lambda: members_of(field.made, layering)).made
        alpha = _metres(parameters.alpha)
        names = edited.made.names | {style.index: style.name for style in styles if style.name}
        progress(1.0, "done")
        return Reconstruction(
            scan=scan.made,
            parameters=parameters,
            field=field.made,
            automatic=automatic.made,
            layering=layering,
            links=links,
            seams=cut,
            outcomes=edited.made.outcomes,
            layers=layers_of(members, alpha, parameters, names),
            base_elevation=field.made.compartments.lowest - alpha,
            max_height=alpha + max(member.greatest for member in members),
            frame=Frame.around(field.made.compartments.grid, parameters.pad),
        )

    def _once(self, name: str, key: Any, make: Callable[[], Made]) -> Stage[Made]:
        """Return the stage's last result if its key is unchanged, else make it anew."""
        stage = self._stages.pop(name, None)
        if stage is None or stage.key != key:
            stage = None  # the old result goes before the new one takes its memory
            stage = Stage(key, make())
        self._stages[name] = stage
        return stage

    def _scan(self, scans: Sequence[Path], parameters: Parameters, progress: Progress) -> Stage[Scan]:
        """Read and clean the point cloud (2)."""
        cleaning = (parameters.crop, parameters.classes, parameters.outliers)
        key = (_stamps(scans), parameters.unit, parameters.up, *cleaning)
        return self._once("scan", key, lambda: open_scan(scans, parameters, progress))

    def _resolved(self, scan: Stage[Scan], parameters: Parameters) -> Parameters:
        """Replace every ``auto`` that is a number by the one picked from the scan."""
        cell, tolerance, alpha = parameters.cell_size, parameters.layer_tolerance, parameters.alpha
        if cell == "auto":
            cell = self._once("auto cell", scan.key, lambda: suggest.cell_size(scan.made)).made
        if tolerance == "auto":
            key = (scan.key, cell)
            tolerance = self._once(
                "auto tolerance", key, lambda: suggest.layer_tolerance(scan.made, _metres(cell))
            ).made
        if alpha == "auto":
            alpha = suggest.alpha(_metres(cell), scan.made.z.span())
        step = tolerance if parameters.link_step == "auto" else parameters.link_step
        picked = {"cell_size": cell, "layer_tolerance": tolerance, "alpha": alpha, "link_step": step}
        return parameters.model_copy(update=picked | {"unit": scan.made.unit})

    def _step_field(self, scan: Stage[Scan], parameters: Parameters, progress: Progress) -> Stage[StepField]:
        """Sort the points into compartments and build the pillars (5.1, 5.3.2)."""
        cell, tolerance = _metres(parameters.cell_size), _metres(parameters.layer_tolerance)
        compartments = self._once(
            "compartments", (scan.key, cell), lambda: sort_into_compartments(scan.made, cell, progress)
        )
        progress(1.0, "building pillars")
        statistic = parameters.pillar_height
        return self._once(
            "field",
            (compartments.key, tolerance, statistic),
            lambda: build_pillars(compartments.made, tolerance, statistic),
        )

    def _classified(self, field: Stage[StepField], parameters: Parameters) -> Stage[Layering]:
        """Classify the pillars (5.3.3)."""
        method, fewest, most = parameters.layering, parameters.min_points, parameters.max_layers
        classified = self._once(
            "layers",
            (field.key, method, fewest, most),
            lambda: classify(field.made, method, min_points=fewest, max_layers=most),
        )
        if not classified.made.count:
            raise ParameterError(
                f"no pillar has {fewest} points, the fullest has {int(field.made.points.max())}; "
                f"lower min_points or enlarge the cell size"
            )
        return classified


def _metres(value: float | str) -> float:
    """Narrow a length that is ``auto`` no more."""
    return float(value)


def _stamps(scans: Sequence[Path]) -> tuple[Any, ...]:
    """Identify files by place, size and time of change, so that a file saved anew is read anew."""
    stamps = []
    for path in scans:
        stat = path.stat() if path.exists() else None
        stamps.append((path, stat and (stat.st_size, stat.st_mtime_ns)))
    return tuple(stamps)


def _linked(
    field: StepField, layering: Layering, link_step: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Links among the exported pillars, and the seams among them."""
    links = link(field, layering.layer != UNASSIGNED, link_step)
    return links, seams(links, layering)
