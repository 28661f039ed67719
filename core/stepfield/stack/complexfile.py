"""complex.ply: the mesh of the complex parts in scan coordinates, exact to the last bit of a float64."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stepfield.errors import StackError
from stepfield.surface import Mesh

FILE_NAME = "complex.ply"
_FACE = np.dtype([("count", "u1"), ("corners", "<i4", 3)])


def save_complex(path: Path, mesh: Mesh) -> None:
    """Write a mesh as binary PLY, the same bytes for the same mesh."""
    faces = np.empty(len(mesh.triangles), _FACE)
    faces["count"], faces["corners"] = 3, mesh.triangles
    with path.open("wb") as file:
        file.write(_header(len(mesh.vertices), len(faces)))
        file.write(mesh.vertices.astype("<f8").tobytes())
        file.write(faces.tobytes())


def load_complex(path: Path, vertices: int, triangles: int) -> Mesh:
    """Read a mesh that :func:`save_complex` wrote.

    Parameters
    ----------
    path : Path
    vertices, triangles : int
        As the manifest says.

    Raises
    ------
    StackError
        In one sentence, when the file is missing, damaged, or another one.
    """
    head = _header(vertices, triangles)
    whole = len(head) + 24 * vertices + _FACE.itemsize * triangles
    try:
        if path.stat().st_size != whole:
            raise StackError(f"{path}: is not the mesh that the manifest describes; build the stack again")
        content = path.read_bytes()
    except OSError:
        raise StackError(f"{path}: the mesh is missing; build the stack again") from None
    places = np.frombuffer(content, "<f8", 3 * vertices, len(head)).reshape(-1, 3)
    faces = np.frombuffer(content, _FACE, triangles, len(head) + 24 * vertices)
    corners = faces["corners"].astype(np.int64)
    if (
        not content.startswith(head)
        or not np.isfinite(places).all()
        or (faces["count"] != 3).any()
        or (corners.size and (corners.min() < 0 or corners.max() >= vertices))
    ):
        raise StackError(f"{path}: the mesh is damaged; build the stack again")
    return Mesh(places, corners)


def _header(vertices: int, triangles: int) -> bytes:
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        f"element vertex {vertices}",
        *(f"property double {axis}" for axis in "xyz"),
        f"element face {triangles}",
        "property list uchar int vertex_indices",
        "end_header\n",
    ]
    return "\n".join(lines).encode()
