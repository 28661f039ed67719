"""How true a result is, and where not: everything the panel and the map's overlays show."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from stepfield.clearance import clearance
from stepfield.fidelity import (
    Comparison,
    FilledFigures,
    Hidden,
    LayerFigures,
    compare_result,
    layer_figures,
    layers_of,
    near_gaps,
    result_filled_figures,
)
from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield_app.scenes.arrays import frozen
from stepfield_app.scenes.complex_parts import Meshed


@dataclass(frozen=True, eq=False)
class FidelityFacts:
    """How true a result is.

    Attributes
    ----------
    result : Reconstruction
    comparison : Comparison
        With the scan, or an even draw of its points.
    figures : tuple of LayerFigures
        One a layer.
    seams, links : int
    gaps : int
        Compartments with a gap near the tolerance.
    least_room : float
        The smallest clearance, metres; infinite where no layer has another one above it.
    filled : tuple of FilledFigures
        One a layer; none when holes are not to be filled.
    meshed : Meshed or None
        The mesh that stood in for complex pillars when points were compared.
    """

    result: Reconstruction
    comparison: Comparison
    figures: tuple[LayerFigures, ...]
    seams: int
    links: int
    gaps: int
    least_room: float
    filled: tuple[FilledFigures, ...] = ()
    meshed: Meshed | None = None

    @property
    def holes(self) -> tuple[int, float]:
        """Number and area (square metres) of the holes of all layers."""
        return sum(each.holes for each in self.figures), sum(each.hole_area for each in self.figures)

    @property
    def filled_holes(self) -> tuple[int, float]:
        """Number of holes that were filled, and area (square metres) of what was filled."""
        return sum(each.holes for each in self.filled), sum(each.area for each in self.filled)

    @property
    def hidden(self) -> Hidden | None:
        """How far off filled heights are likely to be; None if that is known of less than half of them."""
        known = [each for each in self.filled if each.hidden is not None]
        if 2 * sum(each.pixels for each in known) < sum(each.pixels for each in self.filled):
            return None
        return Hidden.joined([each.hidden for each in known if each.hidden is not None])

    @property
    def lost(self) -> float:
        """Share of the occupied area that a simulator does not draw."""
        occupied = sum(each.occupied_area for each in self.figures)
        drawn = sum(each.simulator_area for each in self.figures)
        return 1 - drawn / occupied if occupied else 0.0

    @property
    def vanished(self) -> tuple[int, int]:
        """Surfaces of which a simulator draws nothing, and all of them."""
        return sum(each.vanished for each in self.figures), sum(each.surfaces for each in self.figures)


def fidelity_facts(
    result: Reconstruction, most: int | None, progress: Progress, meshed: Meshed | None = None
) -> FidelityFacts:
    """Find out how true a result is.

    Parameters
    ----------
    result : Reconstruction
    most : int or None
        Points to compare at most, about; None compares all.
    progress : Progress
    meshed : Meshed, optional
        Complex parts of the result, whose mesh stands in for some of its pillars.
    """
    field, chosen = result.field, result.parameters
    step, tolerance = float(chosen.link_step), float(chosen.layer_tolerance)
    with ThreadPoolExecutor(1) as beside:  # what needs no points, while these are compared
        figures = beside.submit(layer_figures, field.compartments.grid, layers_of(result), step)
        links = beside.submit(lambda: (len(result.seams), len(result.links)))
        gaps = beside.submit(near_gaps, field.compartments, tolerance)
        room = beside.submit(clearance, field, result.layering.layer)
        filled = beside.submit(result_filled_figures, result)
        if meshed is None:
            comparison = compare_result(result, most=most, progress=progress)
        else:
            comparison = _with_mesh(result, meshed, most, progress)
    return FidelityFacts(
        result,
        comparison,
        figures.result(),
        *links.result(),
        gaps=len(gaps.result().gap),
        least_room=float(np.nanmin(room.result(), initial=np.inf)),
        filled=filled.result(),
        meshed=meshed,
    )


def _with_mesh(result: Reconstruction, meshed: Meshed, most: int | None, progress: Progress) -> Comparison:
    """Compare what is left of the layers and the mesh; of pillars it stands in for no error is known."""
    mesh = meshed.parts.mesh
    found = compare_result(meshed.rest_of(result), besides=[mesh], most=most, progress=progress)
    errors = []
    for layer, known in zip(result.layers, found.errors, strict=True):
        whole = np.full(len(layer.pillars), np.nan, np.float32)
        whole[~meshed.parts.replaced[layer.pillars]] = known
        errors.append(frozen(whole))
    return replace(found, errors=tuple(errors))
