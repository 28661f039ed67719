"""PCD: ascii, binary and compressed hold the same points, in whichever fields and order."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from imagecodecs import lzf_encode

from stepfield.errors import ScanError
from stepfield.scan.cloud import Cloud, Reader
from stepfield.scan.pcd import read

Parse = Callable[[Reader, str, bytes], Cloud]
Damage = Callable[[Reader, str, bytes], None]
Find = Callable[[str], Path]

POINTS = np.array([[0.5, 1, 2], [3, -4, 5], [6, 7, 8.25], [1, 1, 1]])


def pcd(
    data: str,
    body: bytes,
    fields: str = "x y z",
    *,
    height: int = 1,
    points: int = 4,
    size: str = "",
    kind: str = "",
    counts: str = "",
) -> bytes:
    count = len(fields.split())
    size, kind, counts = size or "4 " * count, kind or "F " * count, counts or "1 " * count
    return (
        f"# .PCD v0.7\nVERSION 0.7\nFIELDS {fields}\nSIZE {size}\nTYPE {kind}\nCOUNT {counts}\n"
        f"WIDTH {points // height}\nHEIGHT {height}\nVIEWPOINT 9 9 9 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
    ).encode() + body


def compressed(raw: bytes) -> bytes:
    packed = lzf_encode(raw)
    return struct.pack("<II", len(packed), len(raw)) + packed


def points(cloud: Cloud) -> np.ndarray:
    return np.column_stack([axis.values() for axis in cloud.axes])


BINARY = POINTS.astype("<f4").tobytes()
BY_FIELD = np.repeat(POINTS, 20, axis=0).astype("<f4").T.tobytes()


def test_binary_and_compressed_agree(parse: Parse) -> None:
    binary = parse(
        read, "a.pcd", pcd("binary", np.repeat(POINTS, 20, axis=0).astype("<f4").tobytes(), points=80)
    )
    packed = parse(read, "b.pcd", pcd("binary_compressed", compressed(BY_FIELD), points=80))
    assert np.array_equal(points(binary), np.repeat(POINTS, 20, axis=0))
    assert np.array_equal(points(binary), points(packed)), "the encoding must not change the points"
    assert binary.axes[0].raw.dtype == packed.axes[0].raw.dtype == np.float32


@pytest.mark.parametrize("mark", [b" ", b"\t", b",", b" , ", b"  "])
def test_ascii_of_any_separator_keeps_every_digit(parse: Parse, mark: bytes) -> None:
    row = mark.join([b"289814.15", b"4320978.61", b"170.76"]) + b"\r\n"
    cloud = parse(read, "a.pcd", pcd("ascii", row * 4, "X Y Z"))
    assert points(cloud).tolist() == [[289814.15, 4320978.61, 170.76]] * 4, (
        "float32 would lose the centimetres"
    )


def test_doubles_and_fields_of_several_values(parse: Parse) -> None:
    record = np.dtype([("f", "<f4", (3,)), ("z", "<f8"), ("y", "<f8"), ("_", "u1", (2,)), ("x", "<f8")])
    array = np.zeros(4, record)
    array["x"], array["y"], array["z"] = POINTS.T

    def several(data: str, body: bytes) -> bytes:
        return pcd(data, body, "fpfh z y _ x", size="4 8 8 1 8", kind="F F F U F", counts="3 1 1 2 1")

    cloud = parse(read, "a.pcd", several("binary", array.tobytes()))
    assert points(cloud).tolist() == POINTS.tolist()
    assert cloud.axes[0].raw.dtype == np.float64
    text = b"".join(b"9 9 9 %g %g 0 0 %g\n" % (z, y, x) for x, y, z in POINTS)
    assert points(parse(read, "b.pcd", several("ascii", text))).tolist() == POINTS.tolist()


@pytest.mark.parametrize("kind", ["F", "U"])
@pytest.mark.parametrize("name", ["rgb", "rgba"])
def test_packed_colour(parse: Parse, kind: str, name: str) -> None:
    bits = np.array([0xFF102030, 0x00FF8001, 0, 0xFFFFFFFE], "<u4")
    array = np.zeros(4, [("p", "<f4", (3,)), ("c", "<u4")])
    array["p"], array["c"] = POINTS, bits
    binary = parse(read, "a.pcd", pcd("binary", array.tobytes(), f"x y z {name}", kind=f"F F F {kind}"))
    expected = [[16, 32, 48], [255, 128, 1], [0, 0, 0], [255, 255, 254]]
    assert binary.attributes["rgb"].tolist() == expected
    text = b"".join(b"1 2 3 %d\n" % value for value in bits)
    ascii_cloud = parse(read, "b.pcd", pcd("ascii", text, f"x y z {name}", kind="F F F U"))
    assert ascii_cloud.attributes["rgb"].tolist() == expected, (
        "float32 has too few digits for a packed colour"
    )


def test_packed_colour_written_as_a_float(parse: Parse) -> None:
    value = np.array([0xFE102030], np.uint32).view(np.float32)[0]
    cloud = parse(read, "a.pcd", pcd("ascii", b"1 2 3 %s\n" % repr(float(value)).encode() * 4, "x y z rgb"))
    assert cloud.attributes["rgb"][0].tolist() == [16, 32, 48]


def test_intensity_label_and_separate_channels(parse: Parse) -> None:
    text = b"1 2 3 0.5 2 10 20 30\n" * 4
    cloud = parse(read, "a.pcd", pcd("ascii", text, "x y z intensity label r g b"))
    assert cloud.attributes["intensity"].tolist() == [0.5] * 4
    assert cloud.attributes["classification"].tolist() == [2] * 4
    assert cloud.attributes["rgb"].tolist() == [[10, 20, 30]] * 4


def test_an_image_of_points_is_organised_and_its_holes_are_counted(parse: Parse) -> None:
    holed = POINTS.astype("<f4")
    holed[1] = np.nan
    cloud = parse(read, "a.pcd", pcd("binary", holed.tobytes(), height=2))
    assert cloud.organised, "a depth-camera frame is told by its height"
    assert (len(cloud), cloud.not_finite) == (3, 1)
    assert points(cloud)[0].tolist() == [0.5, 1, 2], "the viewpoint must not move the points"


def test_rows_without_a_header_are_text(parse: Parse) -> None:
    assert points(parse(read, "a.pcd", b"1 2 3\n4 5 6\n")).tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize(
    ("data", "body"), [("binary", BINARY[:-5]), ("ascii", b"0.5 1 2\n3 -4 5\n6 7 8.25\n1 1")]
)
def test_truncated_file_gives_its_whole_points(parse: Parse, data: str, body: bytes) -> None:
    cloud = parse(read, "a.pcd", pcd(data, body))
    assert points(cloud).tolist() == POINTS[:3].tolist()
    assert "3 of its 4" in cloud.warnings[0]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "no row of numbers"),
        (pcd("binary", BINARY, "x y w"), "have no z"),
        (pcd("zip", BINARY), "DATA"),
        (pcd("binary", BINARY, size="4 4"), "differ in length"),
        (pcd("binary", BINARY, size="4 4 3"), "unknown TYPE"),
        (pcd("binary", BINARY, counts="1 1 9999999"), "impossible size"),
        (pcd("binary", b"", points=0), "holds no points"),
        (pcd("binary", b"", points=10**9), "holds no points"),
        (pcd("ascii", b"1 2 x\n" * 4), r"line 12 \('1 2 x'\)"),
        (pcd("binary_compressed", b"\1\2"), "ends at its header"),
        (pcd("binary_compressed", compressed(BY_FIELD)[:-9], points=80), "ends early"),
        (pcd("binary_compressed", compressed(BY_FIELD), points=10**9), "10{9} points but"),
        (
            pcd("binary_compressed", struct.pack("<II", 12, 1 << 31) + b"\xff" * 12, points=1 << 27),
            "unpack to",
        ),
        (pcd("binary_compressed", struct.pack("<II", 12, 48) + b"\xff" * 12), "damaged"),
    ],
)
def test_what_cannot_be_read_is_one_sentence(parse: Parse, content: bytes, message: str) -> None:
    with pytest.raises(ScanError, match=message):
        parse(read, "a.pcd", content)


@pytest.mark.parametrize(
    "content",
    [
        pcd("ascii", b"".join(b"%g %g %g 7\n" % tuple(row) for row in POINTS), "x y z rgb"),
        pcd("binary", BINARY),
        pcd("binary_compressed", compressed(BY_FIELD), points=80),
    ],
)
def test_damage_never_escapes(survives_damage: Damage, content: bytes) -> None:
    survives_damage(read, "a.pcd", content)


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("PDAL__utm17_comma.pcd", 10),
        ("PDAL__utm17_space.pcd", 10),
        ("PDAL__utm17_tab.pcd", 10),
        ("PDAL__missingheader.pcd", 10),
        ("PDAL__autzen-utm.pcd", 1065),
        ("../scans/data__capture0001.pcd", 307200 - 57553),
        ("../scans/data__region_growing_rgb_tutorial.pcd", 307200 - 47353),
        ("../scans/plane_seg__06.pcd", 107772),
        ("../scans/plane_seg__terrain_close_rect.pcd", 90227),
        ("../scans/plane_seg__tilted-steps.pcd", 181648),
    ],
)
def test_real_files(real_scan: Find, name: str, count: int) -> None:
    assert len(read(real_scan(f"../scans-malformed/{name}"))) == count
