"""Complex parts: the mesh that stands in for pillars, and where the layers have holes for it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stepfield.complex_parts import ComplexParts, without
from stepfield.layers import UNASSIGNED
from stepfield.reconstruction import Reconstruction
from stepfield_app.ramps import ramp
from stepfield_app.render.scene import Triangles
from stepfield_app.scenes.arrays import frozen, steps
from stepfield_app.scenes.surfaces import shaded
from stepfield_app.scenes.suspects import Cells
from stepfield_app.theme import COMPLEX_COLOUR, rgb

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Meshed:
    """Complex parts and the result they were found in."""

    result: Reconstruction
    parts: ComplexParts

    def belongs_to(self, result: Reconstruction) -> bool:
        """Whether they are the complex parts of a result: names and alpha change nothing about them."""
        mine = self.result
        return (
            mine.scan is result.scan
            and mine.field is result.field
            and mine.layering is result.layering
            and (mine.parameters.link_step, mine.parameters.complex_residual)
            == (result.parameters.link_step, result.parameters.complex_residual)
            and result.parameters.complex_parts == "mesh"
        )

    def rest_of(self, result: Reconstruction) -> Reconstruction:
        """Return a result they belong to with its holes, and what was there in no layer."""
        layer = np.where(self.parts.replaced, UNASSIGNED, result.layering.layer)
        return replace(without(result, self.parts), layering=replace(result.layering, layer=frozen(layer)))


def complex_mesh(meshed: Meshed, origin: Floats, span: tuple[float, float] | None = None) -> Triangles:
    """Return the mesh in local coordinates.

    Parameters
    ----------
    meshed : Meshed
    origin : ndarray of shape (3,)
        Scan coordinates, metres.
    span : tuple of float, optional
        Local elevations between which heights are coloured; all in one colour by default.
    """
    mesh = meshed.parts.mesh
    vertices = (mesh.vertices - origin).astype(np.float32)
    colours = np.array(rgb(COMPLEX_COLOUR), np.uint8)
    if span is not None:
        colours = ramp("height")[steps(vertices[:, 2], *span, 256)]
    # Which side of it is solid is unknown where a scanner has seen but one.
    return shaded(vertices, mesh.triangles.astype(np.int32), colours, both_sides=True)


def complex_cells(meshed: Meshed, layer: int) -> Cells:
    """Find the compartments of a layer that a mesh stands in for."""
    result = meshed.result
    chosen = np.flatnonzero(meshed.parts.replaced & (result.layering.layer == layer))
    grid = result.field.compartments.grid
    squares = grid.squares(result.field.compartment[chosen])
    kind = np.zeros(len(chosen), np.uint8)
    return Cells(frozen(squares[:, 0].copy()), frozen(squares[:, 3].copy()), frozen(kind), grid.cell_size)
