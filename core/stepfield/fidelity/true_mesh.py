"""The truth as a mesh: of a synthetic scene, or from a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from stepfield.errors import SceneError
from stepfield.files import one_line
from stepfield.surface import Mesh

SUFFIXES = (".obj", ".ply", ".stl", ".off", ".glb", ".gltf")


def true_mesh(source: str) -> Mesh:
    """Return the true surfaces in scan coordinates, metres, z up.

    Parameters
    ----------
    source : str
        A mesh file in the scan's coordinates and metres, z up (glTF: y up, as that format is); a scene's
        name; or a scene's JSON description.

    Raises
    ------
    SceneError
        In one sentence.
    """
    from stepfield.synth import SCENES, synthesise  # the window, which has no truth, does not wait for it

    path = Path(source)
    if path.suffix.lower() in SUFFIXES:
        return _read(path)
    if source in SCENES or path.suffix.lower() == ".json":
        scene = synthesise(source, points=1).true_mesh
        return Mesh(scene.vertices, scene.triangles.astype(np.int64))
    raise SceneError(
        f"{source}: neither a mesh ({', '.join(SUFFIXES)}) nor a scene ({', '.join(SCENES)}); give one"
    )


def _read(path: Path) -> Mesh:
    if not path.is_file():
        raise SceneError(f"{path}: there is no such file; give the path of a mesh")
    try:
        import trimesh
    except ImportError:
        sentence = "reading meshes needs trimesh; install it with: pip install 'stepfield[simulate]'"
        raise SceneError(sentence) from None
    try:
        loaded: Any = trimesh.load(path, force="mesh", process=False)
        vertices, triangles = np.array(loaded.vertices, np.float64), np.array(loaded.faces, np.int64)
    except Exception as error:  # noqa: BLE001  whatever a damaged file makes of a reader
        raise SceneError(f"{path}: cannot be read as a mesh ({one_line(str(error))[:150]})") from None
    if not len(triangles) or not np.isfinite(vertices).all():
        raise SceneError(f"{path}: holds no triangles, or vertices that are nowhere; give another mesh")
    if path.suffix.lower() in {".glb", ".gltf"}:
        vertices = vertices[:, [0, 2, 1]] * [1, -1, 1]
    return Mesh(vertices, triangles)
