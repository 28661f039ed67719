"""What the window asks of the core, and what it gets back: frozen values, both."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from stepfield.parameters import Parameters
from stepfield.project import LayerStyle, Move, Project
from stepfield.reconstruction import Reconstruction
from stepfield_app.scenes.summary import LayerSummary, summaries

DEFAULTS = Parameters()


@dataclass(frozen=True)
class Request:
    """One run of the method.

    Attributes
    ----------
    scans : tuple of Path
        Files of one scan.
    parameters : Parameters
    moves : tuple of Move
    styles : tuple of LayerStyle
    quick : bool
        Whether a preview from fewer points will do.
    """

    scans: tuple[Path, ...]
    parameters: Parameters = DEFAULTS
    moves: tuple[Move, ...] = ()
    styles: tuple[LayerStyle, ...] = ()
    quick: bool = False


@dataclass(frozen=True)
class Answer:
    """What a request led to, and how long that took in seconds."""

    request: Request
    result: Reconstruction
    seconds: float

    def summaries(self) -> tuple[LayerSummary, ...]:
        """Summarise the layers, the lowest first, Unassigned last; worked out once."""
        return self._summaries

    @cached_property
    def _summaries(self) -> tuple[LayerSummary, ...]:
        return summaries(self.result)


def paths_of(project: Project) -> tuple[Path, ...]:
    """Where the scans of an open project are."""
    return tuple(Path(scan.path) for scan in project.scans)


def request_for(project: Project) -> Request:
    """Return the request whose answer shows a project: of styles, only names take part in the method."""
    named = tuple(LayerStyle(index=style.index, name=style.name) for style in project.layers if style.name)
    return Request(paths_of(project), project.parameters, project.moves, named)
