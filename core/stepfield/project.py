"""The project file: which scans, which parameters, which pillars were moved by hand."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from stepfield.boxes import Boxes
from stepfield.document import Document
from stepfield.errors import ProjectError, StepfieldError
from stepfield.files import write_atomically
from stepfield.parameters import Coordinate, Frozen, Parameters

VERSION: Literal[1] = 1

#: Where the pillars of a move go in its JSON.
_NO_PILLARS = b'"pillars": []'
#: What happens where two pillars claim one place. swap: they change places. leave: the present one keeps it.
#: fewest: the one of fewer points (ties: the higher) becomes unassigned. exchange: of two whole layers, all.
Conflict = Literal["swap", "leave", "fewest", "exchange"]


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
    """The layer of a number, or the nearest in elevation of its kind once there are more layers, or fewer."""

    layer: Annotated[int, Field(ge=0)]
    of: Annotated[int, Field(ge=1)]
    elevation: Coordinate
    kind: Literal["obstacles"] | None = Field(None, description="obstacles, or else a surface")


class NewLayer(Frozen):
    """A layer of the operator's own, made by the first move that names it."""

    new: Annotated[str, Field(min_length=1)]


AnyLayer = ExistingLayer | NewLayer


class Move(Frozen):
    """What was done by hand: some pillars, or those of a whole layer, put into another layer.

    Pillars are remembered by where they are in the world. A move to a new layer of neither pillars nor a
    layer makes it. A layer that is merged into another one (``fewest``) or removed (to ``unassigned``)
    vanishes, and the numbers above it shift down; nothing else renumbers.
    """

    text: str = ""
    to: ExistingLayer | NewLayer | Literal["unassigned"]
    conflict: Conflict = "swap"
    pillars: Boxes = Boxes()
    layer: AnyLayer | None = Field(None, description="all pillars of this layer, instead of places")
    above: Coordinate | None = Field(None, description="of that layer only those above, metres")

    @model_validator(mode="after")
    def _names_pillars_once(self) -> Self:
        if self.layer is None and (self.above is not None or self.conflict == "exchange"):
            raise ValueError("a layer is needed to take the pillars from")
        if self.layer is not None and len(self.pillars):
            raise ValueError("either pillars or a layer can be moved, not both")
        if self.conflict == "exchange" and (self.to == "unassigned" or self.above is not None):
            raise ValueError("only two whole layers can be exchanged")
        return self

    def boxes(self) -> NDArray[np.float64]:
        """Return the places as an array of shape (N, 6), metres."""
        return self.pillars.array


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

    def content(self) -> bytes:
        """Return the project as its file holds it: the same bytes for an equal project."""
        bare = tuple(move.model_copy(update={"pillars": Boxes()}) for move in self.moves)
        text = self.model_copy(update={"moves": bare}).model_dump_json(exclude_none=True, indent=1).encode()
        first, *others = text.split(_NO_PILLARS)  # in a text of the operator's, quotes would be escaped
        lists = (move.pillars.listed() for move in self.moves)
        filled = (b'"pillars": ' + boxes + rest for boxes, rest in zip(lists, others, strict=True))
        return b"".join((first, *filled, b"\n"))

    def save(self, path: Path) -> None:
        """Write the project whole or not at all."""
        write_atomically(path, self.content(), ProjectError)

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
