"""E57: scans with and without poses, colours and marks; damage that checksums find, and lies behind them."""

from __future__ import annotations

import struct
import tracemalloc
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pye57 import libe57

from stepfield.errors import ScanError
from stepfield.scan import e57
from stepfield.scan.cloud import Cloud, Floats, Numbers

ODD = "../scans-malformed"
POINTS = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.5], [-1.0, 0.0, 2.0]])
XYZ = ("cartesianX", "cartesianY", "cartesianZ")
RANGE = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")


class Book:
    """An E57 file being written, scan by scan."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.image = libe57.ImageFile(str(path), "w")
        self.image.extensionsAdd("", libe57.E57_V1_0_URI)
        self.scans = libe57.VectorNode(self.image, True)
        self.image.root().set("data3D", self.scans)

    def add(self, columns: Mapping[str, Numbers], **parts: Mapping[str, Any]) -> None:
        """Add a scan; parts are structures of numbers, such as a pose."""
        scan = libe57.StructureNode(self.image)
        for name, part in parts.items():
            scan.set(name, self._structure(part))
        prototype = libe57.StructureNode(self.image)
        buffers = libe57.VectorSourceDestBuffer()
        alive = []  # the library keeps addresses only
        count = len(next(iter(columns.values())))
        for name, values in columns.items():
            low, high = (values.min().item(), values.max().item()) if count else (0, 1)
            node = (
                libe57.FloatNode(self.image, float(low), libe57.E57_DOUBLE, float(low), float(high))
                if values.dtype.kind == "f"
                else libe57.IntegerNode(self.image, low, low, max(high, low + 1))
            )
            prototype.set(name, node)
            kind = "d" if values.dtype.kind == "f" else "q"
            memory = np.ascontiguousarray(values, kind) if count else np.zeros(1, kind)
            alive.append(memory)
            buffers.append(libe57.SourceDestBuffer(self.image, name, memory, len(memory), True, True))
        points = libe57.CompressedVectorNode(self.image, prototype, libe57.VectorNode(self.image, True))
        scan.set("points", points)
        self.scans.append(scan)
        writer = points.writer(buffers)
        writer.write(count)
        writer.close()

    def _structure(self, values: Mapping[str, Any]) -> Any:
        node = libe57.StructureNode(self.image)
        for name, value in values.items():
            inner = (
                self._structure(value)
                if isinstance(value, Mapping)
                else libe57.FloatNode(self.image, float(value))
            )
            node.set(name, inner)
        return node


@pytest.fixture
def book(tmp_path: Path) -> Iterator[Book]:
    opened = Book(tmp_path / "scan.e57")
    yield opened
    opened.image.close()


def read(book: Book) -> Cloud:
    book.image.close()
    return e57.read(book.path)


def points_of(cloud: Cloud) -> Floats:
    return np.column_stack([axis.values() for axis in cloud.axes])


def columns(points: Floats, names: tuple[str, str, str] = XYZ) -> dict[str, Numbers]:
    return dict(zip(names, points.T, strict=True))


def outcome(path: Path) -> Cloud | ScanError:
    """Read a file that may be damaged: a cloud or one sentence, and nothing else."""
    try:
        return e57.read(path)
    except ScanError as error:
        failure = error
    assert "\n" not in str(failure)
    assert str(failure).startswith(path.name)
    return failure


def test_a_scan_without_anything_but_points(book: Book) -> None:
    book.add(columns(POINTS))
    cloud = read(book)
    np.testing.assert_array_equal(points_of(cloud), POINTS)
    assert (cloud.unit, dict(cloud.attributes), cloud.warnings) == ("m", {}, ())


def test_poses_bring_scans_together(book: Book) -> None:
    quarter = np.sqrt(0.5)
    book.add(columns(POINTS))
    book.add(
        columns(POINTS),
        pose={
            "rotation": {"w": quarter, "x": 0, "y": 0, "z": quarter},
            "translation": {"x": 10, "y": 20, "z": 30},
        },
    )
    book.add(columns(POINTS), pose={"translation": {"x": 0, "y": 0, "z": 5}})
    turned = np.column_stack([10 - POINTS[:, 1], 20 + POINTS[:, 0], 30 + POINTS[:, 2]])
    expected = np.concatenate([POINTS, turned, POINTS + np.array([0, 0, 5])])
    np.testing.assert_allclose(points_of(read(book)), expected, atol=1e-12)


def test_a_rotation_need_not_be_of_unit_length(book: Book) -> None:
    book.add(columns(POINTS), pose={"rotation": {"w": 0, "x": 3, "y": 0, "z": 0}})
    np.testing.assert_allclose(points_of(read(book)), POINTS * [1, -1, -1], atol=1e-12)


def test_a_pose_that_is_none_is_one_sentence(book: Book) -> None:
    book.add(columns(POINTS), pose={"rotation": {"w": 0, "x": 0, "y": 0, "z": 0}})
    with pytest.raises(ScanError, match="the pose of a scan is no rotation"):
        read(book)


def test_spherical_coordinates(book: Book) -> None:
    rae = np.array([[2.0, 0.0, 0.0], [2.0, np.pi / 2, 0.0], [2.0, 0.0, np.pi / 2]])
    book.add(columns(rae, RANGE))
    np.testing.assert_allclose(points_of(read(book)), [[2, 0, 0], [0, 2, 0], [0, 0, 2]], atol=1e-12)


def test_points_marked_invalid_are_dropped_and_counted(book: Book) -> None:
    book.add(columns(POINTS) | {"cartesianInvalidState": np.array([0, 2, 0]), "intensity": np.arange(3.0)})
    cloud = read(book)
    np.testing.assert_array_equal(points_of(cloud), POINTS[[0, 2]])
    np.testing.assert_array_equal(cloud.attributes["intensity"], [0, 2])
    assert cloud.not_finite == 1


def test_only_invalid_points_are_one_sentence(book: Book) -> None:
    book.add(columns(POINTS) | {"cartesianInvalidState": np.array([1, 2, 1])})
    with pytest.raises(ScanError, match="no points that are valid"):
        read(book)


def test_colours_come_in_bytes_whatever_their_range(book: Book) -> None:
    deep = {name: np.array([0, 32768, 65535]) for name in ("colorRed", "colorGreen", "colorBlue")}
    book.add(columns(POINTS) | deep)
    np.testing.assert_array_equal(read(book).attributes["rgb"], [[0] * 3, [128] * 3, [255] * 3])


def test_attributes_of_some_scans_only_are_left_out(book: Book) -> None:
    book.add(columns(POINTS) | {"intensity": np.arange(3.0)})
    book.add(columns(POINTS))
    assert dict(read(book).attributes) == {}


def test_blocks_are_joined_in_order(book: Book) -> None:
    points = np.random.default_rng(1).random((2 * e57.BLOCK + 100, 3))
    book.add(columns(points))
    np.testing.assert_array_equal(points_of(read(book)), points)


def test_no_scans_and_empty_scans_are_one_sentence(book: Book, tmp_path: Path) -> None:
    with pytest.raises(ScanError, match="holds no points"):
        read(book)
    empty = Book(tmp_path / "empty.e57")
    empty.add(columns(POINTS[:0]))
    with pytest.raises(ScanError, match="holds no points"):
        read(empty)


def test_points_without_coordinates_are_one_sentence(book: Book) -> None:
    book.add({"cartesianX": np.arange(3.0), "intensity": np.arange(3.0)})
    with pytest.raises(ScanError, match="without x, y and z"):
        read(book)


# The pages of a file end in a checksum; to lie beyond it, it has to be made anew.
def with_checksums(raw: bytes) -> bytes:
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
        table.append(value)
    pages = []
    for start in range(0, len(raw), 1024):
        crc = 0xFFFFFFFF
        for byte in raw[start : start + 1020]:
            crc = crc >> 8 ^ table[(crc ^ byte) & 255]
        pages.append(raw[start : start + 1020] + struct.pack(">I", crc ^ 0xFFFFFFFF))
    return b"".join(pages)


@pytest.fixture
def whole(book: Book) -> bytes:
    rng = np.random.default_rng(3)
    colours = {name: rng.integers(0, 256, 40) for name in ("colorRed", "colorGreen", "colorBlue")}
    state = {"cartesianInvalidState": rng.integers(0, 3, 40)}
    book.add(columns(rng.random((40, 3))) | colours | state, pose={"translation": {"x": 1, "y": 2, "z": 3}})
    book.image.close()
    return book.path.read_bytes()


@pytest.mark.parametrize("count", [b"41", b"99", b"1999999999", b"9" * 18, b"9" * 30, b"-5"])
def test_a_claimed_count_costs_nothing(tmp_path: Path, whole: bytes, count: bytes) -> None:
    start, length = struct.unpack_from("<QQ", whole, 24)
    start -= start // 1024 * 4
    text = b"".join(whole[at : at + 1020] for at in range(0, len(whole), 1024))
    xml = text[start : start + length]
    assert xml.count(b'recordCount="40"') == 1
    xml = xml.replace(b'recordCount="40"', b'recordCount="' + count + b'"')
    text = text[:32] + struct.pack("<Q", len(xml)) + text[40:start] + xml
    text += b" " * (-len(text) % 1020)
    raw = b"".join(text[at : at + 1020] + b"\0" * 4 for at in range(0, len(text), 1020))
    path = tmp_path / "liar.e57"
    path.write_bytes(with_checksums(raw[:16] + struct.pack("<Q", len(raw)) + raw[24:]))
    tracemalloc.start()
    result = outcome(path)
    assert tracemalloc.get_traced_memory()[1] < 20_000_000
    tracemalloc.stop()
    assert isinstance(result, ScanError) or len(result) <= 40


def test_a_truncated_file_is_one_sentence(tmp_path: Path, whole: bytes) -> None:
    path = tmp_path / "cut.e57"
    for size in (0, 7, 8, 47, 48, 1024, len(whole) - 1):
        path.write_bytes(whole[:size])
        assert isinstance(outcome(path), ScanError)


def test_flipped_bytes_are_one_sentence(tmp_path: Path, whole: bytes) -> None:
    path = tmp_path / "flipped.e57"
    rng = np.random.default_rng(4)
    for _ in range(60):
        damaged = bytearray(whole)
        damaged[rng.integers(len(whole))] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        assert isinstance(outcome(path), ScanError)


def test_damage_behind_right_checksums_gives_a_cloud_or_a_sentence(tmp_path: Path, whole: bytes) -> None:
    path = tmp_path / "damaged.e57"
    rng = np.random.default_rng(5)
    (xml,) = struct.unpack_from("<Q", whole, 24)
    digits = [at for at in range(xml, len(whole)) if whole[at] in b"0123456789" and at % 1024 < 1020]
    for turn in range(150):
        damaged = bytearray(whole)
        for _ in range(int(rng.integers(1, 4))):
            if turn % 3 == 0:
                damaged[rng.choice(digits)] = int(rng.choice(list(b"0123456789-.e")))
            else:
                damaged[rng.integers(0, xml if turn % 3 == 1 else len(whole))] ^= 1 << int(rng.integers(8))
        path.write_bytes(with_checksums(bytes(damaged)))
        result = outcome(path)
        assert isinstance(result, ScanError) or len(result) <= 1000


@pytest.mark.parametrize(
    ("name", "count", "attributes"),
    [
        ("pye57__pumpAVisualReferenceImage.e57", 155201, {"rgb", "intensity"}),
        (f"{ODD}/pye57__testWithNormals.e57", 2, set()),
        (f"{ODD}/pye57__translationWithoutRotation.e57", 4, set()),
        (f"{ODD}/PDAL__A4.e57", 4, {"rgb", "intensity"}),
        (f"{ODD}/PDAL__A4_moved.e57", 4, {"rgb", "intensity"}),
        (f"{ODD}/PDAL__A_B.e57", 6, {"rgb", "intensity"}),
        (f"{ODD}/PDAL__A_B_different_dims.e57", 2, set()),
        (f"{ODD}/PDAL__A_merged_B.e57", 6, {"rgb", "intensity"}),
        (f"{ODD}/PDAL__A_moved_B.e57", 6, {"rgb", "intensity"}),
        (f"{ODD}/PDAL__B2.e57", 2, {"rgb", "intensity"}),
    ],
)
def test_real_files(real_scan: Callable[[str], Path], name: str, count: int, attributes: set[str]) -> None:
    cloud = e57.read(real_scan(name))
    assert (len(cloud), set(cloud.attributes), cloud.unit) == (count, attributes, "m")


def test_a_wrong_checksum_is_one_sentence(
    real_scan: Callable[[str], Path], capfd: pytest.CaptureFixture[str]
) -> None:
    error = outcome(real_scan(f"{ODD}/libE57Format-test-data__bad-crc.e57"))
    assert "checksum mismatch" in str(error)
    assert capfd.readouterr() == ("", "")
