"""PTX: one or more scans as text, each a grid of rows behind a header with its pose.

A header is ten lines: columns, rows, the scanner's position and axes (four lines), and the transformation
that turns [x y z 1] from the left into the common coordinates (four lines). Then a row of numbers for
every beam; the beams that hit nothing are 0 0 0.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from stepfield.errors import ScanError
from stepfield.progress import Progress
from stepfield.scan.cloud import Cloud, Floats, Numbers
from stepfield.scan.columns import cloud_of, in_one_sentence, shortened
from stepfield.scan.numbers import read_table
from stepfield.scan.rows import Layout, Table, fields

#: Longest line that is believed.
_LINE = 4096
#: Points transformed at a time: the arithmetic stays in the processor's cache.
_BLOCK = 1 << 16
_HEADER = (1, 1, 3, 3, 3, 3, 4, 4, 4, 4)
_MEANING = (
    "the number of columns",
    "the number of rows",
    "the position of the scanner",
    *["an axis of the scanner"] * 3,
    *["a row of the transformation"] * 4,
)
_ATTRIBUTES = {4: ("intensity",), 7: ("intensity", "red", "green", "blue"), 6: ("red", "green", "blue")}


@dataclass(frozen=True, slots=True)
class _Header:
    """What comes before the rows: how many there are, from which byte, and the 4x4 transformation."""

    beams: int
    start: int
    transformation: Floats


@in_one_sentence
def read(path: Path, progress: Progress) -> Cloud:
    """Read all scans of a PTX file.

    Parameters
    ----------
    path : Path
    progress : Progress

    Returns
    -------
    Cloud
        Axes of float64, transformed; ``intensity`` and ``rgb`` where every scan has them. Beams that hit
        nothing count as not finite.

    Raises
    ------
    ScanError
        A line is not what it should be, or no point is left.
    """
    scans: list[dict[str, Numbers]] = []
    found = promised = 0
    with path.open("rb") as file:
        for header in _headers(file, path):
            progress(header.start / path.stat().st_size, f"reading {path.name}")
            columns = _columns(path, header)
            scans.append(columns)
            found, promised = found + len(columns["x"]), promised + header.beams
    if not promised:
        raise ScanError(f"{path.name}: holds no points; choose another file or export it again")
    warnings = () if found == promised else (shortened(path, found, promised, "rows"),)
    return cloud_of(path, _joined(scans), "rows", warnings=warnings)


def _headers(file: BinaryIO, path: Path) -> Iterator[_Header]:
    """Find the scans, one behind the other."""
    line = 1
    while (first := _skip_blank(file)) is not None:
        lines = [_numbers(first, 0, path, line)]
        lines += [_numbers(file.readline(_LINE), i, path, line + i) for i in range(1, len(_HEADER))]
        beams = int(lines[0][0]) * int(lines[1][0])
        header = _Header(beams, file.tell(), np.array(lines[6:]))
        if beams:
            yield header
        _skip_lines(file, header.start, beams)
        line += len(_HEADER) + beams


def _skip_blank(file: BinaryIO) -> bytes | None:
    """Return the next line that is not blank, or None at the end."""
    while line := file.readline(_LINE):
        if line.strip():
            return line
    return None


def _skip_lines(file: BinaryIO, start: int, count: int) -> None:
    """Move behind ``count`` lines, or to the end of the file."""
    file.seek(start)
    while count > 0 and (block := file.read(1 << 20)):
        lines = block.count(b"\n")
        if lines >= count:
            end = np.flatnonzero(np.frombuffer(block, np.uint8) == ord("\n"))[count - 1]
            file.seek(int(end) + 1 - len(block), 1)
        count -= lines


def _numbers(line: bytes, index: int, path: Path, number: int) -> list[float]:
    """Parse one line of the header."""
    try:
        values = [float(field) for field in fields(line)]
    except ValueError:
        values = []
    whole = index > 1 or (len(values) == 1 and values[0].is_integer() and 0 <= values[0] < 1e12)
    if len(values) != _HEADER[index] or not whole or not np.isfinite(values).all():
        raise ScanError(
            f"{path.name}: line {number} should hold {_MEANING[index]} of a PTX scan; export the file again"
        )
    return values


def _columns(path: Path, header: _Header) -> dict[str, Numbers]:
    """Read the rows of one scan, in the common coordinates and NaN where nothing was hit."""
    table = _rows(path, header)
    names = ("x", "y", "z", *_ATTRIBUTES.get(len(table.columns), ()))
    columns: dict[str, Numbers] = dict(zip(names, table.columns, strict=False))
    for start in range(0, len(table), _BLOCK):
        part = slice(start, start + _BLOCK)
        x, y, z = (columns[axis][part].copy() for axis in "xyz")
        missed = (x == 0) & (y == 0) & (z == 0)
        for axis, factors in zip("xyz", header.transformation.T, strict=False):
            columns[axis][part] = x * factors[0] + y * factors[1] + z * factors[2] + factors[3]
        columns["x"][part][missed] = np.nan
    return columns


def _rows(path: Path, header: _Header) -> Table:
    """Parse the rows of one scan: 3 numbers, and intensity, colours or both behind them."""
    with path.open("rb") as file:
        file.seek(header.start)
        count = len(fields(file.readline(_LINE)))
    wanted = tuple(range(count)) if count in _ATTRIBUTES else (0, 1, 2)
    return read_table(path, header.start, Layout(count, wanted), header.beams)


def _joined(scans: list[dict[str, Numbers]]) -> dict[str, Numbers]:
    """Put the scans one behind the other, with the columns that all of them have."""
    names = [name for name in scans[0] if all(name in scan for scan in scans)]
    return {name: np.concatenate([scan.pop(name) for scan in scans]) for name in names}
