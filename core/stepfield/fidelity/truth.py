"""Against the truth: the surfaces that a synthetic scan was drawn from, or a mesh that is known to be right.

Both ways: how far the reconstruction is from the truth where there is one (accuracy), and how far the truth
is from the reconstruction (completeness). Samples lie evenly over the areas and are the same every time.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.fidelity.figures import Distances
from stepfield.fidelity.measure import measure
from stepfield.fidelity.reconstructions import (
    Way,
    bottoms_of,
    chosen_way,
    layers_of,
    meshes_of,
    surface_of,
)
from stepfield.fidelity.surface import Surface
from stepfield.progress import Progress, part, silent
from stepfield.reconstruction import Reconstruction
from stepfield.surface import Mesh

Floats = NDArray[np.float64]

#: Samples of either surface.
SAMPLES = 200_000


@dataclass(frozen=True)
class TruthFidelity:
    """How true a reconstruction is to the true surfaces; nearest distances, metres.

    Attributes
    ----------
    accuracy : Distances
        From the reconstruction to the truth: what is there but wrong.
    completeness : Distances
        From the truth to the reconstruction: what is missing; its ``explained`` is the share of the true area
        that the reconstruction comes near to.
    """

    accuracy: Distances
    completeness: Distances

    def as_dict(self) -> dict[str, Any]:
        """Return the figures by name, ready for JSON."""
        return {name: getattr(self, name).as_dict() for name in asdict(self)}


def against_truth(
    meshes: list[Mesh],
    surface: Surface,
    truth: Mesh,
    tolerance: float,
    *,
    samples: int = SAMPLES,
    progress: Progress = silent,
) -> TruthFidelity:
    """Compare a reconstruction with the truth, both ways.

    Parameters
    ----------
    meshes : list of Mesh
        The reconstruction.
    surface : Surface
        The same, to measure from.
    truth : Mesh
        Scan coordinates, metres.
    tolerance : float
        Metres.
    samples : int
        Of either surface.
    progress : Progress
    """
    there = measure(sampled(meshes, samples), Surface.of([truth]), part(progress, 0, 0.5))
    back = measure(sampled([truth], samples), surface, part(progress, 0.5, 1))
    return TruthFidelity(*(Distances.of(each.nearest, tolerance) for each in (there, back)))


def result_against_truth(
    result: Reconstruction,
    truth: Mesh,
    way: Way | None = None,
    *,
    samples: int = SAMPLES,
    progress: Progress = silent,
) -> TruthFidelity:
    """Compare a result with the truth, reconstructed as its parameters say unless another way is given."""
    chosen = result.parameters
    of = (
        result.field.compartments.grid,
        layers_of(result),
        way or chosen_way(chosen),
        float(chosen.link_step),
        bottoms_of(result),
    )
    tolerance = float(chosen.layer_tolerance)
    made = meshes_of(*of), surface_of(*of)
    return against_truth(*made, truth, tolerance, samples=samples, progress=progress)


def sampled(meshes: list[Mesh], count: int) -> Floats:
    """Places spread evenly over the area of meshes, shape (about ``count``, 3), the same every time.

    Every triangle gets its share by area, rounded so that the sum of those before it is right; its samples
    follow a low-discrepancy sequence.
    """
    corners = np.concatenate([np.zeros((0, 3, 3)), *(mesh.vertices[mesh.triangles] for mesh in meshes)])
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.cumsum(np.linalg.norm(np.cross(one, other), axis=1))
    if not len(area) or area[-1] <= 0:
        return np.zeros((0, 3))
    place = (np.arange(count) + 0.5) / count * area[-1]
    triangle = np.minimum(np.searchsorted(area, place), len(area) - 1)
    # The plastic number's powers: consecutive terms fill a square evenly.
    u, v = ((np.arange(1, count + 1) * step) % 1 for step in (0.7548776662466927, 0.5698402909980532))
    beyond = u + v > 1
    u[beyond], v[beyond] = 1 - u[beyond], 1 - v[beyond]
    places: Floats = corners[triangle, 0] + u[:, np.newaxis] * one[triangle]
    places += v[:, np.newaxis] * other[triangle]
    return places
