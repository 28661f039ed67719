"""The project file: which scans, which parameters, which pillars were moved by hand."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from stepfield.document import Document
from stepfield.errors import ProjectError, StepfieldError
from stepfield.files import write_atomically
from stepfield.parameters import Coordinate, Frozen, Parameters

VERSION: Literal[1] = 1

#: x0, y0, x1, y1 of a compartment and the lowest and highest elevation of the pillar in it, in metres.
PillarBox = tuple[Coordinate, Coordinate, Coordinate, Coordinate, Coordinate, Coordinate]


class ScanFile(Frozen):
    """A scan the project is made from."""

    path: str
    sha256: str | None = None


class LayerStyle(Frozen):
    """What the operator changed about a layer."""

    index: Annotated[int, Field(ge=0)]
    name: str | None = None
    color: str | None = None
    visible: bool = True
    locked: bool = False


class ExistingLayer(Frozen):
    """The layer of a number, or the nearest in elevation once the number of layers has changed."""

    layer: Annotated[int, Field(ge=0)]
    of: Annotated[int, Field(ge=1)]
    elevation: Coordinate


class NewLayer(Frozen):
    """A layer of the operator's own, made by the first move that names it."""

    new: Annotated[str, Field(min_length=1)]


class Move(Frozen):
    """Some pillars put into another layer by hand, remembered by where they are in the world."""

    text: str = ""
    to: ExistingLayer | NewLayer | Literal["unassigned"]
    conflict: Literal["swap", "leave"] = "swap"
    pillars: tuple[PillarBox, ...]

    def boxes(self) -> NDArray[np.float64]:
        """Return the places as an array of shape (N, 6), metres."""
        return np.asarray(self.pillars, np.float64).reshape(-1, 6)


class Project(Document):
    """All that is needed to make the same stack again."""

    what: ClassVar[str] = "project"
    failure: ClassVar[type[StepfieldError]] = ProjectError
    remedy: ClassVar[str] = "restore a copy"

    format: Literal["stepfield-project"] = "stepfield-project"
    version: Literal[1] = VERSION
    scans: tuple[ScanFile, ...] = ()
    parameters: Parameters = Parameters()
    layers: tuple[LayerStyle, ...] = ()
    moves: tuple[Move, ...] = ()
    view: dict[str, Any] = Field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write the project whole or not at all."""
        text = json.dumps(self.model_dump(mode="json", exclude_none=True), ensure_ascii=False, indent=1)
        write_atomically(path, text.encode() + b"\n", ProjectError)

    def scan_paths(self, project_file: Path) -> tuple[Path, ...]:
        """Where the scans are, as seen from the project file."""
        return tuple(project_file.parent / scan.path for scan in self.scans)

    @staticmethod
    def stored_path(scan: Path, project_file: Path) -> str:
        """Return the path to store for ``scan``: relative to the project where that is possible."""
        try:
            return os.path.relpath(scan, project_file.parent)
        except ValueError:  # another drive on Windows
            return str(scan.resolve())
