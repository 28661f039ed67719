"""NPY and NPZ: arrays of points and of records, checked before they are believed, never unpickled."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from stepfield.errors import ScanError
from stepfield.scan.cloud import Cloud, Reader
from stepfield.scan.npy import read

Parse = Callable[[Reader, str, bytes], Cloud]
Damage = Callable[[Reader, str, bytes], None]
Find = Callable[[str], Path]

POINTS = np.array([[0.5, 1, 2], [3, -4, 5], [6, 7, 8.25]])


def npy(array: NDArray[np.generic], **options: bool) -> bytes:
    file = io.BytesIO()
    np.save(file, array, **options)
    return file.getvalue()


def npz(compressed: bool = False, **arrays: NDArray[np.generic]) -> bytes:
    file = io.BytesIO()
    save: Callable[..., None] = np.savez_compressed if compressed else np.savez
    save(file, **arrays)
    return file.getvalue()


def points(cloud: Cloud) -> list[list[float]]:
    rows: list[list[float]] = np.column_stack([axis.values() for axis in cloud.axes]).tolist()
    return rows


@pytest.mark.parametrize("kind", ["<f4", ">f8", "<i2", ">i4"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_rows_of_any_kind_and_order(parse: Parse, kind: str, order: str) -> None:
    array = np.asarray(np.column_stack([POINTS, POINTS])).astype(kind, order=order)  # type: ignore[call-overload]
    cloud = parse(read, "a.npy", npy(array))
    assert points(cloud) == array[:, :3].tolist()
    assert cloud.axes[0].raw.dtype == np.dtype(kind).newbyteorder("="), "the kind stays, in native byte order"


def test_records_with_integers_and_attributes(parse: Parse) -> None:
    kinds = [("X", "<i4"), ("Y", "<i4"), ("Z", "<i4"), ("Intensity", "<u2"), ("Classification", "u1")]
    array = np.array(
        [(1, 2, 3, 9, 2, 65535, 0, 256)], [*kinds, ("Red", "<u2"), ("Green", "<u2"), ("Blue", "<u2")]
    )
    cloud = parse(read, "a.npy", npy(array))
    assert cloud.axes[0].raw.dtype == np.int32, "integers stay integers"
    assert "carry no scale" in cloud.warnings[0], "the operator must know that the unit is unknown"
    assert cloud.attributes["intensity"].tolist() == [9]
    assert cloud.attributes["classification"].tolist() == [2]
    assert cloud.attributes["rgb"].tolist() == [[255, 0, 1]]


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize(
    "arrays",
    [
        {"points": POINTS, "other": POINTS * 2},
        {"xyz": POINTS},
        {"pos": POINTS, "label": np.zeros(3)},
        {"x": POINTS[:, 0], "y": POINTS[:, 1], "z": POINTS[:, 2], "c": np.zeros((3, 3))},
        {"whatever": POINTS, "index": np.zeros((4, 2))},
    ],
)
def test_archives(parse: Parse, arrays: dict[str, NDArray[np.float64]], compressed: bool) -> None:
    assert points(parse(read, "a.npz", npz(compressed, **arrays))) == POINTS.tolist()


def test_truncated_file_gives_its_whole_rows(parse: Parse) -> None:
    cloud = parse(read, "a.npy", npy(POINTS)[:-1])
    assert points(cloud) == POINTS[:2].tolist()
    assert "2 of its 3" in cloud.warnings[0]


def lying(shape: str) -> bytes:
    head = b"{'descr': '<f8', 'fortran_order': False, 'shape': %s, }" % shape.encode()
    return b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head + b"\0" * 24


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.npy", b"", "cannot be read"),
        ("a.npy", npy(POINTS.T.repeat(7, axis=1)), "3 x 21.*transpose"),
        ("a.npy", npy(POINTS[:, :2]), "3 x 2"),
        ("a.npy", npy(np.zeros((2, 2, 3))), "2 x 2 x 3"),
        ("a.npy", npy(np.array(1.0)), "shape"),
        ("a.npy", npy(POINTS.astype(complex)), "not numbers"),
        ("a.npy", npy(np.full((2, 3), np.nan)), "holds no points"),
        ("a.npy", npy(np.zeros(2, [("x", "f4"), ("y", "f4")])), "have no z"),
        ("a.npy", npy(np.zeros((2, 3), [("x", "f4"), ("y", "f4"), ("z", "f4")])), "2 dimensions"),
        ("a.npy", npy(np.array([[None] * 3]), allow_pickle=True), "Python objects"),
        ("a.npy", lying("(-3, 3)"), "impossible"),
        ("a.npy", lying("(3, 99999999999)"), "transpose|shape|holds no points|x"),
        ("a.npz", b"PK\x03\x04 no archive", "cannot be read"),
        ("a.npz", npz(a=POINTS, b=POINTS), "2 arrays"),
        ("a.npz", npz(a=np.zeros(3)), "0 arrays"),
        ("a.npz", npz(x=POINTS[:, 0], y=POINTS[:2, 1], z=POINTS[:, 2]), "equally long"),
        ("a.npz", npz(points=np.array([[None] * 3])), "Python objects"),
    ],
)
def test_what_cannot_be_read_is_one_sentence(parse: Parse, name: str, content: bytes, message: str) -> None:
    with pytest.raises(ScanError, match=message):
        parse(read, name, content)


def test_a_billion_claimed_points_cost_nothing(parse: Parse) -> None:
    assert len(parse(read, "a.npy", lying("(9000000000, 3)"))) == 1, (
        "no more rows than the file has bytes for"
    )


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.npy", npy(POINTS)),
        ("b.npy", npy(np.zeros(4, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<u2")]))),
        ("a.npz", npz(points=POINTS)),
        ("b.npz", npz(True, x=POINTS[:, 0], y=POINTS[:, 1], z=POINTS[:, 2])),
    ],
)
def test_damage_never_escapes(survives_damage: Damage, name: str, content: bytes) -> None:
    survives_damage(read, name, content)


def test_real_file(real_scan: Find) -> None:
    cloud = read(real_scan("PDAL__1.2-with-color.npy"))
    assert len(cloud) == 1065
    assert cloud.axes[0].raw.dtype == np.int32


@pytest.mark.parametrize("name", ["threedim", "twodim"])
def test_real_files_without_points(real_scan: Find, name: str) -> None:
    with pytest.raises(ScanError, match="dimensions"):
        read(real_scan(f"../scans-malformed/PDAL__{name}.npy"))
