"""The scripts that load a folder's layers into PyBullet; nothing of a stack is written into them."""

_HEAD = '''"""Load the layers of this folder into PyBullet as static bodies; holes stay open."""

import json
import time
from pathlib import Path

import numpy as np
import pybullet

HERE = Path(__file__).resolve().parent
COLOURS = [(0.56, 0.53, 0.47), (0.30, 0.55, 0.75), (0.85, 0.55, 0.25), (0.40, 0.65, 0.40), (0.65, 0.45, 0.70)]
'''

_OF_RASTERS = '''TILE = 256  # quads along a side: a body may have 131072 vertices


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
        if "vertices" in layer:
            corners, triangles = (np.load(folder / layer[part]) for part in ("vertices", "triangles"))
            pieces = cut(corners + offset, triangles, stack["cell_size"])
            bodies[layer["label"]] = [body(*piece, tint, client) for piece in pieces]
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


'''

_OF_TRIANGLES = '''

def load(client=0, offset=(0.0, 0.0, 0.0), visible=True, folder=HERE):
    """Load every layer, moved by ``offset`` (metres); return the bodies of each by its label.

    Without ``visible`` cameras and the window do not see them, and a third of the memory is saved.
    """
    folder = Path(folder)
    stack = json.loads((folder / "stack.json").read_text(encoding="utf-8"))
    bodies = {}
    for i, layer in enumerate(stack["layers"]):
        tint = COLOURS[i % len(COLOURS)] if visible else None
        if "boxes" in layer:
            solids = np.load(folder / layer["boxes"]).reshape(-1, 2, 3)
            bodies[layer["label"]] = [box(place + offset, half, tint, client) for place, half in solids]
            continue
        vertices, triangles = (np.load(folder / layer[part]) for part in ("vertices", "triangles"))
        made = [body(*piece, tint, client) for piece in cut(vertices + offset, triangles, stack["cell_size"])]
        bodies[layer["label"]] = made
    return bodies


'''

_TAIL = '''PIECE = 160  # compartments along a side: a body may have 131072 vertices


def cut(vertices, triangles, cell_size):
    """Yield place, vertices and triangles of every square piece of a mesh."""
    west_south = vertices[:, :2].min(axis=0, initial=np.inf)
    row, column = np.floor((vertices[triangles, :2].min(axis=1) - west_south) / (PIECE * cell_size) + 1e-6).T
    piece = row * (column.max(initial=0) + 1) + column
    order = np.argsort(piece, kind="stable")
    for chosen in np.split(order, np.flatnonzero(np.diff(piece[order])) + 1):
        used, corners = np.unique(triangles[chosen], return_inverse=True)
        if len(used):
            part = vertices[used]
            middle = (part.min(axis=0) + part.max(axis=0)) / 2
            yield middle, part - middle, corners.reshape(-1, 3)


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
    return sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30)


if __name__ == "__main__":
    pybullet.connect(pybullet.GUI)
    pybullet.setGravity(0, 0, -9.81)
    for label, bodies in load().items():
        print(f"{label}: {len(bodies)} bodies")
    while pybullet.isConnected():
        time.sleep(0.1)
'''

#: Makes triangles of rasters, a vertex a sample.
FROM_RASTERS = _HEAD + _OF_RASTERS + _TAIL
#: Cuts triangles into pieces that Bullet can hold.
FROM_TRIANGLES = _HEAD + _OF_TRIANGLES + _TAIL
