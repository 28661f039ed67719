"""A result against its scan: everything that says how true it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.fidelity.errors import mean_errors
from stepfield.fidelity.figures import Fidelity
from stepfield.fidelity.measure import measure
from stepfield.fidelity.reconstructions import (
    NO_BOTTOMS,
    Bottoms,
    Layers,
    Way,
    bottoms_of,
    chosen_way,
    layers_of,
    surface_of,
)
from stepfield.grid import Grid
from stepfield.progress import Progress, part, silent
from stepfield.reconstruction import Reconstruction
from stepfield.scan import Scan
from stepfield.surface import Mesh

Singles = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Comparison:
    """A reconstruction compared with a scan.

    Attributes
    ----------
    fidelity : Fidelity
    errors : tuple of ndarray of shape (pillars of the layer,), float32
        Mean error of each pillar, as :func:`~stepfield.fidelity.errors.mean_errors` returns it.
    """

    fidelity: Fidelity
    errors: tuple[Singles, ...]


def compare(
    scan: Scan,
    grid: Grid,
    layers: Layers,
    way: Way,
    link_step: float,
    tolerance: float,
    *,
    bottoms: Bottoms = NO_BOTTOMS,
    besides: Sequence[Mesh] = (),
    most: int | None = None,
    progress: Progress = silent,
) -> Comparison:
    """Compare the surfaces of layers with a scan.

    Parameters
    ----------
    scan : Scan
        Cleaned as it was for the layers.
    grid : Grid
    layers : sequence of tuple of ndarray
        Compartments and elevations of each layer's pillars.
    way : str
        How they are reconstructed.
    link_step, tolerance : float
        Metres.
    bottoms : mapping of int to ndarray
        Where the pillars of layers of obstacles begin.
    besides : sequence of Mesh
        What else is there: the mesh of complex parts.
    most : int, optional
        Of a scan with more points, compare an even draw of about so many.
    progress : Progress
    """
    progress(0.0, "reconstructing the layers")
    surface = surface_of(grid, layers, way, link_step, bottoms, besides)
    chosen = scan if most is None else scan.thinned(most)
    measured = measure(chosen, surface, part(progress, 0.1, 0.95))
    fidelity = Fidelity.of_measured(measured, len(scan), tolerance, surface.reach)
    return Comparison(fidelity, mean_errors(chosen, measured, grid, layers))


def compare_result(
    result: Reconstruction,
    way: Way | None = None,
    *,
    besides: Sequence[Mesh] = (),
    most: int | None = None,
    progress: Progress = silent,
) -> Comparison:
    """Compare a result with its scan, reconstructed as its parameters say unless another way is given.

    See :func:`compare`.
    """
    chosen = result.parameters
    return compare(
        result.scan,
        result.field.compartments.grid,
        layers_of(result),
        way or chosen_way(chosen),
        float(chosen.link_step),
        float(chosen.layer_tolerance),
        bottoms=bottoms_of(result),
        besides=besides,
        most=most,
        progress=progress,
    )
