"""A reconstruction -> its complex parts (paper 7)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.complex_parts.detection import detect, dilated
from stepfield.complex_parts.job import Job
from stepfield.complex_parts.parts import ComplexParts
from stepfield.complex_parts.points import owned_points
from stepfield.complex_parts.process import mesh_apart
from stepfield.complex_parts.residuals import residuals
from stepfield.complex_parts.thinning import Thinning
from stepfield.progress import Progress, part, silent
from stepfield.reconstruction import Reconstruction
from stepfield.surface import Mesh

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]

#: Points are evened out to so many a compartment's side before they are meshed.
POINTS_A_SIDE = 2
#: Points to mesh at most, about a minute's work; where they would be more they are evened out further.
MOST_POINTS = 500_000


def build_complex_parts(result: Reconstruction, progress: Progress = silent) -> ComplexParts:
    """Find where the height-maps fail and mesh just that.

    1. How far the points of every pillar are from the surface of its layer.
    2. Pillars further than ``complex_residual`` are complex, unless they stand alone and are no posts.
    3. Their points and those a compartment around them are evened out and meshed; flat parts are reduced,
       and what is left is drawn to the points.
    4. Where the mesh is nearer to the points than the pillar is, it stands in for it.

    The same reconstruction gives the same mesh every time.

    Parameters
    ----------
    result : Reconstruction
        Of all points, no preview.
    progress : Progress
        May raise Cancelled.

    Raises
    ------
    StepfieldError
        When the meshing fails, in one sentence.
    """
    residual = residuals(result, part(progress, 0, 0.2))
    found = detect(result, residual)
    if not found.any():
        return _parts(found, found.copy(), Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64)))
    gathered = _gathered(result, found, part(progress, 0.2, 0.3))
    done = mesh_apart(gathered.job, part(progress, 0.3, 1))
    number = np.bincount(gathered.pillar, minlength=len(found))
    squares = np.bincount(gathered.pillar, np.square(done.distances), len(found))
    with np.errstate(invalid="ignore", divide="ignore"):
        nearer = np.sqrt(squares / number) < residual
    compartments = result.field.compartments
    corner = np.array([compartments.grid.west, compartments.grid.south, compartments.lowest])
    return _parts(found, found & nearer, Mesh(done.mesh.vertices + corner, done.mesh.triangles))


@dataclass(frozen=True, eq=False)
class _Gathered:
    """The job, and the pillar of each of its samples."""

    job: Job
    pillar: NDArray[np.int64]


def _gathered(result: Reconstruction, found: Flags, progress: Progress) -> _Gathered:
    """Gather the points to mesh, with an overlap of a compartment, and those of the complex pillars."""
    spacing = result.field.compartments.grid.cell_size / POINTS_A_SIDE
    thinning, overlapping = Thinning(spacing), dilated(result, found)
    samples: list[Floats] = []
    pillars = []
    for owned in owned_points(result.scan, result.field, progress):
        thinning.add(owned.places[overlapping[owned.pillar]])
        own = found[owned.pillar]
        samples.append(owned.places[own])
        pillars.append(owned.pillar[own])
    spacing, points = _bounded(spacing, thinning.means())
    return _Gathered(Job(spacing, points, np.concatenate(samples)), np.concatenate(pillars))


def _bounded(spacing: float, points: Floats) -> tuple[float, Floats]:
    """Double the distance of the points until they are no more than a mesh of them can have."""
    while len(points) > MOST_POINTS:
        spacing *= 2
        coarser = Thinning(spacing)
        coarser.add(points)
        points = coarser.means()
    return spacing, points


def _parts(found: Flags, replaced: Flags, mesh: Mesh) -> ComplexParts:
    for array in _arrays(found, replaced, mesh):
        array.flags.writeable = False
    return ComplexParts(found, replaced, mesh)


def _arrays(found: Flags, replaced: Flags, mesh: Mesh) -> Iterator[NDArray[np.generic]]:
    yield from (found, replaced, mesh.vertices, mesh.triangles)
