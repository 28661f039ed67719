"""Gazebo (gz-sim): a world, and a model a layer: a mesh, or a height-map for a lowest one without holes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stepfield.stack.write import save_gray
from stepfield.surface import Mesh
from stepfield.targets.boxes import as_boxes
from stepfield.targets.complexmesh import LABEL, TITLE
from stepfield.targets.meshfiles import Titled, save
from stepfield.targets.sdf import Heightmap, MeshShape, Model, config, model, world
from stepfield.targets.target import Options, Written, without_surface
from stepfield.targets.terrain import Raster, Terrain, TerrainLayer
from stepfield.targets.text import as_word, number, numbers, readme, write_text
from stepfield.targets.thickening import thickened

WORLD, MESHES_ONLY = "world.sdf", "world_meshes.sdf"
#: The mesh of the complex parts in its model.
COMPLEX_MESH = f"meshes/{LABEL}.stl"
#: Where Gazebo is told to look for models.
MODELS = "models"
#: How far meshes may be from the layer's surface, metres: coplanar triangles become one, little else.
CLOSE = 1e-3
#: A height-map has to be square; a layer that fills less of it than this becomes a mesh.
LEAST_SHARE = 0.125
#: A height-map has to rise, as its scale is made of its range.
LEAST_SPAN = 1e-3


@dataclass(frozen=True)
class Square:
    """A whole layer in the square image that Gazebo takes, its edges repeated east- and southwards.

    Attributes
    ----------
    elevations : ndarray of shape (side, side), float32
    low, high : float
        The lowest and highest elevation.
    """

    elevations: Raster
    low: float
    high: float

    @classmethod
    def around(cls, layer: TerrainLayer) -> Square | None:
        """Return the square of a layer; None if it has holes, is level, or would be lost in a square."""
        rows, columns = layer.elevations.shape
        side = (1 << (max(rows, columns) - 2).bit_length()) + 1 if max(rows, columns) > 1 else 0
        if not layer.is_whole or rows * columns < LEAST_SHARE * side * side:
            return None
        low, high = float(layer.elevations.min()), float(layer.elevations.max())
        if high - low < LEAST_SPAN:
            return None
        beyond = [(0, side - rows), (0, side - columns)]
        return cls(np.pad(layer.elevations, beyond, mode="edge"), low, high)

    @property
    def side(self) -> int:
        """Samples along a side: a power of two and one."""
        return len(self.elevations)

    def shape(self, terrain: Terrain, uri: str) -> Heightmap:
        """Return where it stands and how large it is.

        What is seen puts the samples a (side - 1)th of the size apart, the physics a (side)th: each gets
        the size that makes it a compartment.
        """
        cell, between = terrain.cell_size, self.side - 1
        middle = (terrain.west + between * cell / 2, terrain.north - between * cell / 2, self.low)
        return Heightmap(uri, middle, between * cell, self.side * cell, self.high - self.low)

    def save(self, path: Path) -> None:
        """Write 16 bits a pixel; the brightest is the highest, as Gazebo takes it to be."""
        share = (self.elevations.astype(np.float64) - self.low) / (self.high - self.low)
        save_gray(path, np.rint(share * 65535).astype(np.uint16))


def write(terrain: Terrain, folder: Path, options: Options) -> Written:
    """Write the models and the worlds that include them."""
    models, files = [], []
    for layer in terrain.layers:
        if terrain.has_body(layer):
            made = _mesh_model(terrain, layer)
            files += _write_model(terrain, folder, made)
            _save_mesh(folder / MODELS / made.name / _mesh_name(layer), terrain, layer, options)
            files.append(f"{MODELS}/{made.name}/{_mesh_name(layer)}")
            models.append(made)
    if terrain.complex_mesh is not None:
        made = _complex_model(terrain)
        files += _write_model(terrain, folder, made)
        path = folder / MODELS / made.name / COMPLEX_MESH
        path.parent.mkdir(parents=True)
        save(path, terrain.complex_mesh, Titled(TITLE, terrain.local_origin))
        files.append(f"{MODELS}/{made.name}/{COMPLEX_MESH}")
        models.append(made)
    files += _write_worlds(terrain, folder, models)
    notes = limits(terrain)
    text = readme(terrain, "Gazebo", _steps(terrain, options, [made.name for made in models]), notes)
    write_text(folder / "README.txt", text)
    return Written((*files, "README.txt"), tuple(notes))


def limits(terrain: Terrain) -> list[str]:
    """Say what becomes of layers without a surface, and where a height-map goes on beyond the scan."""
    found = without_surface(terrain)
    square = _square(terrain)
    if square is not None and (terrain.rows, terrain.columns) != square.elevations.shape:
        east, south = square.side - terrain.columns, square.side - terrain.rows
        found.append(
            f"Gazebo's height-maps are square: that of layer_00 goes on level for "
            f"{number(east * terrain.cell_size)} m to the east and "
            f"{number(south * terrain.cell_size)} m to the south; {MESHES_ONLY} does not"
        )
    return found


def _square(terrain: Terrain) -> Square | None:
    """Return the lowest layer's height-map; by nature it is what a simulator draws, and cut at the sides."""
    if terrain.reconstruction == "edges" or not terrain.layers:
        return None
    return Square.around(terrain.layers[0])


def _write_worlds(terrain: Terrain, folder: Path, meshes: Sequence[Model]) -> list[str]:
    """Write the world, and if it has a height-map, another one of meshes alone."""
    square = _square(terrain)
    if square is None:
        write_text(folder / WORLD, world(_word(terrain), meshes))
        return [WORLD]
    ground = _heightmap_model(terrain, terrain.layers[0], square)
    files = _write_model(terrain, folder, ground)
    image = f"{MODELS}/{ground.name}/materials/textures/{terrain.layers[0].label}.png"
    (folder / image).parent.mkdir(parents=True)
    square.save(folder / image)
    write_text(folder / WORLD, world(_word(terrain), [ground, *meshes[1:]]))
    write_text(folder / MESHES_ONLY, world(_word(terrain), meshes))
    return [*files, image, WORLD, MESHES_ONLY]


def _write_model(terrain: Terrain, folder: Path, made: Model) -> list[str]:
    files = {"model.sdf": model(made), "model.config": config(made, f"{made.title} of {terrain.name}")}
    for name, text in files.items():
        write_text(folder / MODELS / made.name / name, text)
    return [f"{MODELS}/{made.name}/{name}" for name in files]


def _mesh_model(terrain: Terrain, layer: TerrainLayer) -> Model:
    name = _model_name(terrain, layer)
    return Model(name, layer.name, layer.index, MeshShape(f"model://{name}/{_mesh_name(layer)}"))


def _complex_model(terrain: Terrain) -> Model:
    name = f"{_word(terrain)}_{LABEL}"
    return Model(name, TITLE, len(terrain.layers), MeshShape(f"model://{name}/{COMPLEX_MESH}"))


def _heightmap_model(terrain: Terrain, layer: TerrainLayer, square: Square) -> Model:
    name = _heightmap_name(terrain)
    uri = f"model://{name}/materials/textures/{layer.label}.png"
    return Model(name, layer.name, layer.index, square.shape(terrain, uri))


def _word(terrain: Terrain) -> str:
    return as_word(terrain.name) or "terrain"


def _model_name(terrain: Terrain, layer: TerrainLayer) -> str:
    return f"{_word(terrain)}_{layer.label}"


def _heightmap_name(terrain: Terrain) -> str:
    return f"{_model_name(terrain, terrain.layers[0])}_heightmap"


def _mesh_name(layer: TerrainLayer) -> str:
    return f"meshes/{layer.label}.stl"


def _save_mesh(path: Path, terrain: Terrain, layer: TerrainLayer, options: Options) -> None:
    path.parent.mkdir(parents=True)
    save(path, _body(terrain, layer, options), Titled(layer.name, terrain.local_origin))


def _body(terrain: Terrain, layer: TerrainLayer, options: Options) -> Mesh:
    if layer.is_obstacles:
        return as_boxes(terrain, layer, options.decimate)
    sheet = terrain.surface(layer, CLOSE if options.decimate is None else options.decimate)
    return sheet if options.thicken is None else thickened(sheet, options.thicken)


def _steps(terrain: Terrain, options: Options, names: Sequence[str]) -> str:
    bound = CLOSE if options.decimate is None else options.decimate
    lines = [
        "In this folder:",
        f"    GZ_SIM_RESOURCE_PATH=$PWD/{MODELS} gz sim {WORLD}",
        "(IGN_GAZEBO_RESOURCE_PATH and ign gazebo with Fortress). To put the terrain into another world,",
        f"copy what is in {MODELS}/ to where its models are and include, at the pose 0 0 0 0 0 0:",
        *(f"    model://{name}" for name in names),
        "",
        f"Meshes (STL) hold the layers with their holes, nowhere further than {number(bound)} m above or",
        "below the surface (--decimate M); they are open sheets unless --thicken M has closed them.",
        "Layers of obstacles are closed boxes from where each wall or column begins to its top.",
        "The world tells DART to find contacts with bullet: with its default, things fall through terrain.",
    ]
    square = _square(terrain)
    return "\n".join([*lines, *([] if square is None else _about_heightmap(terrain, square))])


def _about_heightmap(terrain: Terrain, square: Square) -> list[str]:
    shape, side = square.shape(terrain, ""), square.side
    return [
        "",
        f"layer_00 has no hole: {WORLD} has it as a height-map, model://{_heightmap_name(terrain)},",
        f"{side} x {side} pixels, {number(shape.height)} m high, at {numbers(shape.middle, ', ')}.",
        f"What is seen is {number(shape.seen)} m wide, what is touched {number(shape.touched)} m, as they",
        "place samples in different ways (newer releases of DART may not). Do not move the model: what is",
        "seen would stay where it is. Fortress misreads 16-bit images; no engine but DART has height-maps:",
        f"there, use {MESHES_ONLY}.",
    ]
