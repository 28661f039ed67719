"""Synthetic scans with the truth kept: the paper's scenes, larger ones, and scenes from a JSON file.

A reconstruction can only be called right against something known. Everything here is drawn from
surfaces with an equation, so every point knows which surface it came from and the surfaces
themselves are kept as a mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from stepfield.errors import ParameterError, SceneError
from stepfield.progress import Progress, silent
from stepfield.synth import scenes, structures
from stepfield.synth.description import MOST_POINTS, read_description
from stepfield.synth.rubble import rubble
from stepfield.synth.scene import Scene, SyntheticScan, TrueMesh, sample

__all__ = ["SCENES", "SyntheticScan", "TrueMesh", "synthesise"]

_BUILDERS: dict[str, Callable[[np.random.Generator], Scene]] = {
    "three-planes": lambda _: scenes.three_planes(),
    "inclined-plane": lambda _: scenes.inclined_plane(),
    "crossing-plane": lambda _: scenes.crossing_plane(),
    "cylinder": lambda _: scenes.cylinder(),
    "table": lambda _: scenes.table(),
    "bridge": lambda _: structures.bridge(),
    "stairs": lambda _: structures.stairs(),
    "ramp": lambda _: structures.ramp(),
    "rubble": rubble,
}

#: Names of the scenes that come with the program.
SCENES = tuple(_BUILDERS)


def synthesise(
    scene: str | Path,
    points: int | None = None,
    noise: float | None = None,
    seed: int = 0,
    scanner: bool = False,
    progress: Progress = silent,
) -> SyntheticScan:
    """Make a synthetic scan.

    Parameters
    ----------
    scene : str or Path
        One of :data:`SCENES`, or the path of a JSON file describing one.
    points : int, optional
        Points of the cloud (a scanner comes close to it); the scene's own number by default.
    noise : float, optional
        Standard deviation in metres, for every surface; the scene's own by default.
    seed : int
        Equal seeds and arguments give equal clouds.
    scanner : bool
        Scan the scene by casting rays from scan positions instead of drawing points on it.
    progress : Progress

    Raises
    ------
    SceneError
        When the scene is unknown or wrongly described.
    ParameterError
        When the number of points, the noise or the seed is impossible.
    """
    _check(points, noise, seed)
    layout, drawing = np.random.default_rng(seed).spawn(2)
    described = find(scene, layout)
    wanted = described.points if points is None else points
    if not scanner:
        return sample(described, wanted, noise, drawing, progress)
    # Open3D takes seconds to import, and only scanning needs it.
    from stepfield.synth.scanner import scan

    return scan(described, wanted, noise, drawing, progress)


def find(scene: str | Path, rng: np.random.Generator) -> Scene:
    """Find the scene of that name or in that JSON file; ``rng`` lays out what is random in it."""
    if isinstance(scene, str) and scene in _BUILDERS:
        return _BUILDERS[scene](rng)
    path = Path(scene)
    if isinstance(scene, str) and path.suffix.lower() != ".json":
        raise SceneError(f'no scene is called "{scene}"; choose {", ".join(SCENES)}, or give a .json file')
    return read_description(path)


def _check(points: int | None, noise: float | None, seed: int) -> None:
    if points is not None and not 1 <= points <= MOST_POINTS:
        raise ParameterError(f"points is {points:,}, outside 1 to {MOST_POINTS:,}; give a number in between")
    if noise is not None and not 0 <= noise <= 1e3:
        raise ParameterError(f"noise is {noise} m, outside 0 to 1000 m; give a number in between")
    if seed < 0:
        raise ParameterError(f"seed is {seed}; give zero or a positive whole number")
