"""A scene, and the cloud drawn from it with the truth kept beside every point.

The paper (section 2) puts points onto the surface of each object at random and adds noise at the
end; the same is done here, surface after surface, then the points are shuffled, because a cloud
whose order betrays its surfaces would flatter whatever reads it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.progress import Progress, silent
from stepfield.synth.geometry import Floats, Indices, Pose, Shape, Triple, merged, placed_mesh

#: Noise along the surface's normal (its plan stays as described) or the same in every direction.
NoiseKind = Literal["normal", "isotropic"]

#: Points drawn at once: few enough to stay in the cache, enough for numpy to be quick.
_CHUNK = 200_000


@dataclass(frozen=True, eq=False)
class Surface:
    """One named surface of a scene.

    Attributes
    ----------
    name : str
    shape : Shape
    pose : Pose
    noise : float or None
        Standard deviation in metres; None takes the scene's.
    noise_kind : {"normal", "isotropic"}
    """

    name: str
    shape: Shape
    pose: Pose = field(default_factory=Pose)
    noise: float | None = None
    noise_kind: NoiseKind = "normal"


@dataclass(frozen=True, eq=False)
class Scene:
    """Surfaces, and how they are sampled when the caller does not say.

    Attributes
    ----------
    surfaces : tuple of Surface
    points : int
        Points of the whole cloud.
    weights : tuple of float or None
        Share of the points every surface gets; None shares them by area.
    noise : float
        Standard deviation in metres.
    scan_positions : tuple of (x, y, z)
        Where a virtual scanner stands, metres.
    """

    surfaces: tuple[Surface, ...]
    points: int = 100_000
    weights: tuple[float, ...] | None = None
    noise: float = 0.005
    scan_positions: tuple[Triple, ...] = ()


@dataclass(frozen=True, eq=False)
class TrueMesh:
    """The surfaces a cloud was drawn from, as triangles.

    Attributes
    ----------
    vertices : ndarray of shape (V, 3)
        Metres, z up.
    triangles : ndarray of shape (T, 3), int32
    surface : ndarray of shape (T,), int32
        Which surface every triangle belongs to.
    """

    vertices: Floats
    triangles: Indices
    surface: Indices


@dataclass(frozen=True, eq=False)
class SyntheticScan:
    """A cloud and the truth about it.

    Attributes
    ----------
    points : ndarray of shape (N, 3), float64
        Metres, z up.
    surface : ndarray of shape (N,), int32
        Which surface every point comes from; -1 for a scanner's stray points.
    names : tuple of str
        Names of the surfaces.
    true_mesh : TrueMesh
    scan_positions : ndarray of shape (S, 3), float64
        Where the scanner stood, metres; empty for a cloud that was drawn, not scanned.
    seen_from : ndarray of shape (N,), int32
        Index of the scan position that saw the point; -1 for a cloud that was drawn.
    """

    points: Floats
    surface: Indices
    names: tuple[str, ...]
    true_mesh: TrueMesh
    scan_positions: Floats
    seen_from: Indices

    def __post_init__(self) -> None:
        mesh = self.true_mesh
        own = (self.points, self.surface, self.scan_positions, self.seen_from)
        for array in (*own, mesh.vertices, mesh.triangles, mesh.surface):
            array.setflags(write=False)

    def __len__(self) -> int:
        return len(self.points)


def true_mesh(scene: Scene) -> TrueMesh:
    """Triangles of every surface of a scene."""
    meshes = [placed_mesh(surface.shape, surface.pose) for surface in scene.surfaces]
    owner = np.repeat(np.arange(len(meshes), dtype=np.int32), [len(mesh.triangles) for mesh in meshes])
    whole = merged(meshes)
    return TrueMesh(whole.vertices, whole.triangles, owner)


def sample(
    scene: Scene, points: int, noise: float | None, rng: np.random.Generator, progress: Progress = silent
) -> SyntheticScan:
    """Draw a cloud from a scene: points on every surface, then noise, then a shuffle (paper, section 2).

    Parameters
    ----------
    scene : Scene
    points : int
        Points of the whole cloud.
    noise : float or None
        Standard deviation in metres for every surface; None takes the scene's own.
    rng : numpy.random.Generator
    progress : Progress
    """
    counts = shares(points, _weights(scene))
    cloud = np.empty((points, 3))
    done = 0
    for surface, count in zip(scene.surfaces, counts.tolist(), strict=True):
        sigma = _sigma(scene, surface, noise)
        for start in range(done, done + count, _CHUNK):
            stop = min(start + _CHUNK, done + count)
            progress(start / points, f"drawing {surface.name}")
            cloud[start:stop] = _draw(surface, stop - start, sigma, rng)
        done += count
    order = rng.permutation(points)
    owner = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    progress(1.0, "drawn")
    return SyntheticScan(
        points=cloud.take(order, axis=0),
        surface=owner.take(order),
        names=tuple(surface.name for surface in scene.surfaces),
        true_mesh=true_mesh(scene),
        scan_positions=np.empty((0, 3)),
        seen_from=np.broadcast_to(np.int32(-1), (points,)),
    )


def shares(total: int, weights: Floats) -> NDArray[np.int64]:
    """Split ``total`` in proportion to ``weights``, exactly; the largest remainders are rounded up."""
    exact = total * (weights / weights.sum())
    counts: NDArray[np.int64] = np.floor(exact).astype(np.int64)
    short = total - int(counts.sum())
    counts[np.argsort(counts - exact, kind="stable")[:short]] += 1
    return counts


def _weights(scene: Scene) -> Floats:
    if scene.weights is not None:
        return np.array(scene.weights, float)
    return np.array([surface.shape.area for surface in scene.surfaces])


def _sigma(scene: Scene, surface: Surface, noise: float | None) -> float:
    if noise is not None:
        return noise
    return scene.noise if surface.noise is None else surface.noise


def _draw(surface: Surface, count: int, sigma: float, rng: np.random.Generator) -> Floats:
    """Points of one surface with their noise, in the scene's coordinates."""
    points, normals = surface.shape.draw(count, rng)
    if sigma > 0 and surface.noise_kind == "normal":
        points += normals * rng.normal(0, sigma, count)[:, None]
    elif sigma > 0:
        points += rng.normal(0, sigma, (count, 3))
    return surface.pose.place(points)
