"""The stages of the method in order, each remembered until something it depends on changes.

    read -> cleaned scan -> compartments -> step-field -> layering -> moves -> links -> filling -> layers

A new tolerance re-parts sorted points but does not sort again; a new alpha changes heights only; a move
re-runs what follows the layering. A preview runs on fewer points in stages of its own, so that neither it
nor the exact result makes the other start anew.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from stepfield import suggest
from stepfield.compartments import grid_under, sort_into_compartments
from stepfield.errors import ParameterError
from stepfield.filling import Filled
from stepfield.heightmap import Frame
from stepfield.layers import UNASSIGNED, Layering, classify
from stepfield.links import Links
from stepfield.moves import Edited, Replay
from stepfield.obstacles import classify_apart
from stepfield.parameters import Parameters
from stepfield.pillars import StepField, build_pillars
from stepfield.progress import Progress, part, silent
from stepfield.project import LayerStyle, Move
from stepfield.reconstruction import Cutting, Members, Reconstruction, filled_of, layers_of
from stepfield.scan import Scan, cleaned, read_scan

Made = TypeVar("Made")
Mask = NDArray[np.bool_]
Integers = NDArray[np.int64]

#: Longest side of the holes that are filled, in compartments, unless the operator gives a length.
FILL_CELLS = 5
#: How the names of a preview's stages begin: they have places of their own.
PREVIEW = "preview "


@dataclass(frozen=True)
class Stage(Generic[Made]):
    """The result of a stage, the stage it was made from, and the values: those before it included."""

    name: str
    key: Any
    source: str | None
    made: Made


class Pipeline:
    """Runs the method, remembering the last result of each stage. For one thread at a time."""

    def __init__(self) -> None:
        self._stages: dict[str, Stage[Any]] = {}

    @property
    def raw(self) -> Scan:
        """The scan of the last run before cleaning."""
        raw: Scan = self._stages["raw"].made
        return raw

    def run(
        self,
        scans: Sequence[Path],
        parameters: Parameters,
        moves: Sequence[Move] = (),
        styles: Sequence[LayerStyle] = (),
        progress: Progress = silent,
        *,
        most_points: int | None = None,
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
            Called between chunks and before each costly stage; may raise Cancelled.
        most_points : int, optional
            Of a scan that has more, make a preview from about so many, evenly chosen. Its grid is the one
            of all points, and so are the numbers picked for ``auto``.

        Raises
        ------
        StepfieldError
            In one sentence.
        """
        scan = self._scan(scans, parameters, part(progress, 0, 0.5))
        parameters = self._resolved(scan, parameters, part(progress, 0.5, 0.55))
        points, share = self._drawn(scan, most_points)
        field = self._step_field(points, parameters, share, part(progress, 0.55, 0.85))
        progress(0.85, "classifying pillars")
        automatic = self._classified(field, parameters, share)
        edited = self._edited(field, automatic, moves, part(progress, 0.85, 0.95))
        links = self._linked(field, edited, parameters)
        members = self._members(field, edited)
        filled = self._filled(field, members, parameters, part(progress, 0.96, 1.0))
        alpha = _metres(parameters.alpha)
        names = edited.made.names | {style.index: style.name for style in styles if style.name}
        progress(1.0, "done")
        return Reconstruction(
            scan=scan.made,
            parameters=parameters,
            field=field.made,
            automatic=automatic.made,
            layering=edited.made.layering,
            linked=links,
            outcomes=edited.made.outcomes,
            layers=layers_of(members.made, alpha, parameters, names, filled),
            made=edited.made.names,
            base_elevation=field.made.compartments.lowest - alpha,
            max_height=alpha + max(member.greatest for member in members.made),
            frame=Frame.around(field.made.compartments.grid, parameters.pad),
        )

    def _once(
        self, name: str, source: Stage[Any] | None, chosen: tuple[Any, ...], make: Callable[[], Made]
    ) -> Stage[Made]:
        """Return a stage's last result if nothing it is made from has changed, else make it anew.

        Parameters
        ----------
        name : str
        source : Stage or None
            The stage it is made from; a stage of the preview makes others of the preview.
        chosen : tuple
            The values it is made from besides.
        make : callable
        """
        if source is not None:
            name = (PREVIEW if source.name.startswith(PREVIEW) else "") + name
            chosen = (source.key, *chosen)
        stage = self._stages.get(name)
        if stage is None or stage.key != chosen:
            stage = None
            self._free(name)  # before the new results take their memory
            stage = self._stages[name] = Stage(name, chosen, source.name if source else None, make())
        return stage

    def _free(self, name: str) -> None:
        """Forget a stage and all that was made from it."""
        self._stages.pop(name, None)
        for later in [stage.name for stage in self._stages.values() if stage.source == name]:
            self._free(later)

    def _scan(self, scans: Sequence[Path], parameters: Parameters, progress: Progress) -> Stage[Scan]:
        """Read and clean the point cloud (2)."""
        unit, up = parameters.unit, parameters.up
        declared = None if unit == "auto" else unit
        read = (_stamps(scans), unit, up)
        raw = self._once("raw", None, read, lambda: read_scan(scans, declared, up, progress))
        cleaning = (parameters.crop, parameters.classes, parameters.outliers)
        return self._once("scan", raw, cleaning, lambda: cleaned(raw.made, parameters, progress))

    def _drawn(self, scan: Stage[Scan], most_points: int | None) -> tuple[Stage[Scan], float]:
        """Choose the points of a preview, if it is to be one; return which share of all they are."""
        if most_points is None or most_points >= len(scan.made):
            return scan, 1.0
        fewer = self._once(PREVIEW + "scan", scan, (most_points,), lambda: scan.made.thinned(most_points))
        return fewer, most_points / len(scan.made)

    def _resolved(self, scan: Stage[Scan], parameters: Parameters, progress: Progress) -> Parameters:
        """Replace every ``auto`` that is a number by the one picked from the scan."""
        cell, tolerance, alpha = parameters.cell_size, parameters.layer_tolerance, parameters.alpha
        progress(0.0, "looking at the scan")
        if cell == "auto":
            cell = self._once("auto cell", scan, (), lambda: suggest.cell_size(scan.made)).made
        if tolerance == "auto":
            tolerance = self._once(
                "auto tolerance", scan, (cell,), lambda: suggest.layer_tolerance(scan.made, _metres(cell))
            ).made
        if alpha == "auto":
            alpha = suggest.alpha(_metres(cell), scan.made.z.span())
        step = tolerance if parameters.link_step == "auto" else parameters.link_step
        size = FILL_CELLS * _metres(cell) if parameters.fill_size == "auto" else parameters.fill_size
        picked = {
            "cell_size": cell,
            "layer_tolerance": tolerance,
            "alpha": alpha,
            "link_step": step,
            "fill_size": size,
        }
        if parameters.complex_residual == "auto":
            picked["complex_residual"] = suggest.complex_residual(_metres(cell))
        return parameters.model_copy(update=picked | {"unit": scan.made.unit})

    def _step_field(
        self, scan: Stage[Scan], parameters: Parameters, share: float, progress: Progress
    ) -> Stage[StepField]:
        """Sort the points into compartments and build the pillars (5.1, 5.3.2)."""
        cell, tolerance = _metres(parameters.cell_size), _metres(parameters.layer_tolerance)
        grid_under(scan.made, cell)  # an absurd cell size fails before anything is forgotten for it
        compartments = self._once(
            "compartments", scan, (cell,), lambda: sort_into_compartments(scan.made, cell, progress)
        )
        progress(1.0, "building pillars")
        statistic, to_tops = parameters.pillar_height, parameters.walls != "mean"

        def build() -> StepField:
            field = build_pillars(compartments.made, tolerance, statistic, share)
            return field.with_walls_to_their_tops() if to_tops else field

        return self._once("field", compartments, (tolerance, statistic, to_tops, share), build)

    def _classified(self, field: Stage[StepField], parameters: Parameters, share: float) -> Stage[Layering]:
        """Classify the pillars (5.3.3); a share of the points makes pillars of as few."""
        method, most = parameters.layering, parameters.max_layers
        sort = classify_apart if parameters.walls == "layer" else classify
        step = _metres(parameters.link_step)

        def linked(chosen: Mask) -> Integers:
            return self._links(field, chosen, step).pairs

        fewest = max(1, round(parameters.min_points * share))
        classified = self._once(
            "layers",
            field,
            (method, fewest, most, sort, step if method == "surface" else None),
            lambda: sort(field.made, method, linked=linked, min_points=fewest, max_layers=most),
        )
        if not classified.made.count:
            raise ParameterError(
                f"no pillar has {fewest} points, the fullest has {int(field.made.points.max())}; "
                f"lower min_points or enlarge the cell size"
            )
        return classified

    def _edited(
        self, field: Stage[StepField], automatic: Stage[Layering], moves: Sequence[Move], progress: Progress
    ) -> Stage[Edited]:
        """Apply the moves, or only what is new of them."""
        replay = self._once("replay", automatic, (), lambda: Replay(field.made, automatic.made))
        return self._once("moves", replay, (tuple(moves),), lambda: replay.made.edited(moves, progress))

    def _members(self, field: Stage[StepField], edited: Stage[Edited]) -> Stage[list[Members]]:
        """Sort the pillars by layer; layers that an edit does not touch stay as they were."""
        cutting = self._once("cutting", field, (), lambda: Cutting(field.made)).made
        return self._once("members", edited, (), lambda: cutting.members(edited.made.layering))

    def _filled(
        self,
        field: Stage[StepField],
        members: Stage[list[Members]],
        parameters: Parameters,
        progress: Progress,
    ) -> tuple[Filled, ...]:
        """Fill the holes of the layers; no other stage is made from it."""
        chosen = (parameters.fill, parameters.fill_size, parameters.layer_tolerance)
        if parameters.fill == "none":
            chosen = ("none", 0.0, 0.0)
        progress(0.0, "filling holes")
        return self._once(
            "filled", members, chosen, lambda: filled_of(field.made, members.made, parameters, progress)
        ).made

    def _linked(self, field: Stage[StepField], edited: Stage[Edited], parameters: Parameters) -> Links:
        """Links among the exported pillars; they outlive moves between layers."""
        exported = edited.made.layering.layer != UNASSIGNED
        return self._links(field, exported, _metres(parameters.link_step))

    def _links(self, field: Stage[StepField], among: Mask, step: float) -> Links:
        chosen = (np.packbits(among).tobytes(), step)
        return self._once("links", field, chosen, lambda: Links(field.made, among, step)).made


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
