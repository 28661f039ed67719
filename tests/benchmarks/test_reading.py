"""Reading each format beside the plain library call an engineer would make for it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import laspy
import numpy as np
import pye57
import pytest
from numpy.typing import NDArray
from tests.benchmarks.conftest import POINTS, Table, seconds

from stepfield.formats import FORMATS
from stepfield.scan import read_scan
from stepfield.scan.write import write


def ply(path: Path) -> Any:
    """Skip the header and take the floats."""
    with path.open("rb") as file:
        while file.readline().strip() != b"end_header":
            pass
        return np.fromfile(file, "<f4").reshape(-1, 3).copy()


def pcd(path: Path) -> Any:
    """Skip the header and take the floats."""
    with path.open("rb") as file:
        while not file.readline().startswith(b"DATA"):
            pass
        return np.fromfile(file, "<f4").reshape(-1, 3).copy()


def las(path: Path) -> Any:
    """Read all points and make their coordinates, as laspy's documentation does."""
    return laspy.read(path).xyz


def e57(path: Path) -> Any:
    """Read the one scan."""
    with pye57.E57(str(path)) as file:
        return file.read_scan(0, ignore_missing_fields=True)


def xyz(path: Path) -> Any:
    """Parse with numpy's own reader."""
    return np.loadtxt(path)


LIBRARY: dict[str, tuple[str, Callable[[Path], Any]]] = {
    ".ply": ("numpy.fromfile and a copy", ply),
    ".pcd": ("numpy.fromfile and a copy", pcd),
    ".las": ("laspy.read, xyz", las),
    ".laz": ("laspy.read, xyz", las),
    ".e57": ("pye57 read_scan", e57),
    ".xyz": ("numpy.loadtxt", xyz),
}


@pytest.mark.parametrize("suffix", list(LIBRARY))
def test_reading(storeys: NDArray[np.float32], table: Table, folder: Path, suffix: str) -> None:
    path = folder / f"storeys{suffix}"
    write(path, storeys.astype(np.float64), {})
    name, call = LIBRARY[suffix]
    reader = __import__(f"stepfield.scan.{FORMATS[suffix]}", fromlist=["read"]).read
    theirs = seconds(lambda: call(path), 2)
    table.add(
        f"reading {POINTS / 1e6:g} M points, {suffix[1:]}",
        seconds(lambda: reader(path), 2),
        name,
        theirs,
        "<= 1.3",
    )
    bytes_read = seconds(path.read_bytes, 2)
    table.add(
        f"  as a scan, digest and all, {suffix[1:]}",
        seconds(lambda: digested(path), 1),
        "its bytes, read once",
        bytes_read,
    )
    path.unlink()


def digested(path: Path) -> str:
    """Read a scan and wait for its digest."""
    return read_scan([path]).files[0].sha256
