"""PTX: scans one behind the other, posed; beams that hit nothing, lying headers and cut files."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from stepfield.errors import ScanError
from stepfield.scan import ptx
from stepfield.scan.cloud import Cloud, Floats

ODD = "../scans-malformed"
IDENTITY = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
AXES = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"


def scan(rows: list[str], pose: str = IDENTITY, columns: int = 1, count: int | None = None) -> str:
    """Write one scan; ``count`` is what its header claims instead of the truth."""
    claimed = len(rows) // columns if count is None else count
    return f"{columns}\n{claimed}\n{AXES}{pose}" + "".join(f"{row}\n" for row in rows)


def points_of(cloud: Cloud) -> Floats:
    return np.column_stack([axis.values() for axis in cloud.axes])


@pytest.fixture
def file(tmp_path: Path) -> Callable[[str], Path]:
    def write(text: str) -> Path:
        path = tmp_path / "scan.ptx"
        path.write_bytes(text.encode("latin-1"))
        return path

    return write


def outcome(path: Path) -> Cloud | ScanError:
    """Read a file that may be damaged: a cloud or one sentence, and nothing else."""
    try:
        return ptx.read(path)
    except ScanError as error:
        failure = error
    assert "\n" not in str(failure)
    assert str(failure).startswith(path.name)
    return failure


def test_four_columns_are_points_and_intensity(file: Callable[[str], Path]) -> None:
    cloud = ptx.read(file(scan(["1 2 3 0.5", "4 5 6 0.25"])))
    np.testing.assert_array_equal(points_of(cloud), [[1, 2, 3], [4, 5, 6]])
    np.testing.assert_array_equal(cloud.attributes["intensity"], [0.5, 0.25])
    assert set(cloud.attributes) == {"intensity"}
    assert (cloud.unit, cloud.organised, cloud.warnings) == (None, False, ())


def test_seven_columns_have_colours_too(file: Callable[[str], Path]) -> None:
    cloud = ptx.read(file(scan(["1 2 3 0.5 10 20 30", "4 5 6 0.25 255 0 1"], columns=2)))
    np.testing.assert_array_equal(cloud.attributes["rgb"], [[10, 20, 30], [255, 0, 1]])
    assert cloud.attributes["rgb"].dtype == np.uint8


def test_beams_that_hit_nothing_are_dropped_and_counted(file: Callable[[str], Path]) -> None:
    cloud = ptx.read(file(scan(["0 0 0 0.5", "1 2 3 0.5", "0 0 0 0.5", "0 0 1 0.5"])))
    np.testing.assert_array_equal(points_of(cloud), [[1, 2, 3], [0, 0, 1]])
    assert (cloud.not_finite, cloud.warnings) == (2, ())


def test_the_transformation_multiplies_row_vectors(file: Callable[[str], Path]) -> None:
    pose = "0 1 0 0\n-1 0 0 0\n0 0 1 0\n500000.5 4000000 10 1\n"
    cloud = ptx.read(file(scan(["1 2 3 0"], pose)))
    np.testing.assert_array_equal(points_of(cloud), [[499998.5, 4000001, 13]])


def test_scans_follow_each_other_with_what_all_have(file: Callable[[str], Path]) -> None:
    up = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 5 1\n"
    text = scan(["1 2 3 0.5 1 2 3"]) + "\n" + scan([]) + scan(["1 2 3 0.5", "0 0 0 0.5"], up)
    cloud = ptx.read(file(text))
    np.testing.assert_array_equal(points_of(cloud), [[1, 2, 3], [1, 2, 8]])
    assert set(cloud.attributes) == {"intensity"}


@pytest.mark.parametrize("end", ["\r\n", "\n"])
@pytest.mark.parametrize("gap", [" ", "\t", "  "])
def test_line_ends_and_gaps_do_not_matter(file: Callable[[str], Path], end: str, gap: str) -> None:
    text = (scan(["1 2 3 0.5"]) + scan(["4 5 6 0.5"])).replace(" ", gap).replace("\n", end)
    np.testing.assert_array_equal(points_of(ptx.read(file(text))), [[1, 2, 3], [4, 5, 6]])


def test_a_last_line_without_its_end(file: Callable[[str], Path]) -> None:
    assert len(ptx.read(file(scan(["1 2 3 0.5", "4 5 6 0.5"])[:-1]))) == 2


def test_a_large_scan_is_read_in_order(file: Callable[[str], Path]) -> None:
    points = np.random.default_rng(0).random((90_000, 3)).round(6)
    rows = [f"{x:.6f} {y:.6f} {z:.6f} 0.500000 1 2 3" for x, y, z in points]
    cloud = ptx.read(file(scan(rows) + scan(["7 8 9 0.5 1 2 3"])))
    np.testing.assert_allclose(points_of(cloud), [*points, [7, 8, 9]], atol=1e-12)


def test_a_truncated_file_gives_its_rows(file: Callable[[str], Path]) -> None:
    cloud = ptx.read(file(scan(["1 2 3 0.5"], count=1) + scan(["4 5 6 0.5", "7 8 9 0.5"], count=10)))
    assert len(cloud) == 3
    assert cloud.warnings == ("scan.ptx: ends early: 3 of its 11 rows are there",)


@pytest.mark.parametrize("count", [10**9, 10**11, 2**63])
def test_a_claimed_count_costs_nothing(file: Callable[[str], Path], count: int) -> None:
    tracemalloc.start()
    result = outcome(file(scan(["1 2 3 0.5"], columns=1, count=count)))
    assert tracemalloc.get_traced_memory()[1] < 40_000_000
    tracemalloc.stop()
    assert isinstance(result, ScanError) or len(result) == 1


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "holds no points"),
        ("\n\n", "holds no points"),
        (scan([]), "holds no points"),
        (scan(["0 0 0 0.5"]), "holds no points"),
        ("ply\n", "line 1 should hold the number of columns"),
        ("2\n-3\n", "line 2 should hold the number of rows"),
        ("2\n1.5\n", "line 2 should hold the number of rows"),
        ("2\n1\n0 0\n", "line 3 should hold the position of the scanner"),
        (f"2\n1\n{AXES}1 0 0 0\n0 1 0\n", "line 8 should hold a row of the transformation"),
        (f"2\n1\n{AXES}nan 0 0 0\n", "line 7 should hold a row of the transformation"),
        (scan(["1 2 3 0.5", "one two three 0.5", "1 2 3 0.5"]), "line 12"),
        (scan(["1 2 3 0.5"], count=1) + "rubbish\n", "line 12 should hold the number of columns"),
        (scan(["1 2", "1 2 3 0.5"]), "line 11"),
    ],
)
def test_what_is_no_scan_is_one_sentence(file: Callable[[str], Path], text: str, sentence: str) -> None:
    error = outcome(file(text))
    assert isinstance(error, ScanError)
    assert sentence in str(error)


def test_a_missing_file_and_a_folder_are_one_sentence(tmp_path: Path) -> None:
    assert isinstance(outcome(tmp_path / "none.ptx"), ScanError)
    assert isinstance(outcome(tmp_path), ScanError)


def test_damaged_bytes_give_a_cloud_or_a_sentence(file: Callable[[str], Path]) -> None:
    rows = [f"{i} {i / 7:.4f} {i * i} 0.5 1 2 3" for i in range(20)]
    raw = (scan(rows) + scan(rows, columns=4)).encode()
    rng = np.random.default_rng(6)
    for turn in range(300):
        damaged = bytearray(raw)
        for at in rng.integers(0, len(raw), rng.integers(1, 4)):
            damaged[at] ^= 1 << int(rng.integers(8))
        path = file(damaged[: rng.integers(len(raw)) if turn % 3 == 0 else None].decode("latin-1"))
        result = outcome(path)
        assert isinstance(result, ScanError) or len(result) <= 40


@pytest.mark.parametrize(
    ("name", "count", "dropped"),
    [
        ("PDAL__1.2-with-color.ptx", 1065, 0),
        (f"{ODD}/PDAL__complex-transform.ptx", 4, 8),
        (f"{ODD}/PDAL__multiple-and-transform.ptx", 8, 0),
        (f"{ODD}/PDAL__no-color.ptx", 15, 0),
    ],
)
def test_real_files(real_scan: Callable[[str], Path], name: str, count: int, dropped: int) -> None:
    cloud = ptx.read(real_scan(name))
    assert (len(cloud), cloud.not_finite, cloud.warnings) == (count, dropped, ())


def test_two_poses_of_a_real_file_agree(real_scan: Callable[[str], Path]) -> None:
    points = points_of(ptx.read(real_scan(f"{ODD}/PDAL__multiple-and-transform.ptx")))
    np.testing.assert_allclose(points[:4], points[4:], atol=1e-6)
