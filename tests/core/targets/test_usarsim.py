"""USARSim's files, read back byte by byte, and put together by the formulas of UT2004's TerrainInfo."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from tests.core.targets.stacks import asymmetric, stack_of

from stepfield.errors import TargetError
from stepfield.stack import Stack
from stepfield.targets import usarsim as target
from stepfield.targets.target import Options, Written
from stepfield.targets.terrain import Terrain


def write(stack: Path, folder: Path) -> Written:
    folder.mkdir()
    made = target.write(Terrain.of_stack(stack), folder, Options())
    assert {path.name for path in folder.iterdir()} == set(made.files)
    return made


def read_g16(path: Path) -> NDArray[np.uint16]:
    """Read a 16-bit bitmap as the format is written down, row 0 at the top."""
    content = path.read_bytes()
    kind, size, reserved, start = struct.unpack_from("<2sIII", content)
    header, width, height, planes, bits, packing, length = struct.unpack_from("<IiiHHII", content, 14)
    assert (kind, size, reserved, start) == (b"BM", len(content), 0, 54)
    assert (header, planes, bits, packing, length) == (40, 1, 16, 0, 2 * width * height)
    rows = [
        struct.unpack_from(f"<{width}H", content, start + 2 * width * (height - 1 - row))
        for row in range(height)
    ]
    return np.array(rows, np.uint16)


@dataclass
class Actor:
    """A TerrainInfo of the map, in Unreal units."""

    name: str
    location: tuple[float, ...]
    scale: tuple[float, ...]
    words: dict[int, int]

    def is_visible(self, column: int, row: int, width: int) -> bool:
        """Look a quad up: 32 a word, the lowest bit first."""
        quad = column + row * width
        return bool(self.words[quad // 32] >> quad % 32 & 1)


def actors(t3d: Path) -> Iterator[Actor]:
    """Read the terrains of a map."""
    content = t3d.read_bytes().decode("ascii")
    assert content.startswith("Begin Map\r\n")
    assert content.endswith("End Map\r\n")
    for block in re.findall(r"Begin Actor Class=TerrainInfo .*?End Actor", content, re.DOTALL):
        assert "bKCollisionHalfRes=False" in block
        (name,) = re.findall(r"TerrainMap=Texture'myLevel\.Heightmaps\.(\w+)'", block)
        scale, location = (
            tuple(map(float, re.findall(rf"{key}=\(X=([-\d.]+),Y=([-\d.]+),Z=([-\d.]+)\)", block)[0]))
            for key in ("TerrainScale", "Location")
        )
        words = {int(i): int(word) for i, word in re.findall(r"QuadVisibilityBitmap\((\d+)\)=(-?\d+)", block)}
        assert sorted(words) == list(range(len(words)))
        assert all(-(2**31) <= word < 2**31 for word in words.values())
        yield Actor(name, location, scale, words)


def put_together(folder: Path, terrain: Terrain) -> list[dict[tuple[int, int], float]]:
    """Return a layer's visible samples by row and column, metres, as the engine would place them."""
    layers: list[dict[tuple[int, int], float]] = [{} for _ in terrain.layers]
    for actor in actors(folder / "terrain.t3d"):
        values = read_g16(folder / f"{actor.name}.bmp")
        height, width = values.shape
        assert {16, 32, 64, 128, 256, 512} >= {height, width}
        assert len(actor.words) * 32 == values.size
        found = layers[int(actor.name[6:8])]
        for row in range(height):
            for column in range(width):
                if actor.is_visible(column, row, width):
                    assert row < height - 1
                    assert column < width - 1
                    for r, c in ((row, column), (row, column + 1), (row + 1, column), (row + 1, column + 1)):
                        x = actor.location[0] + (c - width / 2) * actor.scale[0]
                        y = actor.location[1] + (r - height / 2) * actor.scale[1]
                        z = actor.location[2] + (int(values[r, c]) - 32768) * actor.scale[2] / 256
                        at_column = (x / 250 - terrain.west) / terrain.cell_size
                        at_row = (terrain.north + y / 250) / terrain.cell_size  # Unreal's y is south
                        assert abs(at_column - round(at_column)) < 1e-3 > abs(at_row - round(at_row))
                        found[round(at_row), round(at_column)] = z / 250
    return layers


def samples_with_a_quad(elevations: NDArray[np.float64]) -> set[tuple[int, int]]:
    quads = np.isfinite(elevations[:-1, :-1] + elevations[:-1, 1:] + elevations[1:, :-1] + elevations[1:, 1:])
    whole = np.pad(quads, 1)
    used = whole[:-1, :-1] | whole[:-1, 1:] | whole[1:, :-1] | whole[1:, 1:]
    return {(int(row), int(column)) for row, column in np.argwhere(used)}


@pytest.mark.parametrize("name", ["asymmetric", "table", "bridge", "room_scan1"])
def test_the_engine_would_rebuild_the_reconstruction(
    name: str, find_stack: Callable[[str], Path], tmp_path: Path
) -> None:
    stack = find_stack(name)
    write(stack, tmp_path / "out")
    terrain, decoded = Terrain.of_stack(stack), Stack.open(stack)
    layers = put_together(tmp_path / "out", terrain)
    for found, entry in zip(layers, decoded.manifest.layers, strict=True):
        expected = decoded.elevations(entry)
        assert set(found) == samples_with_a_quad(expected)
        for at, height in found.items():
            assert height == pytest.approx(expected[at], abs=entry.scale / 2 + 1e-3)


def test_large_layers_are_cut_where_they_share_their_edges(tmp_path: Path) -> None:
    row, column = np.indices((30, 1040)).astype(float)
    layer = 0.01 * column + 0.2 * row
    layer[4:9, 505:515] = np.nan
    layer[:, 600:] = np.where(np.arange(440) < 380, layer[:, 600:], np.nan)
    stack = stack_of(tmp_path / "s", [layer], cell=0.1)
    made = write(stack, tmp_path / "out")
    assert [name for name in made.files if name.endswith("bmp")] == ["layer_00_r0c0.bmp", "layer_00_r0c1.bmp"]
    (found,) = put_together(tmp_path / "out", Terrain.of_stack(stack))
    assert set(found) == samples_with_a_quad(layer)
    assert max(abs(height - layer[at]) for at, height in found.items()) < 1e-3
    assert any("at most 512" in note for note in made.notes)


def test_holes_are_filled_from_beside_them(asymmetric_stack: Path, tmp_path: Path) -> None:
    """A hole of another height would pull the edges of the surface up or down."""
    write(asymmetric_stack, tmp_path / "out")
    values = read_g16(tmp_path / "out" / "layer_01.bmp")
    there = np.isfinite(asymmetric()[1])
    low, high = values[:24, :37][there].min(), values[:24, :37][there].max()
    assert (low, high) == (1, 65535), "the whole range is used"
    assert values.min() >= low


def test_a_level_layer_is_level(tmp_path: Path) -> None:
    stack = stack_of(tmp_path / "s", [np.full((20, 20), 3.0)])
    write(stack, tmp_path / "out")
    (found,) = put_together(tmp_path / "out", Terrain.of_stack(stack))
    assert {round(height, 3) for height in found.values()} == {3.0}


def test_the_8_bit_pictures_are_equation_2(stack: Path, tmp_path: Path) -> None:
    write(stack, tmp_path / "out")
    decoded = Stack.open(stack)
    for entry in decoded.manifest.layers:
        picture = np.asarray(Image.open(tmp_path / "out" / f"layer_{entry.index:02d}_8bit.png"))
        heights = decoded.gray(entry).astype(np.float64) * entry.scale
        expected = np.clip(np.floor(heights * 256 / decoded.manifest.max_height), 1, 255)
        assert picture.dtype == np.uint8
        np.testing.assert_array_equal(picture > 0, decoded.mask(entry))
        # Where a height is just between two levels, the decoded one may fall into the other.
        differ = np.abs(picture - np.where(decoded.mask(entry), expected, 0))
        assert differ.max() <= 1
        assert (differ > 0).mean() < 1e-3


def test_8_bits_stay_the_same_8_bits(tmp_path: Path) -> None:
    stack = stack_of(tmp_path / "s", asymmetric(), bits=8)
    write(stack, tmp_path / "out")
    for name in ("layer_00", "layer_01"):
        np.testing.assert_array_equal(
            Image.open(stack / f"{name}.png"), Image.open(tmp_path / "out" / f"{name}_8bit.png")
        )


def test_it_has_a_zone_and_no_name_breaks_the_map(tmp_path: Path) -> None:
    bad = "a\"'\r\nEnd Map\r\n日本(X=1)"
    stack = stack_of(tmp_path / "s", asymmetric(), names=[bad, bad], name=f"{bad}.ply")
    write(stack, tmp_path / "out")
    content = (tmp_path / "out" / "terrain.t3d").read_bytes().decode("ascii")
    assert content.count("End Map") == 1
    assert re.search(r"Class=ZoneInfo .*?bTerrainZone=True.*?End Actor", content, re.DOTALL)
    assert 'Tag="layer_00_a_End_Map_X_1"' in content
    assert len(list(actors(tmp_path / "out" / "terrain.t3d"))) == 2


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"west": 5000.0}, "the world of UT2004 ends at 1048.576 m"),
        ({"cell": 60.0}, "the world of UT2004 ends at 1048.576 m"),
        ({"up": 1100.0}, "the world of UT2004 ends at 1048.576 m"),
    ],
)
def test_what_lies_beyond_the_world_is_refused(tmp_path: Path, more: dict[str, Any], said: str) -> None:
    layer = asymmetric()[0] + more.pop("up", 0.0)
    with pytest.raises(TargetError, match=said):
        write(stack_of(tmp_path / "s", [layer], **more), tmp_path / "out")


def test_more_terrains_than_make_sense_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(target, "MOST_TERRAINS", 1)
    with pytest.raises(TargetError, match="it would take 2 terrains, and 1 are the most"):
        write(stack_of(tmp_path / "s", asymmetric()), tmp_path / "out")
    assert not list((tmp_path / "out").iterdir())
