"""A scan of one or more files: metres, z up, right-handed, exact; who it came from is known."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from stepfield.errors import Cancelled, ScanError
from stepfield.formats import FORMATS
from stepfield.parameters import METRES, Unit, Up
from stepfield.scan import read_scan
from stepfield.scan.cloud import Axis, Cloud
from stepfield.scan.scan import joined
from stepfield.scan.write import write

POINTS = np.array([[1.0, 2.0, 3.0], [4.0, 6.0, 8.0], [-1.0, 0.5, 2.5]])


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "scan.npy"
    np.save(path, POINTS)
    return path


@pytest.mark.parametrize("up", get_args(Up))
def test_the_up_axis_becomes_z_by_a_rotation(file: Path, up: Up) -> None:
    """A reflection would mirror every building."""
    turned = read_scan([file], up=up).points()
    axis, sign = "xyz".index(up[-1]), -1 if up.startswith("-") else 1
    assert turned[:, 2].tolist() == (sign * POINTS[:, axis]).tolist()
    rotation = np.linalg.solve(POINTS, turned)
    assert np.linalg.det(rotation) == pytest.approx(1)
    assert np.allclose(rotation @ rotation.T, np.eye(3))


@pytest.mark.parametrize("unit", get_args(Unit))
def test_the_unit_becomes_metres(file: Path, unit: Unit) -> None:
    scan = read_scan([file], unit=unit)
    assert np.allclose(scan.points(), POINTS * METRES[unit], rtol=1e-15)
    assert (scan.unit, scan.unit_factor) == (unit, METRES[unit])


def test_a_us_survey_foot_is_not_an_international_one() -> None:
    assert METRES["us-ft"] / METRES["ft"] == pytest.approx(1.000002, abs=1e-9)


def test_several_files_are_one_scan(tmp_path: Path) -> None:
    paths = [tmp_path / f"{i}.npy" for i in range(3)]
    for i, path in enumerate(paths):
        np.save(path, POINTS + i)
    scan = read_scan(paths)
    assert np.array_equal(scan.points(), np.vstack([POINTS, POINTS + 1, POINTS + 2]))
    assert [(f.name, f.points) for f in scan.files] == [("0.npy", 3), ("1.npy", 3), ("2.npy", 3)]


def test_the_digest_is_that_of_the_file(file: Path) -> None:
    assert read_scan([file]).files[0].sha256 == hashlib.sha256(file.read_bytes()).hexdigest()


def test_las_integers_of_tiles_stay_integers_when_they_share_a_scale() -> None:
    def tile(raw: list[int], offset: float) -> Cloud:
        axis = Axis(np.array(raw, np.int32), 0.001, offset)
        return Cloud((axis, axis, axis))

    same = joined([tile([1, 2], 10.0), tile([3], 10.0)], (), None, "z")
    assert same.x.raw.dtype == np.int32
    other = joined([tile([1, 2], 10.0), tile([3], 20.0)], (), None, "z")
    assert other.x.values().tolist() == [10.001, 10.002, 20.003]


def test_attributes_that_only_some_files_have_are_left_out() -> None:
    axis = Axis(np.zeros(2))
    one = Cloud((axis, axis, axis), {"intensity": np.ones(2), "classification": np.ones(2, np.uint8)})
    other = Cloud((axis, axis, axis), {"intensity": np.zeros(2)})
    assert list(joined([one, other], (), None, "z").attributes) == ["intensity"]


def test_different_reference_systems_are_said_to_differ() -> None:
    axis = Axis(np.zeros(2))
    clouds = [Cloud((axis, axis, axis), crs=crs) for crs in ("one", "another")]
    assert "different coordinate reference systems" in joined(clouds, (), None, "z").warnings[0]


def test_a_depth_camera_frame_is_said_to_want_another_up_axis(real_scan: object) -> None:
    assert callable(real_scan)
    frame = real_scan("data__capture0001.pcd")
    assert "--up=-y" in read_scan([frame]).warnings[-1]
    assert read_scan([frame], up="-y").warnings == ()


@pytest.mark.parametrize("suffix", sorted(FORMATS))
def test_an_empty_file_of_every_format_is_one_sentence(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"empty{suffix}"
    path.write_bytes(b"")
    with pytest.raises(ScanError) as caught:
        read_scan([path])
    assert path.name in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_ends_of_a_long_strided_column_are_found_in_every_chunk() -> None:
    """NaN must not hide in the middle, nor the smallest value at a seam between chunks."""
    table = np.random.default_rng(2).random((100_001, 3)).astype(np.float32)
    table[65_536, 1], table[32_767, 1] = -3.0, 7.0
    column = Axis(table[:, 1])
    assert column.bounds() == (-3.0, 7.0)
    assert column.is_finite
    table[99_999, 1] = np.nan
    assert not Axis(table[:, 1]).is_finite


@pytest.mark.parametrize("suffix", [".las", ".laz", ".e57", ".xyz"])
def test_reading_a_large_file_can_be_stopped_on_the_way(tmp_path: Path, suffix: str) -> None:
    """Without it, Cancel would do nothing for as long as the slowest formats take."""
    path = tmp_path / f"large{suffix}"
    write(path, np.random.default_rng(3).random((1_500_000, 3)).round(3), {})
    shares: list[float] = []

    def stop(share: float, what: str) -> None:
        shares.append(share)
        if share > 0:
            raise Cancelled

    with pytest.raises(Cancelled):
        read_scan([path], progress=stop)
    assert 0 < shares[-1] < 1
