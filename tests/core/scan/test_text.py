"""Text clouds: every way to write rows of numbers, tidy or not, and a line number for what is no row."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from stepfield.errors import ScanError
from stepfield.scan import numbers, rows
from stepfield.scan.cloud import Cloud, Reader
from stepfield.scan.text import read

Parse = Callable[[Reader, str, bytes], Cloud]
Damage = Callable[[Reader, str, bytes], None]
Find = Callable[[str], Path]

ROWS = [[1.5, 2, 3], [4, -5.25, 6e3], [7, 8, 0.09]]


@pytest.fixture(params=["row by row", "in blocks"], autouse=True)
def both_parsers(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run every test with each of the two parsers: they must not differ."""
    monkeypatch.setattr(rows, "SMALL", 0 if request.param == "in blocks" else 1 << 20)


def points(cloud: Cloud) -> np.ndarray:
    return np.column_stack([axis.values() for axis in cloud.axes])


@pytest.mark.parametrize(
    "content",
    [
        b"1.5 2 3\n4 -5.25 6e3\n7 8 .09\n",
        b"1.5,2,3\r\n4,-5.25,6e3\r\n7,8,.09",
        b"1.5\t2\t3\n4;-5.25;6e3\n 7 , 8 ,  .09\n",
        b"  1.5   2  3 \n\n\n4  -5.25  6e3\n7 8 .09  \n\n",
        b"x y z\n1.5 2 3\n4 -5.25 6e3\n7 8 .09\n",
        b'"X","Y","Z"\n1.5 2 3\n4 -5.25 6e3\n7 8 .09\n',
        b"\xef\xbb\xbfX;Y;Z\n1.5;2;3\n4;-5.25;6e3\n7;8;.09\n",
        b"# a comment\n// another\n1.5 2 3\n# between\n4 -5.25 6e3\n7 8 .09\n",
        b"//X Y Z\n1.5 2 3\n4 -5.25 6e3\n7 8 .09\n",
        b"id,z,y,x\n1,3,2,1.5\n2,6e3,-5.25,4\n3,.09,8,7\n",
        b"1.5 2 3 tree 9\n4 -5.25 6e3 rock 9\n7 8 .09 house 9\n",
        b"1.5 2 3\n4 -5.25 6e3 1 2\n7 8 .09 5\n",
        b"1.5 2 3\r4 -5.25 6e3\r7 8 .09\r",
        b"3\n1.5 2 3\n4 -5.25 6e3\n7 8 .09\n",
        b"1,5;2;3\n4;-5,25;6e3\n7;8;0,09\n",
    ],
)
def test_every_way_to_write_the_same_rows(parse: Parse, content: bytes) -> None:
    assert points(parse(read, "a.txt", content)).tolist() == ROWS


def test_the_two_parsers_round_alike(parse: Parse, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(1)
    values = rng.random((500, 3)) * 10.0 ** rng.integers(-8, 8, (500, 3))
    content = "".join(" ".join(map(repr, row)) + "\n" for row in values.tolist()).encode()
    assert np.array_equal(points(parse(read, "a.xyz", content)), values), "text must be read to the last bit"


def test_columns_are_found_by_their_names(parse: Parse) -> None:
    content = (
        b"Classification,X,Intensity,Y,Z,Red,Green,Blue\n2,1,0.5,2,3,65535,32768,0\n6,4,1.5,5,6,0,0,256\n"
    )
    cloud = parse(read, "a.csv", content)
    assert points(cloud).tolist() == [[1, 2, 3], [4, 5, 6]]
    assert cloud.attributes["classification"].tolist() == [2, 6]
    assert cloud.attributes["intensity"].tolist() == [0.5, 1.5]
    assert cloud.attributes["rgb"].tolist() == [[255, 128, 0], [0, 0, 1]], (
        "16-bit colours lose their lower byte"
    )


def test_an_empty_field_is_no_number_but_keeps_its_place(parse: Parse) -> None:
    cloud = parse(read, "a.csv", b"x,y,z,intensity,class\n1,2,3,,7\n4,5,6,8,9\n")
    assert cloud.attributes["classification"].tolist() == [7, 9], "columns must not slide into a gap"
    assert np.isnan(cloud.attributes["intensity"][0])


def test_columns_of_pts(parse: Parse) -> None:
    coloured = parse(read, "a.pts", b"2\n1 2 3 -9 10 20 30\n4 5 6 -8 40 50 60\n")
    assert coloured.attributes["intensity"].tolist() == [-9, -8]
    assert coloured.attributes["rgb"].tolist() == [[10, 20, 30], [40, 50, 60]]
    assert parse(read, "b.pts", b"1\n1 2 3 -9\n").attributes["intensity"].tolist() == [-9]


def test_blocks_of_pts(parse: Parse) -> None:
    cloud = parse(read, "a.pts", b"2\n1 2 3\n4 5 6\n1\n7 8 9\n")
    assert points(cloud).tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]], "a count is no row"
    assert not cloud.warnings


def test_a_wrong_count_is_told(parse: Parse) -> None:
    assert "announces 5 points but holds 1" in parse(read, "a.pts", b"5\n1 2 3\n").warnings[0]


def test_three_last_columns_of_bytes_are_colours(parse: Parse) -> None:
    assert parse(read, "a.xyz", b"1 2 3 4 5 6\n").attributes["rgb"].tolist() == [[4, 5, 6]]
    late = b"1 2 3 4 5 6\n" * 200 + b"1 2 3 0.5 5 6\n"
    assert "rgb" not in parse(read, "a.xyz", late).attributes, "normals must not be taken for colours"


def test_points_that_are_not_finite_are_dropped_and_counted(parse: Parse) -> None:
    cloud = parse(read, "a.xyz", b"1 2 3\nnan 2 3\n4 inf 6\nNaN NaN NaN\n")
    assert (points(cloud).tolist(), cloud.not_finite) == ([[1, 2, 3]], 3)


def test_a_header_without_z_falls_back_to_custom(parse: Parse) -> None:
    cloud = parse(read, "a.txt", b"X,Y,X\n\n0, 1, 2\n")
    assert points(cloud).tolist() == [[0, 1, 2]]
    assert "names no z" in cloud.warnings[0], "a guess must be told"


@pytest.mark.parametrize("end", [b"7 8", b"7 8\n", b"7,"])
def test_a_truncated_last_line_is_left_out_aloud(parse: Parse, end: bytes) -> None:
    cloud = parse(read, "a.xyz", b"1 2 3\n4 5 6\n" + end)
    assert points(cloud).tolist() == [[1, 2, 3], [4, 5, 6]]
    assert "last line" in cloud.warnings[0]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "no row of numbers"),
        (b"\n\n# nothing\n", "no row of numbers"),
        (b"This is a text.\n", "no row of numbers"),
        (b"1 2 3\n4 5\n7 8 9\n", r"line 2 \('4 5'\)"),
        (b"x y z\n1 2 3\n\nabc\n7 8 9\n", r"line 4 \('abc'\)"),
        (b"nan nan nan\n", "holds no points"),
        (b"\x00\x01\x02" * 100, "no row of numbers"),
    ],
)
def test_what_cannot_be_read_is_one_sentence(parse: Parse, content: bytes, message: str) -> None:
    with pytest.raises(ScanError, match=message):
        parse(read, "a.txt", content)


def test_many_blocks_are_one_table(parse: Parse, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numbers, "BLOCK", 64)
    content = b"".join(b"%d %d.5 -%d\n" % (i, i, i) for i in range(1000))
    expected = [[i, i + 0.5, -i] for i in range(1000)]
    assert points(parse(read, "a.xyz", content)).tolist() == expected, "rows must not be lost between blocks"
    bad = content + b"oops\n1 2 3\n"
    with pytest.raises(ScanError, match=r"line 1001 \('oops'\)"):
        parse(read, "a.xyz", bad)
    with pytest.raises(ScanError, match="no line end"):
        parse(read, "a.xyz", content + b"1" * 200)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.xyz", b"1.5 2 3\n4 -5.25 6e3\n7 8 .09\n"),
        ("a.csv", b'"X","Y","Z",red,green,blue\r\n1,2,3,4,5,6\r\n7,8,9,10,11,12\r\n'),
        ("a.pts", b"2\n1 2 3 -9 10 20 30\n4 5 6 -8 40 50 60\n"),
    ],
)
def test_damage_never_escapes(survives_damage: Damage, name: str, content: bytes) -> None:
    survives_damage(read, name, content)


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("PDAL__badheader.txt", 8),
        ("PDAL__crlf_test.txt", 10),
        ("PDAL__crlf_test2.txt", 10),
        ("PDAL__decimate_file_grid.txt", 81),
        ("PDAL__largescan.txt", 6),
        ("PDAL__missingheader.txt", 5),
        ("PDAL__quoted2.txt", 9),
        ("PDAL__utm17_3.txt", 11),
        ("PDAL__with_edgeofflightline.txt", 10000),
        ("PDAL__data.xyz", 400),
        ("PDAL__bunny_8.pts", 9),
        ("PDAL__site_56_8.pts", 8),
        ("PDAL__test.pts", 19),
        ("../scans/PDAL__autzen.pts", 10),
        ("../scans/libpointmatcher__car_cloud400.csv", 24989),
        ("../scans/libpointmatcher__apartment_cloud_0_converted.xyz", 36674),
    ],
)
def test_real_files(real_scan: Find, name: str, count: int) -> None:
    assert len(read(real_scan(f"../scans-malformed/{name}"))) == count
