"""A mesh as GLB, OBJ, STL or PLY: binary where the format is, the same bytes every time."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from stepfield.files import one_line
from stepfield.surface import Mesh

#: glTF is y up: east stays x, up becomes y, south becomes z.
TO_Y_UP = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], np.float32)
#: Linear red, green, blue, opacity of what has no picture.
GRAY = (0.6, 0.6, 0.6, 1.0)

_JSON, _BINARY = 0x4E4F534A, 0x004E4942
_FLOAT, _UINT = 5126, 5125
_VERTICES, _INDICES = 34962, 34963
_SIZES = {_VERTICES: "VEC3", _INDICES: "SCALAR"}

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_FACE = np.dtype([("count", "u1"), ("corners", "<i4", 3)])
#: Triangles are interleaved so many at a time, to spend no memory on a second copy of them.
_ROWS = 1 << 18


@dataclass(frozen=True)
class Titled:
    """What goes into a file beside the mesh: its name, and what was subtracted from the coordinates."""

    name: str
    local_origin: tuple[float, float, float]


def save(path: Path, mesh: Mesh, title: Titled) -> None:
    """Write a mesh in the format of the suffix; coordinates become float32.

    Parameters
    ----------
    path : Path
        ``.glb`` (turned to y up), ``.obj``, ``.stl`` and ``.ply`` (binary).
    mesh : Mesh
        In local coordinates, with at least one triangle.
    title : Titled
    """
    with path.open("wb") as file:
        _WRITERS[path.suffix](file, mesh, title)


def _glb(file: IO[bytes], mesh: Mesh, title: Titled) -> None:
    points = mesh.vertices.astype(np.float32) @ TO_Y_UP.T
    corners = mesh.triangles.astype("<u4").ravel()
    parts = [(points.astype("<f4"), _FLOAT, _VERTICES), (corners, _UINT, _INDICES)]
    scene = json.dumps(_scene(parts, title), separators=(",", ":")).encode()
    scene += b" " * (-len(scene) % 4)
    size = sum(values.nbytes for values, *_ in parts)  # multiples of 4 as they are
    file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(scene) + size))
    file.write(struct.pack("<II", len(scene), _JSON) + scene + struct.pack("<II", size, _BINARY))
    for values, *_ in parts:
        file.write(values.data)


def _scene(parts: list[tuple[NDArray[Any], int, int]], title: Titled) -> dict[str, Any]:
    """Return the JSON of a glTF file: one node with one mesh, seen from both sides."""
    views, accessors, start = [], [], 0
    for number, (values, kind, use) in enumerate(parts):
        views.append({"buffer": 0, "byteOffset": start, "byteLength": values.nbytes, "target": use})
        accessors.append(
            {"bufferView": number, "componentType": kind, "count": len(values), "type": _SIZES[use]}
        )
        start += values.nbytes
    points = parts[0][0]
    accessors[0] |= {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
    surface = {"attributes": {"POSITION": 0}, "indices": 1, "material": 0, "mode": 4}
    look = {"baseColorFactor": GRAY, "metallicFactor": 0.0, "roughnessFactor": 1.0}
    return {
        "asset": {"version": "2.0", "generator": "stepfield"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": title.name, "mesh": 0, "extras": {"local_origin": title.local_origin}}],
        "meshes": [{"name": title.name, "primitives": [surface]}],
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": look}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": start}],
    }


def _obj(file: IO[bytes], mesh: Mesh, title: Titled) -> None:
    file.write(f"# local_origin {title.local_origin}\no {'_'.join(one_line(title.name).split())}\n".encode())
    _rows(file, "v", mesh.vertices.astype(np.float32))
    _rows(file, "f", mesh.triangles + 1)


def _rows(file: IO[bytes], keyword: str, columns: NDArray[Any]) -> None:
    """Write lines of a keyword and three numbers, with the fewest digits that give them back."""
    import pyarrow
    from pyarrow import csv

    plain = csv.WriteOptions(include_header=False, delimiter=" ", quoting_style="none")
    keywords = pyarrow.DictionaryArray.from_arrays(
        pyarrow.array(np.zeros(len(columns), np.int8)), pyarrow.array([keyword])
    )
    values = [keywords.cast(pyarrow.string()), *(pyarrow.array(columns[:, i]) for i in range(3))]
    csv.write_csv(pyarrow.table(values, names=["keyword", "x", "y", "z"]), file, plain)


def _stl(file: IO[bytes], mesh: Mesh, title: Titled) -> None:
    # No "solid" at the start, by which readers tell text from binary.
    file.write(b"stepfield".ljust(80) + struct.pack("<I", len(mesh.triangles)))
    points = mesh.vertices.astype(np.float32)
    for start in range(0, len(mesh.triangles), _ROWS):
        corners = points[mesh.triangles[start : start + _ROWS]]
        facets = np.zeros(len(corners), _FACET)
        facets["corners"], facets["normal"] = corners, _normals(corners)
        file.write(facets.data)


def _normals(corners: NDArray[np.float32]) -> NDArray[np.float32]:
    a, b, c = (corners[:, i] for i in range(3))
    across = np.cross(b - a, c - a)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    return (across / np.where(length > 0, length, 1)).astype(np.float32)


def _ply(file: IO[bytes], mesh: Mesh, title: Titled) -> None:
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        f"comment local_origin {title.local_origin}",
        f"element vertex {len(mesh.vertices)}",
        *(f"property float {axis}" for axis in "xyz"),
        f"element face {len(mesh.triangles)}",
        "property list uchar int vertex_indices",
        "end_header\n",
    ]
    file.write("\n".join(lines).encode())
    file.write(mesh.vertices.astype("<f4").data)
    faces = np.empty(len(mesh.triangles), _FACE)
    faces["count"], faces["corners"] = 3, mesh.triangles
    file.write(faces.data)


_WRITERS: dict[str, Callable[[IO[bytes], Mesh, Titled], None]] = {
    ".glb": _glb,
    ".obj": _obj,
    ".stl": _stl,
    ".ply": _ply,
}
