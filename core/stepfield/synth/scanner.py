"""A virtual terrestrial laser scanner: what a real scan has and a drawn cloud has not.

Rays of a regular angular grid are cast from every scan position against the true mesh, so the cloud
has shadows behind things and thins out with distance. Then the measurement is spoilt as real ones
are: range noise, no echo at grazing incidence, mixed echoes at edges (the "comet tails" between an
edge and what lies behind it) and a few wild outliers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stepfield.errors import SceneError
from stepfield.progress import Progress, silent
from stepfield.synth.geometry import Floats, Indices
from stepfield.synth.scene import Scene, SyntheticScan, TrueMesh, true_mesh

if TYPE_CHECKING:
    import open3d as o3d

#: Elevation angles the scanner turns through, degrees: it cannot see its own tripod.
_LOWEST, _HIGHEST = -62.0, 90.0
#: Range at which the noise has doubled, metres; it grows in proportion.
_DOUBLED_AT = 20.0
#: Cosine of incidence below which an echo is more likely lost than not.
_GRAZING = 0.03
#: Ranges of neighbouring rays that differ by this much (metres) share a spot on an edge; at a wider gap
#: the scanner tells the two echoes apart.
_EDGE, _TELLS_APART = 0.08, 2.5
_MIXED_SHARE = 0.35
_OUTLIER_SHARE = 0.001
#: Rays of a trial scan, and the most cast at once.
_TRIAL, _BAND = 40_000, 1_000_000

Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class _Echoes:
    """What a band of the angular grid returns; arrays of shape (rows, columns), directions (…, 3)."""

    directions: Floats
    ranges: Floats
    normals: Floats
    surface: Indices

    @property
    def hit(self) -> Bools:
        return self.surface >= 0


class _Target:
    """The true mesh, ready for rays. Open3D keeps float32, so coordinates are about the mesh's middle."""

    def __init__(self, mesh: TrueMesh) -> None:
        import open3d as o3d

        self._o3d = o3d
        self._owner = mesh.surface
        self._middle: Floats = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
        self._scene: o3d.t.geometry.RaycastingScene = o3d.t.geometry.RaycastingScene()
        self._scene.add_triangles(
            o3d.core.Tensor.from_numpy((mesh.vertices - self._middle).astype(np.float32)),
            o3d.core.Tensor.from_numpy(mesh.triangles.astype(np.uint32)),
        )

    def cast(self, origin: Floats, directions: Floats) -> _Echoes:
        """Echoes of rays from ``origin`` (3,) along unit ``directions`` (rows, columns, 3)."""
        rays = np.empty((*directions.shape[:2], 6), np.float32)
        rays[..., :3] = origin - self._middle
        rays[..., 3:] = directions
        answer = self._scene.cast_rays(self._o3d.core.Tensor.from_numpy(rays))
        ranges = answer["t_hit"].numpy().astype(np.float64)
        triangle = answer["primitive_ids"].numpy()
        hit = np.isfinite(ranges)
        surface = np.full(ranges.shape, -1, np.int32)
        surface[hit] = self._owner[triangle[hit]]
        ranges[~hit] = 0.0
        return _Echoes(directions, ranges, answer["primitive_normals"].numpy().astype(np.float64), surface)


def scan(
    scene: Scene, points: int, noise: float | None, rng: np.random.Generator, progress: Progress = silent
) -> SyntheticScan:
    """Scan a scene from its scan positions.

    Parameters
    ----------
    scene : Scene
    points : int
        About how many points to return: it sets the angle between rays, the same everywhere.
    noise : float or None
        Standard deviation of a range close by, metres; it doubles within 20 m. None takes the scene's.
    rng : numpy.random.Generator
    progress : Progress

    Raises
    ------
    SceneError
        When no ray hits anything.
    """
    mesh = true_mesh(scene)
    target = _Target(mesh)
    positions = _positions(scene, mesh)
    sigma = scene.noise if noise is None else noise
    step = _step(target, positions, points, rng)
    clouds, owners, seen_from = [], [], []
    for number, position in enumerate(positions):
        for directions, share in _bands(step, rng):
            progress((number + share) / len(positions), f"scanning from position {number + 1}")
            cloud, owner = _measured(target.cast(position, directions), position, sigma, rng)
            clouds.append(cloud)
            owners.append(owner)
            seen_from.append(np.full(len(owner), number, np.int32))
    progress(1.0, "scanned")
    return SyntheticScan(
        points=np.concatenate(clouds),
        surface=np.concatenate(owners),
        names=tuple(surface.name for surface in scene.surfaces),
        true_mesh=mesh,
        scan_positions=positions,
        seen_from=np.concatenate(seen_from),
    )


def _positions(scene: Scene, mesh: TrueMesh) -> Floats:
    """The scene's scan positions, or four around it at a tripod's height and one above."""
    if scene.scan_positions:
        return np.array(scene.scan_positions, float)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    away = 1 + 0.3 * float((high - low).max())
    x, y = (low[:2] + high[:2]) / 2
    eye = low[2] + max(1.6, 0.4 * float(high[2] - low[2]))
    around = [
        (low[0] - away, y, eye),
        (high[0] + away, y, eye),
        (x, low[1] - away, eye),
        (x, high[1] + away, eye),
    ]
    return np.array([*around, (x, y, high[2] + away)])


def _step(target: _Target, positions: Floats, points: int, rng: np.random.Generator) -> float:
    """Angle between rays (radians) that returns about ``points`` points in all, from a coarse trial."""
    trial = np.sqrt(2 * np.pi * np.radians(_HIGHEST - _LOWEST) / _TRIAL)
    found = 0
    for position in positions:
        for directions, _ in _bands(trial, rng):
            found += len(_measured(target.cast(position, directions), position, 0.0, rng)[0])
    if not found:
        raise SceneError("no ray from any scan position hits the scene; move the scan_positions closer to it")
    return float(trial * np.sqrt(found / points))


def _bands(step: float, rng: np.random.Generator) -> Iterator[tuple[Floats, float]]:
    """Unit directions of the angular grid in bands of rows, shape (rows, columns, 3), and the share done."""
    columns = max(4, round(2 * np.pi / step))
    azimuth = np.arange(columns) * (2 * np.pi / columns) + rng.uniform(0, 2 * np.pi)
    elevation = np.arange(np.radians(_LOWEST) + step * rng.uniform(0, 1), np.radians(_HIGHEST), step)
    rows = max(1, _BAND // columns)
    for start in range(0, len(elevation), rows):
        up = elevation[start : start + rows, None]
        parts = np.broadcast_arrays(np.cos(up) * np.cos(azimuth), np.cos(up) * np.sin(azimuth), np.sin(up))
        yield np.stack(parts, axis=-1), start / len(elevation)


def _measured(
    echoes: _Echoes, position: Floats, sigma: float, rng: np.random.Generator
) -> tuple[Floats, Indices]:
    """Points (N, 3) and their surfaces (N,) as the scanner reports them."""
    kept = echoes.hit & ~_lost(echoes, rng)
    ranges, surface = _mixed(echoes, rng)
    ranges, surface = _strayed(ranges, surface, rng)
    ranges = ranges + rng.normal(0, 1, ranges.shape) * sigma * (1 + ranges / _DOUBLED_AT)
    points: Floats = position + echoes.directions[kept] * ranges[kept][:, None]
    return points, surface[kept]


def _lost(echoes: _Echoes, rng: np.random.Generator) -> Bools:
    """Echoes that do not come back, the likelier the more grazing the incidence."""
    facing = np.abs((echoes.directions * echoes.normals).sum(axis=-1))
    lost: Bools = rng.random(facing.shape) < np.exp(-np.log(2) * facing / _GRAZING)
    return lost


def _mixed(echoes: _Echoes, rng: np.random.Generator) -> tuple[Floats, Indices]:
    """Ranges and surfaces after rays whose spot lies on an edge have returned something in between."""
    ranges, surface = echoes.ranges.copy(), echoes.surface.copy()
    for axis in (0, 1):
        here, there = (_shifted(axis, stop) for stop in (False, True))
        edge = _across_edge(echoes, here, there) & (rng.random(echoes.ranges[here].shape) < _MIXED_SHARE)
        between = rng.random(edge.shape)
        near, far = echoes.ranges[here], echoes.ranges[there]
        ranges[here] = np.where(edge, near + between * (far - near), ranges[here])
        surface[here] = np.where(edge, -1, surface[here])
    return ranges, surface


def _shifted(axis: int, far: bool) -> tuple[slice, slice]:
    """Every ray but the last along ``axis``, or every ray but the first."""
    part = slice(1, None) if far else slice(None, -1)
    return (part, slice(None)) if axis == 0 else (slice(None), part)


def _across_edge(echoes: _Echoes, here: tuple[slice, slice], there: tuple[slice, slice]) -> Bools:
    """Whether the ranges of two neighbours jump, and not because the surface between them is slanted."""
    near, far = echoes.ranges[here], echoes.ranges[there]
    apart = np.abs(far - near)
    between = echoes.directions[there] * far[..., None] - echoes.directions[here] * near[..., None]
    off_plane = np.minimum(
        np.abs((between * echoes.normals[here]).sum(axis=-1)),
        np.abs((between * echoes.normals[there]).sum(axis=-1)),
    )
    both: Bools = echoes.hit[here] & echoes.hit[there]
    jump: Bools = both & (apart > _EDGE) & (apart < _TELLS_APART) & (off_plane > _EDGE)
    return jump


def _strayed(ranges: Floats, surface: Indices, rng: np.random.Generator) -> tuple[Floats, Indices]:
    """Ranges and surfaces after a few echoes have come from nowhere, in front or behind."""
    stray = rng.random(ranges.shape) < _OUTLIER_SHARE
    factor = rng.uniform(0.2, 1.4, ranges.shape)
    return np.where(stray, ranges * factor, ranges), np.where(stray, np.int32(-1), surface)
