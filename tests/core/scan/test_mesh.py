"""Meshes: their vertices, each once, and nothing of their faces."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from stepfield.errors import ScanError
from stepfield.scan import rows
from stepfield.scan.cloud import Cloud, Reader
from stepfield.scan.mesh import read

Parse = Callable[[Reader, str, bytes], Cloud]
Damage = Callable[[Reader, str, bytes], None]
Find = Callable[[str], Path]

CORNERS: list[list[float]] = [[0, 0, 0], [1, 0, 0], [0, 1, 0.5], [1, 1, 0]]
OBJ = (
    b"# box\no 1\nvn 0 0 1\nv 0 0 0\n v  1 0 0\nvt 0 0\r\nv 0 1 .5\r\n\tv\t1 1 0\nf 1//1 2//1 3//1\nf 2 3 4\n"
)
TEXT_STL = b"solid a\n" + b"".join(
    b" facet normal 0 0 1\n  outer loop\n"
    + b"".join(b"   vertex %g %g %g\n" % tuple(CORNERS[i]) for i in facet)
    + b"  endloop\n endfacet\n"
    for facet in ((0, 1, 2), (1, 2, 3))
)
BINARY_STL = (
    b"solid but binary".ljust(80)
    + struct.pack("<I", 2)
    + b"".join(
        struct.pack("<12fH", 0, 0, 1, *(value for i in facet for value in CORNERS[i]), 0)
        for facet in ((0, 1, 2), (1, 2, 3))
    )
)
OFF = b"OFF # a comment\n# another\n4 2 0\n0 0 0\n1 0 0\n\n0 1 0.5\n1 1 0\n3 0 1 2\n3 1 2 3\n"


def points(cloud: Cloud) -> list[list[float]]:
    rows: list[list[float]] = np.column_stack([axis.values() for axis in cloud.axes]).tolist()
    return rows


@pytest.mark.parametrize("small", [0, 1 << 20])
@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.obj", OBJ),
        ("a.stl", TEXT_STL),
        ("b.stl", BINARY_STL),
        ("a.off", OFF),
        ("b.off", OFF.replace(b"OFF # a comment\n# another\n", b"OFF ")),
        ("c.off", OFF.replace(b"OFF # a comment\n", b"")),
    ],
)
def test_every_format_gives_the_corners_once(
    parse: Parse, monkeypatch: pytest.MonkeyPatch, name: str, content: bytes, small: int
) -> None:
    monkeypatch.setattr(rows, "SMALL", small)
    cloud = parse(read, name, content)
    assert points(cloud) == CORNERS, "faces, normals and repeated corners are no points"
    assert not cloud.warnings


def test_binary_stl_keeps_float32(parse: Parse) -> None:
    assert parse(read, "a.stl", BINARY_STL).axes[0].raw.dtype == np.float32


def test_colours_of_obj(parse: Parse) -> None:
    cloud = parse(read, "a.obj", b"v 1 2 3 1.0 0.5 0\nv 4 5 6 0 0 0.2\n")
    assert cloud.attributes["rgb"].tolist() == [[255, 128, 0], [0, 0, 51]]
    half = parse(read, "b.obj", b"v 1 2 3 1.0 0.5 0\nv 4 5 6\n")
    assert "rgb" not in half.attributes, "colours that only some vertices have are no colours of the cloud"


@pytest.mark.parametrize(
    ("head", "extra", "coloured"),
    [
        (b"COFF", b" 10 20 30 255", True),
        (b"NOFF", b" 0 0 1", False),
        (b"CNOFF", b" 0 0 1 10 20 30 255", True),
    ],
)
def test_off_with_more_columns(parse: Parse, head: bytes, extra: bytes, coloured: bool) -> None:
    content = b"".join(b"%g %g %g" % tuple(corner) + extra + b"\n" for corner in CORNERS)
    cloud = parse(read, "a.off", head + b"\n4 0 0\n" + content)
    assert points(cloud) == CORNERS
    assert ("rgb" in cloud.attributes) is coloured
    if coloured:
        assert cloud.attributes["rgb"][0].tolist() == [10, 20, 30]


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.off", OFF.replace(b"4 2 0", b"900000000 2 0").replace(b"3 0 1 2\n3 1 2 3\n", b""), "4 of its 9"),
        ("a.stl", BINARY_STL[:-1], "1 of its 2 facets"),
        ("a.obj", OBJ[: OBJ.index(b" 1 0\nf")], "last vertex"),
    ],
)
def test_truncated_meshes_give_what_is_there(parse: Parse, name: str, content: bytes, message: str) -> None:
    assert message in parse(read, name, content).warnings[0]


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.obj", b"# nothing here\n", "holds no points"),
        ("a.obj", b"", "holds no points"),
        ("a.obj", b"v 1 2 3\nv 1 x 3\nv 1 2 3\n", r"vertex 2 \('1 x 3'\)"),
        ("a.stl", b"", "too short"),
        ("a.stl", b"solid empty\nendsolid\n", "holds no points"),
        ("a.stl", b"\0" * 80 + b"\xff\xff\xff\xff", "4294967295 facets"),
        ("a.off", b"", "no OFF file"),
        ("a.off", b"OFF BINARY\n", "no ascii OFF"),
        ("a.off", b"4OFF\n1 0 0\n1 2 3 1\n", "no ascii OFF"),
        ("a.off", b"OFF\n0 0 0\n", "holds no points"),
    ],
)
def test_what_cannot_be_read_is_one_sentence(parse: Parse, name: str, content: bytes, message: str) -> None:
    with pytest.raises(ScanError, match=message):
        parse(read, name, content)


@pytest.mark.parametrize(
    ("name", "content"), [("a.obj", OBJ), ("a.stl", TEXT_STL), ("b.stl", BINARY_STL), ("a.off", OFF)]
)
def test_damage_never_escapes(survives_damage: Damage, name: str, content: bytes) -> None:
    survives_damage(read, name, content)


@pytest.mark.parametrize(
    ("name", "count"),
    [("PDAL__box.obj", 8), ("PDAL__simple_binary.obj", 3), ("../scans/PDAL__1.2-with-color.obj", 911)],
)
def test_real_files(real_scan: Find, name: str, count: int) -> None:
    assert len(read(real_scan(f"../scans-malformed/{name}"))) == count
