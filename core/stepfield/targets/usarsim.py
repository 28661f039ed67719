"""USARSim on UT2004: G16 height-maps for the texture browser, and terrains with their holes as T3D.

The formulas are those of the engine's TerrainInfo: a sample lies at ``Location`` plus (column - width / 2,
row - height / 2, (value - 32768) / 256) times ``TerrainScale``; y counts southwards.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stepfield.errors import TargetError
from stepfield.heightmap import GrayScale
from stepfield.stack.write import save_gray
from stepfield.targets.complexmesh import left_out
from stepfield.targets.filling import nearest
from stepfield.targets.target import Options, Written, without_surface
from stepfield.targets.terrain import Raster, Terrain, TerrainLayer
from stepfield.targets.text import as_word, number, readme, write_text

#: Unreal units in a metre, as USARSim has it.
UNITS = 250.0
#: Sides a height-map may have are powers of two between these.
LEAST_SIDE, GREATEST_SIDE = 16, 512
#: Unreal units from the middle of the world to its end.
WORLD = 262_144.0
#: More terrains than this are no level any more.
MOST_TERRAINS = 256
MAP = "terrain.t3d"

_MIDDLE = 32768
Visible = NDArray[np.bool_]


@dataclass(frozen=True)
class Tile:
    """A part of a layer that fits into one height-map; neighbours share a row or column of samples.

    Attributes
    ----------
    name : str
        Of the height-map.
    row, column : int
        Of its north-west sample in the layer.
    height, width : int
        Of the height-map, powers of two.
    """

    name: str
    row: int
    column: int
    height: int
    width: int

    def cut(self, raster: Raster) -> Raster:
        """Return its part of a layer, edges repeated as far as the height-map goes beyond."""
        part = raster[self.row : self.row + self.height, self.column : self.column + self.width]
        beyond = [(0, self.height - part.shape[0]), (0, self.width - part.shape[1])]
        return np.pad(part, beyond, mode="edge")

    def visible(self, quads: Visible) -> Visible:
        """Return which of its quads are there, shape (height, width): the last row and column never."""
        part = quads[self.row : self.row + self.height - 1, self.column : self.column + self.width - 1]
        beyond = [(0, self.height - part.shape[0]), (0, self.width - part.shape[1])]
        return np.pad(part, beyond)


@dataclass(frozen=True)
class Vertical:
    """How elevations of a layer become values of 16 bits: ``middle`` is 32768, ``scale`` TerrainScale.Z."""

    middle: float
    scale: float

    @classmethod
    def over(cls, elevations: Raster) -> Vertical:
        """Stretch the range of elevations over all values but the lowest, which would be one too many."""
        low, high = float(elevations.min()), float(elevations.max())
        span = max(high - low, 1e-3)  # a level layer has no range, but its scale must not be zero
        return cls((low + high) / 2, UNITS * span / 256 * 65536 / 65534)

    def values(self, elevations: Raster) -> NDArray[np.uint16]:
        """Return the values of elevations in metres."""
        steps = (elevations.astype(np.float64) - self.middle) * (UNITS * 256 / self.scale)
        return (np.rint(steps) + _MIDDLE).astype(np.uint16)


def write(terrain: Terrain, folder: Path, options: Options) -> Written:
    """Write height-maps, 8-bit pictures of Eq. 2, and the terrains that go with them."""
    _refuse_beyond_world(terrain)
    cut = [(layer, tiles) for layer in terrain.layers if (tiles := list(_tiles(layer)))]
    _refuse_too_many(sum(len(tiles) for _, tiles in cut))
    files, actors, lines = [], [], []
    for layer, tiles in cut:
        vertical = Vertical.over(layer.elevations[layer.occupied])
        filled, quads = nearest(layer.elevations), layer.quads
        for tile in tiles:
            save_g16(folder / f"{tile.name}.bmp", vertical.values(tile.cut(filled)))
            actors.append(_terrain_info(terrain, layer, tile, vertical, tile.visible(quads)))
            lines.append(_line(terrain, tile, vertical))
        files += [f"{tile.name}.bmp" for tile in tiles]
    for layer in terrain.layers:
        save_gray(folder / f"{layer.label}_8bit.png", _eight_bits(terrain, layer))
        files.append(f"{layer.label}_8bit.png")
    write_text(folder / MAP, _t3d([*actors, _zone_info(terrain)]))
    notes = limits(terrain)
    write_text(folder / "README.txt", readme(terrain, "USARSim on UT2004", _steps(terrain, lines), notes))
    return Written((*files, MAP, "README.txt"), tuple(notes))


def limits(terrain: Terrain) -> list[str]:
    """Say what TerrainInfo makes of several layers and of large ones."""
    found = without_surface(terrain, vertices=True) + left_out(terrain)
    if terrain.reconstruction == "edges":
        found.append(
            "a terrain has a vertex a sample, whatever the reconstruction: sides are cut by half a "
            "compartment and what is one compartment wide is gone; the mesh target has all of it"
        )
    if len(terrain.layers) > 1:
        found.append(
            "terrains above each other in one zone have not been tried in UnrealEd: should an upper one "
            "fail, import it as a static mesh from the mesh target"
        )
    if any(layer.is_obstacles for layer in terrain.layers):
        found.append(
            "a terrain has no sides: obstacles are surfaces at their tops; for solid ones import the mesh "
            "target's as static meshes"
        )
    if max(terrain.columns, terrain.rows) > GREATEST_SIDE:
        found.append(
            f"a height-map of UT2004 has at most {GREATEST_SIDE} samples a side, so that layers are cut into "
            f"terrains that share their edges"
        )
    return found


def _refuse_beyond_world(terrain: Terrain) -> None:
    """A level ends where the engine's world does."""
    places = [terrain.west, terrain.east, terrain.north, terrain.south]
    for layer in terrain.layers:
        there = layer.elevations[layer.occupied]
        places += [float(there.min()), float(there.max())] if there.size else []
    if (farthest := max(map(abs, places))) * UNITS > WORLD:
        raise TargetError(
            f"usarsim: the terrain reaches {number(farthest)} m from its origin, and the world of UT2004 "
            f"ends at {number(WORLD / UNITS)} m; crop the scan or leave this target out"
        )


def _refuse_too_many(tiles: int) -> None:
    if tiles > MOST_TERRAINS:
        raise TargetError(
            f"usarsim: it would take {tiles} terrains, and {MOST_TERRAINS} are the most that "
            f"make sense; use a larger cell size or crop the scan"
        )


def _tiles(layer: TerrainLayer) -> Iterator[Tile]:
    """Cut a layer into height-maps, leaving out those without a quad."""
    spans = [list(_spans(side)) for side in layer.elevations.shape]
    quads = layer.quads
    several = len(spans[0]) * len(spans[1]) > 1
    for i, (row, height) in enumerate(spans[0]):
        for j, (column, width) in enumerate(spans[1]):
            if quads[row : row + height - 1, column : column + width - 1].any():
                name = f"{layer.label}_r{i}c{j}" if several else layer.label
                yield Tile(name, row, column, height, width)


def _spans(count: int) -> Iterator[tuple[int, int]]:
    """Cut samples into spans that share their ends; give the first sample and a power of two."""
    start = 0
    while start < count - 1:
        left = min(count - start, GREATEST_SIDE)
        yield start, max(LEAST_SIDE, 1 << (left - 1).bit_length())
        start += GREATEST_SIDE - 1


def save_g16(path: Path, values: NDArray[np.uint16]) -> None:
    """Write a bitmap of 16 bits a pixel, as UnrealEd takes height-maps: the bottom row first."""
    height, width = values.shape
    size = values.nbytes  # rows are multiples of 4 bytes, as the format wants it
    header = b"BM" + np.array([54 + size, 0, 54], "<u4").tobytes()
    header += np.array([40, width, height], "<u4").tobytes() + np.array([1, 16], "<u2").tobytes()
    header += np.array([0, size, 0, 0, 0, 0], "<u4").tobytes()
    path.write_bytes(header + values[::-1].astype("<u2").tobytes())


def _eight_bits(terrain: Terrain, layer: TerrainLayer) -> NDArray[np.uint8]:
    """Draw a layer as the paper's Eq. 2 does, padded as the stack's images are."""
    manifest = terrain.manifest
    entry, image = manifest.layers[layer.index], manifest.image
    white = entry.scale * (256 if image.bits == 8 else 65535)
    heights = np.where(layer.occupied, layer.elevations - terrain.base_elevation, 0).astype(np.float64)
    gray = np.where(layer.occupied, np.maximum(GrayScale(white, 8).encode(heights), 1), 0).astype(np.uint8)
    column, row = image.offset
    padded = np.zeros((image.height, image.width), np.uint8)
    padded[row : row + terrain.rows, column : column + terrain.columns] = gray
    return padded


def location(terrain: Terrain, tile: Tile, vertical: Vertical) -> tuple[float, float, float]:
    """Return where a terrain goes, Unreal units."""
    cell = terrain.cell_size
    x = terrain.west + (tile.column + tile.width / 2) * cell
    y = terrain.north - (tile.row + tile.height / 2) * cell
    return UNITS * x, -UNITS * y, UNITS * vertical.middle


def bitmap(visible: Visible) -> list[int]:
    """Pack quads into words of 32 bits, the first in the lowest; 1 is visible, words are signed."""
    return np.packbits(visible.ravel(), bitorder="little").view("<i4").tolist()


def _terrain_info(
    terrain: Terrain, layer: TerrainLayer, tile: Tile, vertical: Vertical, visible: Visible
) -> str:
    x, y, z = location(terrain, tile, vertical)
    plan = number(UNITS * terrain.cell_size)
    words = [f"    QuadVisibilityBitmap({i})={word}\n" for i, word in enumerate(bitmap(visible))]
    return (
        f"Begin Actor Class=TerrainInfo Name=TerrainInfo_{tile.name}\n"
        f"    TerrainMap=Texture'myLevel.Heightmaps.{tile.name}'\n"
        f"    TerrainScale=(X={plan},Y={plan},Z={vertical.scale:.9f})\n"
        f"    Layers(0)=(Texture=Texture'Engine.DefaultTexture',UScale=1.000000,VScale=1.000000)\n"
        f"    bKCollisionHalfRes=False\n"
        f"{''.join(words)}"
        f'    Tag="{as_word(f"{layer.label}_{layer.name}")}"\n'
        f"    Location=(X={number(x)},Y={number(y)},Z={number(z)})\n"
        f"End Actor\n"
    )


def _zone_info(terrain: Terrain) -> str:
    """Put the zone's actor above the middle of the terrain, where the room around it will be."""
    x, y = UNITS * (terrain.west + terrain.east) / 2, -UNITS * (terrain.north + terrain.south) / 2
    z = UNITS * (terrain.base_elevation + terrain.manifest.max_height + 1)
    return (
        f"Begin Actor Class=ZoneInfo Name=ZoneInfo_terrain\n"
        f"    bTerrainZone=True\n"
        f"    Location=(X={number(x)},Y={number(y)},Z={number(z)})\n"
        f"End Actor\n"
    )


def _t3d(actors: Sequence[str]) -> str:
    return f"Begin Map\n{''.join(actors)}End Map\n".replace("\n", "\r\n")


def _line(terrain: Terrain, tile: Tile, vertical: Vertical) -> str:
    x, y, z = (number(value) for value in location(terrain, tile, vertical))
    plan = number(UNITS * terrain.cell_size)
    return (
        f"{tile.name}: {tile.width} x {tile.height}, TerrainScale X = Y = {plan}, Z = {vertical.scale:.9f}, "
        f"Location {x}, {y}, {z}"
    )


def _steps(terrain: Terrain, lines: Sequence[str]) -> str:
    return "\n".join(
        [
            "Unreal units: 250 a metre; X is east, Y is south, Z is up.",
            "1. UnrealEd, Texture browser, File > Import: every layer_NN*.bmp (16 bits, G16) into the",
            "   package myLevel, group Heightmaps, keeping its name. Image tools misread these files.",
            "2. Subtract a room that holds everything; it reaches above and below all layers.",
            f"3. File > Import, {MAP}: it adds the terrains, their holes (QuadVisibilityBitmap), and a",
            "   ZoneInfo with bTerrainZone above them; outside such zones terrain is neither seen nor solid.",
            "   Height-maps must be there first: importing one again clears its holes.",
            "4. Choose a texture for Layers(0) of every terrain, rebuild all.",
            "bKCollisionHalfRes is False: robots would otherwise not see the holes.",
            "",
            *lines,
            "",
            "layer_NN_8bit.png are the paper's gray images (Eq. 2), padded as the stack's are.",
        ]
    )
