"""PyBullet: triangles a layer, or a raster, NaN in its holes; and a script that makes bodies of them.

Bullet's own height-fields leave out triangles where a sample is NaN, not quads, so that corners of holes
would stay half covered; and they take three times the memory. So the script makes triangles.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.surface import Mesh
from stepfield.targets.boxes import boxes
from stepfield.targets.complexmesh import LABEL, TITLE
from stepfield.targets.pybulletscripts import FROM_RASTERS, FROM_TRIANGLES
from stepfield.targets.target import Options, Written
from stepfield.targets.terrain import Terrain, TerrainLayer
from stepfield.targets.text import number, readme, write_text

SCRIPT = "load_stack.py"
PLACES = "stack.json"
#: What Bullet was measured to take, megabytes and seconds for a million triangles.
MEMORY, TIME = 700, 3
#: How far the triangles may be from the layer's surface, metres: coplanar ones become one, little else.
CLOSE = 1e-3


def write(terrain: Terrain, folder: Path, options: Options) -> Written:
    """Write the rasters, what they mean, the loader and a README."""
    bound = CLOSE if options.decimate is None else options.decimate
    entries = [_layer(terrain, layer, bound, folder) for layer in terrain.layers]
    complex_files = {} if terrain.complex_mesh is None else _triangles(folder, LABEL, terrain.complex_mesh)
    files = [file for entry in (*entries, complex_files) for file in entry.values()]
    write_text(folder / PLACES, _places(terrain, entries, complex_files))
    write_text(folder / SCRIPT, FROM_TRIANGLES if terrain.reconstruction == "edges" else FROM_RASTERS)
    notes = tuple(limits(terrain))
    write_text(
        folder / "README.txt",
        readme(terrain, "PyBullet", _steps(terrain, bound, _count(terrain, folder, entries)), notes),
    )
    return Written((PLACES, SCRIPT, *files, "README.txt"), notes)


def _layer(terrain: Terrain, layer: TerrainLayer, bound: float, folder: Path) -> dict[str, str]:
    """Write a layer; return which file holds what."""
    if layer.is_obstacles:
        return _save(folder, f"{layer.label}_boxes.npy", "boxes", _solids(terrain, layer))
    if terrain.reconstruction == "simulator":
        return _save(folder, f"{layer.label}.npy", "file", layer.elevations.astype("<f4"))
    return _triangles(folder, layer.label, terrain.surface(layer, bound))


def _triangles(folder: Path, label: str, mesh: Mesh) -> dict[str, str]:
    corners = _save(folder, f"{label}_vertices.npy", "vertices", mesh.vertices.astype("<f4"))
    return corners | _save(folder, f"{label}_triangles.npy", "triangles", mesh.triangles.astype("<i4"))


def _save(folder: Path, file: str, what: str, values: NDArray[Any]) -> dict[str, str]:
    np.save(folder / file, values)
    return {what: file}


def _solids(terrain: Terrain, layer: TerrainLayer) -> NDArray[np.float64]:
    """Return the middle of every box of a layer of obstacles, and half its size; shape (n, 6)."""
    return np.array([(*box.middle, *box.half) for box in boxes(terrain, layer)], "<f8").reshape(-1, 6)


def limits(terrain: Terrain) -> list[str]:
    """Say which layers have no surface."""
    why = "there is no pillar" if terrain.reconstruction == "edges" else "nowhere do four samples meet"
    return [
        f"{layer.name}: {why}, so the layer has no surface and no body"
        for layer in terrain.layers
        if not terrain.has_body(layer)
    ]


def _places(terrain: Terrain, entries: Sequence[dict[str, str]], complex_files: dict[str, str]) -> str:
    layers = [
        {"label": layer.label, "name": layer.name} | files
        for files, layer in zip(entries, terrain.layers, strict=True)
    ]
    if complex_files:
        layers.append({"label": LABEL, "name": TITLE} | complex_files)
    values = {
        "name": terrain.name,
        "cell_size": terrain.cell_size,
        "west": terrain.west,
        "north": terrain.north,
        "local_origin": terrain.local_origin,
        "layers": layers,
    }
    return json.dumps(values, indent=1) + "\n"


def _count(terrain: Terrain, folder: Path, entries: Sequence[dict[str, str]]) -> int:
    """Count the triangles that the script makes or loads; of a raster, about two a sample."""
    saved = [folder / entry["triangles"] for entry in entries if "triangles" in entry]
    rasters = [layer for layer, entry in zip(terrain.layers, entries, strict=False) if "file" in entry]
    made = sum(2 * int(layer.occupied.sum()) for layer in rasters)
    return made + sum(len(np.load(path, mmap_mode="r")) for path in saved)


def _steps(terrain: Terrain, bound: float, triangles: int) -> str:
    seconds, megabytes = (max(1.0, round(triangles / 1e6 * cost)) for cost in (TIME, MEMORY))
    return f"""
How to use it
1. Look at it:    python {SCRIPT}
2. In a program, with this folder on sys.path:

     import pybullet
     from load_stack import load

     pybullet.connect(pybullet.DIRECT)
     bodies = load()                      # {{"layer_00": [body, ...], ...}}

   load(visible=False) saves a third of the memory where nothing looks.

Every body is static (mass 0) and made of triangles, obstacles are boxes; a hole is a hole for rays and for
contacts. Large layers are several bodies. Loading takes about {number(seconds)} s \
and {number(megabytes)} MB.

The files
{_about_files(terrain, bound)}
layer_NN_boxes.npy   obstacles: x, y, z of the middle of every box, and half its size
{LABEL}_vertices.npy, {LABEL}_triangles.npy   what height-maps cannot hold, where the stack has any of it
{PLACES}     cell size, place of the north-west sample, local_origin, names
{SCRIPT}  needs numpy and pybullet only
"""


def _about_files(terrain: Terrain, bound: float) -> str:
    if terrain.reconstruction == "simulator":
        return (
            "layer_NN.npy   float32 elevations in metres, row 0 north, column 0 west, NaN a hole, "
            "a sample a vertex"
        )
    return f"""layer_NN_vertices.npy   float32 (n, 3), metres, local coordinates
layer_NN_triangles.npy  int32 (n, 3), counter-clockwise seen from above: exactly the compartments of the
               pillars, nowhere further than {number(bound)} m above or below the surface (--decimate M)"""
