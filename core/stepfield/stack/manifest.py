"""manifest.json: what every image of a stack means, in metres. Its JSON schema ships in resources."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np

import stepfield
from stepfield.clearance import ClearanceMap
from stepfield.complex_parts import ComplexParts
from stepfield.document import Document
from stepfield.errors import StackError, StepfieldError
from stepfield.layers import UNASSIGNED
from stepfield.parameters import Parameters
from stepfield.reconstruction import Layer, Reconstruction
from stepfield.stack.complexfile import FILE_NAME as COMPLEX
from stepfield.stack.entries import (
    ClearanceEntry,
    ComplexEntry,
    GridEntry,
    ImageEntry,
    LayerEntry,
    Metres,
    Natural,
    Source,
    SourceEntry,
)

VERSION: Literal[1] = 1
FILE_NAME = "manifest.json"


class Manifest(Document):
    """The whole of manifest.json; every length in metres, elevations in the scan's coordinates."""

    what: ClassVar[str] = "stack"
    failure: ClassVar[type[StepfieldError]] = StackError
    remedy: ClassVar[str] = "build the stack again"

    format: Literal["stepfield-stack"] = "stepfield-stack"
    version: Literal[1] = VERSION
    generator: str
    source: Source
    parameters: Parameters
    grid: GridEntry
    base_elevation: Metres
    max_height: Metres
    image: ImageEntry
    layers: tuple[LayerEntry, ...]
    unassigned: Natural
    moves: Natural
    moves_unresolved: Natural
    seams: Natural
    links: Natural
    rounds: Natural
    converged: bool
    warnings: tuple[str, ...]
    complex: ComplexEntry | None = None

    @classmethod
    def of(cls, folder: Path) -> Manifest:
        """Read the manifest of the stack in ``folder``."""
        return cls.read(folder / FILE_NAME)

    def text(self) -> str:
        """Return the manifest as it is written."""
        return json.dumps(self.model_dump(mode="json"), ensure_ascii=False, indent=1, allow_nan=False) + "\n"


def image_name(index: int) -> str:
    """File name of a layer's image."""
    return f"layer_{index:02d}.png"


def mask_name(index: int) -> str:
    """File name of a layer's mask."""
    return f"layer_{index:02d}_mask.png"


def bottom_name(index: int) -> str:
    """File name of the image of a layer's lower ends."""
    return f"layer_{index:02d}_bottom.png"


def filled_name(index: int) -> str:
    """File name of the mask of what was filled in a layer."""
    return f"layer_{index:02d}_filled.png"


def clearance_name(index: int) -> str:
    """File name of the image of the room above a layer."""
    return f"layer_{index:02d}_clearance.png"


def describe(
    result: Reconstruction,
    lifted: int,
    complex_parts: ComplexParts | None = None,
    clearances: Mapping[int, ClearanceEntry] | None = None,
) -> Manifest:
    """Make the manifest of a reconstruction.

    Parameters
    ----------
    result : Reconstruction
        With its holes where a mesh stands in.
    lifted : int
        Pixels that were too low for the bit depth.
    complex_parts : ComplexParts, optional
        What is meshed.
    clearances : mapping of int to ClearanceEntry, optional
        What was written of the room above each layer, by its index.
    """
    grid, frame, scan = result.field.compartments.grid, result.frame, result.scan
    files = tuple(SourceEntry(name=f.name, sha256=f.sha256, points=f.points) for f in scan.files)
    return Manifest(
        generator=f"stepfield {stepfield.__version__}",
        source=Source(files=files, crs=scan.crs, unit=scan.unit, unit_factor=scan.unit_factor, up=scan.up),
        parameters=result.parameters,
        grid=GridEntry(
            origin=(grid.west, grid.south), cell_size=grid.cell_size, columns=grid.columns, rows=grid.rows
        ),
        base_elevation=result.base_elevation,
        max_height=result.max_height,
        image=ImageEntry(
            width=frame.width,
            height=frame.height,
            bits=result.parameters.bits,
            offset=(frame.column, frame.row),
        ),
        layers=tuple(_layer(layer, result, (clearances or {}).get(layer.index)) for layer in result.layers),
        unassigned=result.layering.unassigned,
        moves=len(result.outcomes),
        moves_unresolved=sum(not outcome.resolved for outcome in result.outcomes),
        seams=len(result.seams),
        links=len(result.links),
        rounds=result.automatic.rounds,
        converged=result.automatic.converged,
        warnings=warnings(result, lifted),
        complex=None if complex_parts is None else _complex(complex_parts),
    )


def _complex(parts: ComplexParts) -> ComplexEntry:
    mesh = parts.mesh
    return ComplexEntry(
        mesh=COMPLEX, vertices=len(mesh.vertices), triangles=len(mesh.triangles), pillars=parts.count
    )


def clearance_entry(index: int, drawn: ClearanceMap) -> ClearanceEntry:
    """Say what the image of the room above a layer means."""
    return ClearanceEntry(
        image=clearance_name(index),
        scale=drawn.scale,
        pillars=int(np.count_nonzero(drawn.gray)),
        least=drawn.least,
        greatest=drawn.greatest,
    )


def _layer(layer: Layer, result: Reconstruction, clearance: ClearanceEntry | None) -> LayerEntry:
    heights, scale = layer.heights, result.scale(layer)
    extent: dict[str, Any] = dict.fromkeys(("height_min", "height_max", "height_mean"))
    if len(heights):
        extent = {
            "height_min": float(heights.min()),
            "height_max": float(heights.max()),
            "height_mean": float(heights.mean()),
        }
    return LayerEntry(
        index=layer.index,
        name=layer.name,
        image=image_name(layer.index),
        mask=mask_name(layer.index),
        pillars=len(heights),
        scale=scale.step,
        offset=result.base_elevation + scale.zero,
        kind="obstacles" if layer.is_obstacles else "surface",
        bottom=bottom_name(layer.index) if layer.is_obstacles else None,
        clearance=clearance,
        filled_mask=filled_name(layer.index) if is_filled(result, layer) else None,
        filled=len(layer.filled.compartment),
        **extent,
    )


def is_filled(result: Reconstruction, layer: Layer) -> bool:
    """Whether holes of a layer were looked for, so that a mask says what was filled."""
    return result.parameters.fill != "none" and not layer.is_obstacles


def _why_unassigned(result: Reconstruction) -> str:
    unassigned = result.layering.layer == UNASSIGNED
    has_few = result.field.points < result.parameters.min_points
    was_assigned = result.automatic.layer != UNASSIGNED
    few, by_hand = (int(np.count_nonzero(unassigned & why)) for why in (has_few, was_assigned))
    crowded = result.layering.unassigned - few - by_hand
    reasons = {
        f"fewer than {result.parameters.min_points} points": few,
        f"more than {result.automatic.count} pillars in their compartment": crowded,
        "moved there by hand": by_hand,
    }
    return ", ".join(f"{n} {why}" for why, n in reasons.items() if n > 0)


def warnings(result: Reconstruction, lifted: int) -> tuple[str, ...]:
    """Say in sentences what the operator should know about a result."""
    found = list(result.scan.warnings)
    found += [f"{n} points dropped: {reason}" for reason, n in result.scan.removed.items() if n]
    if unassigned := result.layering.unassigned:
        found.append(
            f"{unassigned} of {len(result.field)} pillars are in no layer: {_why_unassigned(result)}"
        )
    if not result.automatic.converged:
        found.append(f"the classification had not settled after {result.automatic.rounds} rounds")
    for number, outcome in enumerate(result.outcomes, start=1):
        if not outcome.resolved:
            found.append(f"move {number} was not applied: {outcome.reason}")
    if left := sum(layer.filled.left for layer in result.layers):
        found.append(
            f"{left} compartments of holes were not filled: "
            f"another layer is there, or nearer than the tolerance"
        )
    if lifted:
        found.append(
            f"{lifted} pixels were too low for {result.parameters.bits} bits and became gray 1; "
            f"raise alpha or use 16 bits"
        )
    return tuple(found)
