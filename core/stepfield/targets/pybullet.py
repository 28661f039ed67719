"""PyBullet: a raster a layer, NaN in its holes, and a script that makes bodies of them.

Bullet's own height-fields leave out triangles where a sample is NaN, not quads, so that corners of holes
would stay half covered; and they take three times the memory. So the script makes triangles.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stepfield.targets.boxes import boxes
from stepfield.targets.target import Options, Written
from stepfield.targets.terrain import Terrain, TerrainLayer
from stepfield.targets.text import number, readme, write_text

SCRIPT = "load_stack.py"
PLACES = "stack.json"
#: What Bullet was measured to take, megabytes and seconds for a million samples.
MEMORY, TIME = 1400, 6


def write(terrain: Terrain, folder: Path, options: Options) -> Written:
    """Write the rasters, what they mean, the loader and a README."""
    files = tuple(_file(layer) for layer in terrain.layers)
    for file, layer in zip(files, terrain.layers, strict=True):
        np.save(
            folder / file, _solids(terrain, layer) if layer.is_obstacles else layer.elevations.astype("<f4")
        )
    write_text(folder / PLACES, _places(terrain))
    write_text(folder / SCRIPT, LOADER)
    notes = tuple(limits(terrain))
    write_text(folder / "README.txt", readme(terrain, "PyBullet", _steps(terrain), notes))
    return Written((PLACES, SCRIPT, *files, "README.txt"), notes)


def limits(terrain: Terrain) -> list[str]:
    """Say which layers have no surface."""
    return [
        f"{layer.name}: nowhere do four samples meet, so the layer has no surface and no body"
        for layer in terrain.layers
        if not layer.has_body
    ]


def _file(layer: TerrainLayer) -> str:
    return f"{layer.label}_boxes.npy" if layer.is_obstacles else f"{layer.label}.npy"


def _solids(terrain: Terrain, layer: TerrainLayer) -> NDArray[np.float64]:
    """Return the middle of every box of a layer of obstacles, and half its size; shape (n, 6)."""
    return np.array([(*box.middle, *box.half) for box in boxes(terrain, layer)], "<f8").reshape(-1, 6)


def _places(terrain: Terrain) -> str:
    layers = [
        {"label": layer.label, "name": layer.name, "boxes" if layer.is_obstacles else "file": _file(layer)}
        for layer in terrain.layers
    ]
    values = {
        "name": terrain.name,
        "cell_size": terrain.cell_size,
        "west": terrain.west,
        "north": terrain.north,
        "local_origin": terrain.local_origin,
        "layers": layers,
    }
    return json.dumps(values, indent=1) + "\n"


def _steps(terrain: Terrain) -> str:
    samples = sum(int(layer.occupied.sum()) for layer in terrain.layers) / 1e6
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
contacts. Large layers are several bodies. Loading takes about {number(max(1.0, round(samples * TIME)))} s \
and {number(max(1.0, round(samples * MEMORY)))} MB.

The files
layer_NN.npy   float32 elevations in metres, row 0 north, column 0 west, NaN a hole, a sample a vertex
layer_NN_boxes.npy   obstacles: x, y, z of the middle of every box, and half its size
{PLACES}     cell size, place of the north-west sample, local_origin, names
{SCRIPT}  needs numpy and pybullet only
"""


#: Nothing of a stack is written into the script, so that no name can break it.
LOADER = '''"""Load the layers of this folder into PyBullet as static bodies; holes stay open."""

import json
import time
from pathlib import Path

import numpy as np
import pybullet

HERE = Path(__file__).resolve().parent
COLOURS = [(0.56, 0.53, 0.47), (0.30, 0.55, 0.75), (0.85, 0.55, 0.25), (0.40, 0.65, 0.40), (0.65, 0.45, 0.70)]
TILE = 256  # quads along a side: a body may have 131072 vertices


def load(client=0, offset=(0.0, 0.0, 0.0), visible=True, folder=HERE):
    """Load every layer, moved by ``offset`` (metres); return the bodies of each by its label.

    Without ``visible`` cameras and the window do not see them, and a third of the memory is saved.
    """
    folder = Path(folder)
    stack = json.loads((folder / "stack.json").read_text(encoding="utf-8"))
    corner = stack["west"] + offset[0], stack["north"] + offset[1], offset[2]
    bodies = {}
    for i, layer in enumerate(stack["layers"]):
        tint = COLOURS[i % len(COLOURS)] if visible else None
        if "boxes" in layer:
            solids = np.load(folder / layer["boxes"]).reshape(-1, 2, 3)
            bodies[layer["label"]] = [box(place + offset, half, tint, client) for place, half in solids]
            continue
        raster = np.load(folder / layer["file"]).astype(float)
        made = [body(*tile, tint, client) for tile in tiles(raster, corner, stack["cell_size"])]
        bodies[layer["label"]] = made
    return bodies


def tiles(raster, corner, cell_size):
    """Yield place, vertices and triangles of every piece of a raster that has a quad."""
    for row in range(0, max(1, raster.shape[0] - 1), TILE):
        for column in range(0, max(1, raster.shape[1] - 1), TILE):
            part = raster[row : row + TILE + 1, column : column + TILE + 1]
            vertices, triangles = mesh(part, cell_size)
            if len(triangles):
                middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
                place = np.array(corner) + [column * cell_size, -row * cell_size, 0] + middle
                yield place, vertices - middle, triangles


def mesh(raster, cell_size):
    """Return vertices from the north-west sample and triangles, a quad where all four samples are there."""
    number = np.arange(raster.size).reshape(raster.shape)
    north, south = number[:-1], number[1:]
    quads = np.stack([north[:, :-1], south[:, :-1], south[:, 1:], north[:, 1:]], axis=-1).reshape(-1, 4)
    quads = quads[~np.isnan(raster.ravel()[quads]).any(axis=1)]
    used, quads = np.unique(quads, return_inverse=True)
    row, column = np.divmod(used, raster.shape[1])
    vertices = np.column_stack([column * cell_size, -row * cell_size, raster.ravel()[used]])
    return vertices, quads.reshape(-1, 4)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def body(place, vertices, triangles, colour, client):
    """Make one static body; concave, or else Bullet would fill it up to its convex hull."""
    mesh = {"vertices": vertices.tolist(), "indices": triangles.ravel().tolist(), "physicsClientId": client}
    concave = pybullet.GEOM_FORCE_CONCAVE_TRIMESH
    shape, look = pybullet.createCollisionShape(pybullet.GEOM_MESH, flags=concave, **mesh), -1
    if colour is not None:
        seen = {"normals": normals(vertices, triangles).tolist(), "rgbaColor": (*colour, 1)}
        look = pybullet.createVisualShape(pybullet.GEOM_MESH, **seen, **mesh)
    return pybullet.createMultiBody(0, shape, look, basePosition=place.tolist(), physicsClientId=client)


def box(place, half, colour, client):
    """Make one static box, of a wall or a column."""
    extent = {"halfExtents": half.tolist(), "physicsClientId": client}
    shape, look = pybullet.createCollisionShape(pybullet.GEOM_BOX, **extent), -1
    if colour is not None:
        look = pybullet.createVisualShape(pybullet.GEOM_BOX, rgbaColor=(*colour, 1), **extent)
    return pybullet.createMultiBody(0, shape, look, basePosition=place.tolist(), physicsClientId=client)


def normals(vertices, triangles):
    """Return the direction in which the surface looks at every vertex."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    faces, sums = np.cross(b - a, c - a), np.zeros_like(vertices)
    for i in range(3):
        np.add.at(sums, triangles[:, i], faces)
    return sums / np.linalg.norm(sums, axis=1, keepdims=True)


if __name__ == "__main__":
    pybullet.connect(pybullet.GUI)
    pybullet.setGravity(0, 0, -9.81)
    for label, bodies in load().items():
        print(f"{label}: {len(bodies)} bodies")
    while pybullet.isConnected():
        time.sleep(0.1)
'''
