"""What the modules of all targets take and give."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from stepfield.parameters import Way
from stepfield.targets.terrain import Terrain


@dataclass(frozen=True)
class Options:
    """What an operator may choose.

    Attributes
    ----------
    thicken : float or None
        Thickness in metres that closes the sheets of the meshes, downwards; None leaves them open.
    decimate : float or None
        Greatest vertical error of the decimated meshes in metres; None takes a quarter of a compartment.
    reconstruction : str or None
        Which surface the meshes have, whatever the stack was built with; None takes that.
    """

    thicken: float | None = None
    decimate: float | None = None
    reconstruction: Way | None = None


#: What is written unless an operator asks for more.
USUAL = Options()


@dataclass(frozen=True)
class Written:
    """What a target wrote.

    Attributes
    ----------
    files : tuple of str
        Relative to its folder, with forward slashes.
    notes : tuple of str
        Sentences an operator should read, what could not be held among them.
    """

    files: tuple[str, ...]
    notes: tuple[str, ...] = ()


def without_surface(terrain: Terrain, *, vertices: bool = False) -> list[str]:
    """Say which layers have nothing to drive on; with ``vertices`` where a sample can be but a vertex."""
    return [
        f"{layer.label} has no surface: "
        + ("nowhere do four neighbouring compartments have a pillar" if layer.occupied.any() else "no pillar")
        for layer in terrain.layers
        if not (layer.quads.any() if vertices else terrain.has_body(layer))
    ]


class Target(Protocol):
    """A module of this package."""

    def write(self, terrain: Terrain, folder: Path, options: Options) -> Written:
        """Fill an empty folder; raise TargetError in one sentence where the target cannot hold it."""

    def limits(self, terrain: Terrain) -> list[str]:
        """Say in sentences what of this terrain the target cannot hold, and what becomes of it."""
