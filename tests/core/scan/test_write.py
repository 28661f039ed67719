"""Writing scans: what is written is read back, whole or not at all, and the same every time."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import laspy
import numpy as np
import pytest
from pye57 import libe57

from stepfield.errors import ScanError
from stepfield.scan import read_scan, write
from stepfield.scan.cloud import Floats, Numbers

SUFFIXES = [".ply", ".pcd", ".las", ".laz", ".e57", ".npy", ".csv", ".xyz", ".txt"]
COUNT = 500
RNG = np.random.default_rng(0)
POINTS = RNG.random((COUNT, 3)) * [10, 20, 3] - [5, 5, 0]
FAR = POINTS + np.array([500_000, 4_000_000, 100])
ATTRIBUTES: dict[str, Numbers] = {
    "rgb": RNG.integers(0, 256, (COUNT, 3), np.uint8),
    "intensity": RNG.integers(0, 60000, COUNT, np.uint16),
    "classification": RNG.integers(0, 20, COUNT, np.uint8),
    "surface": RNG.integers(-1, 5, COUNT, np.int32),
}


def points_read(path: Path) -> Floats:
    return read_scan([path]).points()


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("points", [POINTS, FAR], ids=["near", "far"])
@pytest.mark.parametrize("attributes", [{}, ATTRIBUTES], ids=["bare", "full"])
def test_points_come_back(
    tmp_path: Path, suffix: str, points: Floats, attributes: dict[str, Numbers]
) -> None:
    path = tmp_path / f"scan{suffix}"
    write.write(path, points, attributes)
    np.testing.assert_allclose(points_read(path), points, rtol=0, atol=write.EXACT_ENOUGH)
    assert os.listdir(tmp_path) == [path.name]


@pytest.mark.parametrize("suffix", [".e57", ".npy", ".csv", ".xyz", ".txt"])
def test_what_stores_float64_loses_nothing(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"scan{suffix}"
    write.write(path, FAR, {})
    np.testing.assert_array_equal(points_read(path), FAR)


@pytest.mark.parametrize("suffix", [".ply", ".pcd", ".las", ".laz", ".e57", ".npy", ".csv"])
def test_attributes_come_back(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"scan{suffix}"
    write.write(path, POINTS, ATTRIBUTES)
    read = read_scan([path]).attributes
    kept = {"rgb", "intensity"} if suffix == ".e57" else {"rgb", "intensity", "classification"}
    assert set(read) == kept
    for name in kept:
        np.testing.assert_array_equal(read[name], ATTRIBUTES[name])


def surface_of_e57(path: Path) -> Numbers:
    image = libe57.ImageFile(str(path), "r")
    surface = np.empty(COUNT, "q")
    buffers = libe57.VectorSourceDestBuffer()
    buffers.append(libe57.SourceDestBuffer(image, "stepfield:surface", surface, COUNT, True, True))
    image.root()["data3D"][0]["points"].reader(buffers).read()
    image.close()
    return surface


def last_record(path: Path, skip: bytes) -> Numbers:
    """Return the last field, an int32, of binary records behind a header."""
    raw = path.read_bytes()
    body = raw[raw.index(skip) + len(skip) :]
    records = np.frombuffer(body, np.uint8).reshape(COUNT, -1)
    return np.ascontiguousarray(records[:, -4:]).view("<i4").ravel()


SURFACES: dict[str, Callable[[Path], Numbers]] = {
    ".ply": lambda path: last_record(path, b"end_header\n"),
    ".pcd": lambda path: last_record(path, b"DATA binary\n"),
    ".las": lambda path: np.asarray(laspy.read(path)["surface"]),
    ".laz": lambda path: np.asarray(laspy.read(path)["surface"]),
    ".e57": surface_of_e57,
    ".npy": lambda path: np.asarray(np.load(path)["surface"]),
    ".csv": lambda path: np.genfromtxt(path, delimiter=",", names=True)["surface"],
    ".xyz": lambda path: np.loadtxt(path)[:, -1],
    ".txt": lambda path: np.loadtxt(path)[:, -1],
}


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_true_surface_of_every_point_is_kept(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"scan{suffix}"
    write.write(path, POINTS, {"surface": ATTRIBUTES["surface"]})
    np.testing.assert_array_equal(SURFACES[suffix](path), ATTRIBUTES["surface"])


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_same_scan_makes_the_same_bytes(tmp_path: Path, suffix: str) -> None:
    first, second = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    write.write(first, POINTS, ATTRIBUTES)
    write.write(second, POINTS.copy(), dict(ATTRIBUTES))
    assert first.read_bytes() == second.read_bytes()


def test_bare_columns_names_and_types(tmp_path: Path) -> None:
    write.write(tmp_path / "scan.csv", POINTS[:1], {"inside": np.array([True]), "surface": np.array([3])})
    x, y, z = POINTS[0].tolist()
    assert (tmp_path / "scan.csv").read_text() == f"x,y,z,inside,surface\n{x},{y},{z},1,3\n"


def test_fractions_of_intensity_fill_the_range_of_las(tmp_path: Path) -> None:
    write.write(tmp_path / "scan.las", POINTS[:3], {"intensity": np.array([0, 0.5, 1], np.float32)})
    np.testing.assert_array_equal(laspy.read(tmp_path / "scan.las").intensity, [0, 32768, 65535])


def test_las_scales_suit_the_width_of_the_scan(tmp_path: Path) -> None:
    for width, scale in [(10, 1e-6), (100_000, 1e-4), (1_000_000, 1e-3), (1e12, 1e12 / 2**30)]:
        path = tmp_path / "scan.las"
        write.write(path, np.array([[0, 0, 0], [width, 1, 1]], float), {})
        header = laspy.read(path).header
        np.testing.assert_allclose(header.scales, scale)
        assert header.generating_software == "stepfield"


def test_capital_suffixes_count(tmp_path: Path) -> None:
    write.write(tmp_path / "SCAN.LAZ", POINTS, {})
    assert laspy.read(tmp_path / "SCAN.LAZ").header.are_points_compressed


@pytest.mark.parametrize("name", ["scan.obj", "scan", "scan.zip"])
def test_an_unknown_suffix_names_the_known_ones(tmp_path: Path, name: str) -> None:
    with pytest.raises(ScanError, match=r"\.csv \.e57 \.las \.laz \.npy \.pcd \.ply \.txt \.xyz"):
        write.write(tmp_path / name, POINTS, {})


@pytest.mark.parametrize("points", [np.empty((0, 3)), np.array([[0, np.nan, 0]]), np.array([[np.inf, 0, 0]])])
def test_nothing_to_write_is_one_sentence(tmp_path: Path, points: Floats) -> None:
    with pytest.raises(ScanError, match="no points to write, or not all are finite"):
        write.write(tmp_path / "scan.ply", points, {})
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_place_that_is_not_there_is_one_sentence(tmp_path: Path, suffix: str) -> None:
    with pytest.raises(ScanError, match="cannot be written") as failure:
        write.write(tmp_path / "none" / f"scan{suffix}", POINTS, {})
    assert "\n" not in str(failure.value)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_failure_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"scan{suffix}"
    path.write_bytes(b"old")

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(ScanError, match="no space left on device"):
        write.write(path, POINTS, ATTRIBUTES)
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == [path.name]


FULL_DISK = """
import resource, sys
from pathlib import Path
import numpy as np
from stepfield.errors import ScanError
from stepfield.scan import write
points = np.random.default_rng(0).random((20_000, 3)) * 1e6
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
for suffix in sys.argv[2:]:
    try:
        write.write(Path(sys.argv[1], "scan" + suffix), points, {})
        sys.exit(f"{suffix} was written")
    except ScanError as error:
        assert "cannot be written" in str(error) and "\\n" not in str(error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="this system cannot limit the size of files")
def test_a_disk_that_fills_up_is_one_sentence_and_leaves_nothing(tmp_path: Path) -> None:
    run = subprocess.run(
        [sys.executable, "-c", FULL_DISK, str(tmp_path), *SUFFIXES], capture_output=True, check=False
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, b"", b"")
    assert os.listdir(tmp_path) == []
