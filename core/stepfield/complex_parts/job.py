"""What the meshing process is given and gives back: files of a folder, so that nothing is copied by hand."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Mesh

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Job:
    """Points to mesh, and points to measure the mesh by.

    Attributes
    ----------
    spacing : float
        Distance of the points to mesh, about; metres.
    points : ndarray of shape (V, 3), float64
        To mesh; metres from the scan's lowest corner.
    samples : ndarray of shape (n, 3), float64
        To measure by.
    """

    spacing: float
    points: Floats
    samples: Floats

    def save(self, folder: Path) -> None:
        """Write the job."""
        np.save(folder / "spacing.npy", np.array(self.spacing))
        np.save(folder / "points.npy", self.points)
        np.save(folder / "samples.npy", self.samples)

    @classmethod
    def load(cls, folder: Path) -> Job:
        """Read a job."""
        spacing = float(np.load(folder / "spacing.npy"))
        return cls(spacing, np.load(folder / "points.npy"), np.load(folder / "samples.npy"))


@dataclass(frozen=True, eq=False)
class Done:
    """The mesh, and the distances of the samples to it, shape (n,), metres."""

    mesh: Mesh
    distances: Floats

    def save(self, folder: Path) -> None:
        """Write what became of a job."""
        np.save(folder / "vertices.npy", self.mesh.vertices)
        np.save(folder / "triangles.npy", self.mesh.triangles)
        np.save(folder / "distances.npy", self.distances)

    @classmethod
    def load(cls, folder: Path) -> Done:
        """Read what became of a job."""
        mesh = Mesh(np.load(folder / "vertices.npy"), np.load(folder / "triangles.npy"))
        return cls(mesh, np.load(folder / "distances.npy"))
