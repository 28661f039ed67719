"""MuJoCo: scene.xml and float binaries, a height-field for every rectangle without a hole.

MuJoCo's height-fields are solid, whole, and scaled by their own least and greatest height. A geometry can
be turned, so all are by a quarter: then the diagonals of their quads run as those of every other target.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np

from stepfield.errors import TargetError
from stepfield.targets.boxes import Box, boxes
from stepfield.targets.mujococomplex import ComplexPart
from stepfield.targets.squares import squares
from stepfield.targets.target import Options, Written
from stepfield.targets.terrain import Raster, Terrain, TerrainLayer
from stepfield.targets.text import as_word, in_xml, number, numbers, readme, write_text
from stepfield.targets.tiles import Tile, tiles

SCENE = "scene.xml"
#: Tiles of so few samples stand in the scene itself: a scan with many holes would make thousands of files.
INLINE = 256
#: More tiles than this, and MuJoCo takes minutes and gigabytes to load them.
MOST_TILES = 200_000
#: The same of the boxes of a layer of obstacles, which take it longer.
MOST_BOXES = 50_000
#: MuJoCo wants a height above zero, which a level tile does not have; metres.
LEVEL = 1e-3
#: A quarter turn about z: a tile's own x is north, its own y is west.
TURN = "0.7071067811865476 0 0 0.7071067811865476"

_COLOURS = (
    (0.56, 0.53, 0.47),
    (0.30, 0.55, 0.75),
    (0.85, 0.55, 0.25),
    (0.40, 0.65, 0.40),
    (0.65, 0.45, 0.70),
    (0.80, 0.72, 0.35),
)


@dataclass(frozen=True, eq=False)
class _Piece:
    """What the scene says of one tile, or of one box, which needs no asset."""

    asset: str | None
    geometry: str
    file: str | None = None


def write(terrain: Terrain, folder: Path, options: Options) -> Written:
    """Write the scene, its binaries and a README; raise TargetError where there are too many holes."""
    folder.mkdir(parents=True, exist_ok=True)
    pieces = [_pieces(terrain, layer, folder) for layer in terrain.layers]
    extra = ComplexPart.of(terrain, folder)
    write_text(folder / SCENE, _scene(terrain, pieces, extra))
    notes = (*limits(terrain), *_counts(terrain, pieces), *extra.notes)
    write_text(folder / "README.txt", readme(terrain, "MuJoCo", _steps(terrain, pieces), notes))
    binaries = [*(piece.file for layer in pieces for piece in layer if piece.file), *extra.files]
    return Written((SCENE, *binaries, "README.txt"), notes)


def limits(terrain: Terrain) -> list[str]:
    """Say which layers have no surface, and that what MuJoCo has is solid."""
    why = "there is no pillar" if terrain.reconstruction == "edges" else "nowhere do four samples meet"
    said = [
        f"{layer.name}: {why}, so the layer has no surface and is left out"
        for layer in terrain.layers
        if not terrain.has_body(layer)
    ]
    if sum(not layer.is_obstacles for layer in terrain.layers) > 1:
        said.append(
            "MuJoCo's height-fields are solid: an upper layer is up to 10 cm thick below its lowest part, "
            "and where it slopes it takes up to a quarter of the free height beneath it"
        )
    return said


def _counts(terrain: Terrain, pieces: list[list[_Piece]]) -> list[str]:
    said = [
        f"{layer.name}: {len(own):,} boxes"
        for layer, own in zip(terrain.layers, pieces, strict=True)
        if layer.is_obstacles
    ]
    total = sum(map(_is_tile, chain.from_iterable(pieces)))
    if total > len(terrain.layers) - len(said):
        said.append(
            f"the layers are {total:,} height-fields: MuJoCo's have neither holes nor space beneath them"
        )
    return said


def _is_tile(piece: _Piece) -> bool:
    return piece.asset is not None


# ---- pieces ----------------------------------------------------------------------------------------


def _pieces(terrain: Terrain, layer: TerrainLayer, folder: Path) -> list[_Piece]:
    """Write the binaries of a layer; return what the scene says of each tile."""
    if layer.is_obstacles:
        return list(_solids(terrain, layer))
    made: list[_Piece] = []
    for tile, samples in _tiles(terrain, layer):
        if len(made) == MOST_TILES:
            raise TargetError(
                f"mujoco: {layer.name} has so many holes that it takes more than {MOST_TILES:,} "
                f"height-fields; build the stack with a larger cell size"
            )
        made.append(_piece(terrain, layer, tile, samples, f"{layer.label}_{len(made):05d}", folder))
    return made


def _solids(terrain: Terrain, layer: TerrainLayer) -> Iterator[_Piece]:
    for count, box in enumerate(boxes(terrain, layer)):
        if count == MOST_BOXES:
            raise TargetError(
                f"mujoco: {layer.name} takes more than {MOST_BOXES:,} boxes; build the stack with a larger "
                f"cell size or tolerance"
            )
        yield _solid(layer, count, box)


def _solid(layer: TerrainLayer, count: int, box: Box) -> _Piece:
    place, size = (" ".join(map(_exact, of)) for of in (box.middle, box.half))
    geometry = f'<geom class="{layer.label}" name="{layer.label}_{count:05d}" pos="{place}" size="{size}"/>'
    return _Piece(None, geometry)


def _tiles(terrain: Terrain, layer: TerrainLayer) -> Iterator[tuple[Tile, Raster]]:
    """Cut a layer into tiles, and give the heights of each."""
    if terrain.reconstruction == "edges":
        return squares(terrain, layer.index)
    return ((tile, tile.samples(layer.elevations)) for tile in tiles(terrain, layer))


def _piece(
    terrain: Terrain, layer: TerrainLayer, tile: Tile, samples: Raster, name: str, folder: Path
) -> _Piece:
    low, high = float(samples.min()), float(samples.max())
    relative = (samples.astype(np.float64) - low).astype(np.float32)
    file = f"{name}.hf" if samples.size > INLINE else None
    if file:
        (folder / file).write_bytes(binary(relative))
    data = f'file="{file}"' if file else _inline(relative)
    asset = f'<hfield name="{name}" size="{_size(terrain, tile, high - low)}" {data}/>'
    place = f"{_middle(terrain, tile)} {_exact(low)}"
    geometry = f'<geom class="{layer.label}" name="{name}" hfield="{name}" pos="{place}"/>'
    return _Piece(asset, geometry, file)


def _turned(samples: Raster) -> Raster:
    """Lay samples out in a tile's own axes: rows go from east to west, columns from south to north."""
    return samples[::-1, ::-1].T


def binary(samples: Raster) -> bytes:
    """Return MuJoCo's own format of heights: two counts, then floats from the south-most row on."""
    turned = _turned(samples)
    return np.array(turned.shape, "<i4").tobytes() + turned.astype("<f4").tobytes()


def _inline(samples: Raster) -> str:
    """Return heights as attributes, which MuJoCo reads from the north-most row on, unlike its binaries."""
    turned = _turned(samples)[::-1]
    text = " ".join(str(height) for height in turned.ravel())
    return f'nrow="{turned.shape[0]}" ncol="{turned.shape[1]}" elevation="{text}"'


def _size(terrain: Terrain, tile: Tile, relief: float) -> str:
    """Half the extent along the tile's own axes, its relief, and its thickness below that."""
    half = terrain.cell_size / 2
    return " ".join(_exact(v) for v in (tile.rows * half, tile.columns * half, relief or LEVEL, tile.slab))


def _middle(terrain: Terrain, tile: Tile) -> str:
    # A tile lies between samples, or between the sides of compartments, which are half of one off.
    shift = 0.5 if terrain.reconstruction == "edges" else 0
    x = terrain.west + (tile.column + tile.columns / 2 - shift) * terrain.cell_size
    y = terrain.north - (tile.row + tile.rows / 2 - shift) * terrain.cell_size
    return f"{_exact(x)} {_exact(y)}"


def _exact(value: float) -> str:
    """Return a length to a billionth of a metre, or so small a one as it is."""
    return repr(round(value, 9) or value)


# ---- scene -----------------------------------------------------------------------------------------


def _scene(terrain: Terrain, pieces: list[list[_Piece]], extra: ComplexPart) -> str:
    return "\n".join(
        [
            f'<mujoco model="{in_xml(as_word(terrain.name) or "terrain")}">',
            *_look(terrain),
            "  <default>",
            *(f"    {_default(layer)}" for layer in terrain.layers),
            *(f"    {line}" for line in extra.defaults),
            "  </default>",
            "  <asset>",
            *(f"    {line}" for line in _assets(terrain, pieces)),
            *(f"    {line}" for line in extra.assets),
            "  </asset>",
            "  <worldbody>",
            *(f"    {line}" for line in _geometries(pieces)),
            *(f"    {line}" for line in extra.geometries),
            "  </worldbody>",
            "</mujoco>",
            "",
        ]
    )


def _look(terrain: Terrain) -> Iterator[str]:
    """Where the viewer looks at first, and what the layers and the terrain are called by their operator."""
    low, high = _heights(terrain)
    middle = ((terrain.west + terrain.east) / 2, (terrain.south + terrain.north) / 2, (low + high) / 2)
    extent = max(terrain.east - terrain.west, terrain.north - terrain.south, high - low, terrain.cell_size)
    yield f'  <statistic center="{numbers(middle)}" extent="{number(extent)}"/>'
    yield "  <custom>"
    yield f'    <text name="stepfield_source" data="{in_xml(terrain.name) or "terrain"}"/>'
    yield f'    <numeric name="stepfield_local_origin" data="{numbers(terrain.local_origin)}"/>'
    for layer in terrain.layers:
        yield f'    <text name="{layer.label}" data="{in_xml(layer.name) or layer.label}"/>'
    yield "  </custom>"


def _heights(terrain: Terrain) -> tuple[float, float]:
    there = [layer.elevations[layer.occupied] for layer in terrain.layers]
    there = [values for values in there if values.size]
    if not there:
        return terrain.base_elevation, terrain.base_elevation
    return float(min(values.min() for values in there)), float(max(values.max() for values in there))


def _default(layer: TerrainLayer) -> str:
    """What the geometries of a layer share."""
    kind = 'type="box"' if layer.is_obstacles else f'type="hfield" quat="{TURN}"'
    geometry = f'<geom {kind} material="{layer.label}"/>'
    return f'<default class="{layer.label}">{geometry}</default>'


def _assets(terrain: Terrain, pieces: list[list[_Piece]]) -> Iterator[str]:
    for layer, own in zip(terrain.layers, pieces, strict=True):
        colour = _COLOURS[layer.index % len(_COLOURS)]
        yield f'<material name="{layer.label}" rgba="{numbers(colour)} 1" specular="0.1"/>'
        yield from (piece.asset for piece in own if piece.asset is not None)


def _geometries(pieces: list[list[_Piece]]) -> Iterator[str]:
    yield '<light directional="true" pos="0 0 100" dir="-0.3 0.4 -1" castshadow="false"/>'
    # Right in the world: MuJoCo looks at every geometry of any other body in every step.
    for own in pieces:
        yield from (piece.geometry for piece in own)


def _steps(terrain: Terrain, pieces: list[list[_Piece]]) -> str:
    low, high = _heights(terrain)
    x, y = (terrain.west + terrain.east) / 2, (terrain.south + terrain.north) / 2
    bodies = "\n".join(
        f"  {layer.label}: {len(own)} {'box' if layer.is_obstacles else 'height-field'}"
        f"{('es' if layer.is_obstacles else 's') * (len(own) != 1)}"
        for layer, own in zip(terrain.layers, pieces, strict=True)
    )
    return f"""
How to use it
1. Look at it:                python -m mujoco.viewer --mjcf={SCENE}
2. Put a robot into it:       write a file beside {SCENE} such as

     <mujoco>
       <include file="{SCENE}"/>
       <worldbody>
         <body pos="{number(x)} {number(y)} {number(high + 0.5)}"> <freejoint/> <geom size="0.1"/> </body>
       </worldbody>
     </mujoco>

   or in Python: spec = mujoco.MjSpec.from_file("{SCENE}"), then spec.attach(robot, frame=...).
3. A contact or a ray says which geometry it met, whose name begins with its layer's:
{bodies}
   Heights go from z = {number(low)} to {number(high)}. Rays (lidar), contacts and pictures see one surface.

Height-fields do not collide with each other nor with planes, and are static; give the robot spheres,
capsules, boxes, cylinders, ellipsoids or meshes. The .hf files are MuJoCo's own binary: two int32 counts,
then float32 heights above the tile's lowest sample; small tiles stand in {SCENE} itself. Tiles are turned
by a quarter about z, so that the diagonals of their quads run from north-west to south-east.
"""
