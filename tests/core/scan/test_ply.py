"""PLY: every encoding and arrangement holds the same points; lying and broken files are one sentence."""

from __future__ import annotations

import contextlib
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from stepfield.errors import ScanError
from stepfield.scan import rows
from stepfield.scan.cloud import Cloud, Reader
from stepfield.scan.ply import read

Parse = Callable[[Reader, str, bytes], Cloud]
Damage = Callable[[Reader, str, bytes], None]
Find = Callable[[str], Path]

XYZ = "property float x\nproperty float y\nproperty float z\n"
POINTS = np.array([[0.5, 1, 2], [3, -4, 5], [6, 7, 8.25]])


def ply(form: str, elements: str, data: bytes) -> bytes:
    return f"ply\nformat {form} 1.0\n{elements}end_header\n".encode() + data


def points(cloud: Cloud) -> np.ndarray:
    return np.column_stack([axis.values() for axis in cloud.axes])


@pytest.mark.parametrize(("form", "order"), [("binary_little_endian", "<"), ("binary_big_endian", ">")])
@pytest.mark.parametrize(
    ("kind", "code"), [("float", "f4"), ("float64", "f8"), ("short", "i2"), ("int32", "i4"), ("uchar", "u1")]
)
def test_binary_of_any_kind_and_order(parse: Parse, form: str, order: str, kind: str, code: str) -> None:
    whole = np.array([[1, 2, 3], [4, 5, 6]], order + code)
    header = f"element vertex 2\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\n"
    cloud = parse(read, "a.ply", ply(form, header, whole.tobytes()))
    assert points(cloud).tolist() == whole.tolist(), "the numbers must not depend on the byte order"
    assert cloud.axes[0].raw.dtype == np.dtype(code), "columns keep the file's kind, in native order"
    assert cloud.axes[0].raw.dtype.isnative


def test_ascii_with_blanks_crlf_and_upper_case_names(parse: Parse) -> None:
    text = b"ply \r\nformat ascii 1.0  \r\nelement vertex 2 \r\nproperty float X\r\nproperty float Y\r\n"
    text += b"property double Z \r\nend_header\r\n 1  2 3.5 \r\n4\t5 6\r\n"
    assert points(parse(read, "a.ply", text)).tolist() == [[1, 2, 3.5], [4, 5, 6]]


def test_ascii_keeps_more_digits_than_float32_has(parse: Parse) -> None:
    cloud = parse(read, "a.ply", ply("ascii", "element vertex 1\n" + XYZ, b"289814.15 4320978.61 170.76\n"))
    assert points(cloud).tolist() == [[289814.15, 4320978.61, 170.76]], "the text holds the digits: keep them"


@pytest.mark.parametrize("small", [0, 1 << 20])
def test_ascii_stops_where_the_faces_start(parse: Parse, monkeypatch: pytest.MonkeyPatch, small: int) -> None:
    monkeypatch.setattr(rows, "SMALL", small)
    header = "element vertex 3\n" + XYZ + "element face 1\nproperty list uchar int vertex_indices\n"
    cloud = parse(read, "a.ply", ply("ascii", header, b"0.5 1 2\n\n3 -4 5\n6 7 8.25\n3 0 1 2\n"))
    assert points(cloud).tolist() == POINTS.tolist(), "a blank line is no row and a face is no point"


def test_lists_and_elements_around_the_vertices(parse: Parse) -> None:
    header = (
        "element face 2\nproperty list uchar int corners\nelement vertex 3\nproperty list uchar short tags\n"
        + XYZ
        + "property list int float more\nelement edge 1\nproperty int a\n"
    )
    data = struct.pack("<B3iB1i", 3, 0, 1, 2, 1, 9)
    for i, row in enumerate(POINTS):
        data += struct.pack(f"<B{i}h3fif", i, *range(i), *row, 1, 0.5)
    cloud = parse(read, "a.ply", ply("binary_little_endian", header, data + struct.pack("<i", 1)))
    assert points(cloud).tolist() == POINTS.tolist(), "lists of differing length must be stepped over"
    text = b"3 0 1 2\n1 9\n" + b"".join(
        b"%d %s %g %g %g 1 0.5\n" % (i, b"7 " * i, *row) for i, row in enumerate(POINTS)
    )
    assert points(parse(read, "b.ply", ply("ascii", header, text))).tolist() == POINTS.tolist()


def test_lists_of_one_length_are_read_as_records(parse: Parse) -> None:
    header = "element vertex 3\nproperty list uchar short tags\n" + XYZ
    data = b"".join(struct.pack(">B2h3f", 2, 5, 6, *row) for row in POINTS)
    assert points(parse(read, "a.ply", ply("binary_big_endian", header, data))).tolist() == POINTS.tolist()


@pytest.mark.parametrize(
    ("kind", "names", "code", "values"),
    [
        ("uchar", "red green blue", "B", (255, 128, 0)),
        ("float", "red green blue", "f", (1.0, 0.5, 0.0)),
        ("ushort", "diffuse_red diffuse_green diffuse_blue", "H", (65535, 32896, 0)),
    ],
)
def test_colours_become_bytes(parse: Parse, kind: str, names: str, code: str, values: tuple[float]) -> None:
    header = "element vertex 1\n" + XYZ + "".join(f"property {kind} {name}\n" for name in names.split())
    data = struct.pack(f"<3f3{code}", 1, 2, 3, *values)
    cloud = parse(read, "a.ply", ply("binary_little_endian", header, data))
    assert cloud.attributes["rgb"].tolist() == [[255, 128, 0]]
    assert cloud.attributes["rgb"].dtype == np.uint8


def test_intensity_and_class_under_their_other_names(parse: Parse) -> None:
    header = "element vertex 2\n" + XYZ + "property float scalar_Intensity\nproperty int label\n"
    cloud = parse(read, "a.ply", ply("ascii", header, b"1 2 3 0.25 2\nnan 5 6 0.5 6\n"))
    assert cloud.attributes["intensity"].tolist() == [0.25], "attributes follow the points that stay"
    assert cloud.attributes["classification"].tolist() == [2]
    assert cloud.not_finite == 1, "a dropped point is counted"


def test_labels_beyond_a_byte_are_left_out_aloud(parse: Parse) -> None:
    header = "element vertex 1\n" + XYZ + "property int label\n"
    cloud = parse(read, "a.ply", ply("ascii", header, b"1 2 3 70000\n"))
    assert "classification" not in cloud.attributes
    assert "label" in cloud.warnings[0], "an attribute must not vanish in silence"


@pytest.mark.parametrize("form", ["binary_little_endian", "ascii"])
def test_truncated_file_gives_its_whole_points(parse: Parse, form: str) -> None:
    binary = POINTS.astype("<f4").tobytes()[:-1]
    data = binary if form.startswith("binary") else b"0.5 1 2\n3 -4 5\n6 7"
    cloud = parse(read, "a.ply", ply(form, "element vertex 3\n" + XYZ, data))
    assert points(cloud).tolist() == POINTS[:2].tolist()
    assert "2 of its 3" in cloud.warnings[0], "the operator must learn that points are missing"


def test_a_bad_ascii_row_is_named_by_its_line(parse: Parse) -> None:
    with pytest.raises(ScanError, match=r"a\.ply: line 9 \('oops'\)"):
        parse(read, "a.ply", ply("ascii", "element vertex 3\n" + XYZ, b"1 2 3\noops\n4 5 6\n"))


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
@pytest.mark.parametrize(
    "before", ["", "element face 999999999999\nproperty list uchar int i\n", "element q 99999999\n"]
)
def test_a_billion_claimed_points_cost_nothing(parse: Parse, form: str, before: str) -> None:
    content = ply(form, before + "element vertex 4000000000\n" + XYZ, POINTS.astype("<f4").tobytes())
    points_read = 0
    with contextlib.suppress(ScanError):
        points_read = len(parse(read, "a.ply", content))
    assert points_read <= 3, "no more points than the file has bytes for"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "not 'ply'"),
        (b"solid\n", "not 'ply'"),
        (b"ply\nformat ascii 1.0\n", "end_header"),
        (b"ply\nelement vertex 1\nend_header\n", "ascii or binary"),
        (b"ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", "line 3"),
        (b"ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n", "line 4"),
        (b"ply\nformat ascii 1.0\nend_header\n", "no vertex element"),
        (ply("ascii", "element vertex 1\nproperty float x\nproperty float y\n", b"1 2\n"), "have no z"),
        (ply("ascii", "element vertex 0\n" + XYZ, b""), "holds no points"),
        (ply("ascii", "element vertex 1\n" + XYZ, b"nan nan nan\n"), "holds no points"),
        (ply("binary_little_endian", "element vertex 5\n" + XYZ, b"\0\0"), "holds no points"),
    ],
)
def test_what_cannot_be_read_is_one_sentence(parse: Parse, content: bytes, message: str) -> None:
    with pytest.raises(ScanError, match=message):
        parse(read, "a.ply", content)


def test_a_missing_file_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(ScanError, match=r"none\.ply: cannot be read"):
        read(tmp_path / "none.ply")


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("lists", ["", "property list uchar int tags\n"])
def test_damage_never_escapes(survives_damage: Damage, form: str, lists: str) -> None:
    header = (
        "element vertex 3\n" + lists + XYZ + "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    )
    head = (0,) if lists else ()
    if form == "ascii":
        data = b"".join(b"0 " * len(head) + b"%g %g %g 1 2 3\n" % tuple(row) for row in POINTS)
    else:
        order = "<" if "little" in form else ">"
        data = b"".join(struct.pack(f"{order}{len(head)}B3f3B", *head, *row, 1, 2, 3) for row in POINTS)
    survives_damage(read, "a.ply", ply(form, header, data))


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("PDAL__simple_text.ply", 3),
        ("PDAL__simple_binary.ply", 3),
        ("PDAL__issue_2421.ply", 1),
        ("PDAL__text_extradim.ply", 1),
        ("assimp-testmodels__cube.ply", 8),
        ("assimp-testmodels__float-color.ply", 3),
        ("assimp-testmodels__issue623.ply", 24),
        ("assimp-testmodels__pond.0.ply", 69409),
        ("../scans/CSF__sample.ply", 100000),
        ("../scans/small_gicp__source.ply", 69792),
    ],
)
def test_real_files(real_scan: Find, name: str, count: int) -> None:
    assert len(read(real_scan(f"../scans-malformed/{name}"))) == count


@pytest.mark.parametrize("name", ["no_vertex", "sized_dims", "unsized_dims"])
def test_real_files_without_points(real_scan: Find, name: str) -> None:
    with pytest.raises(ScanError, match=r"no vertex|no z"):
        read(real_scan(f"../scans-malformed/PDAL__{name}.ply"))
