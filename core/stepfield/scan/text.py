"""Text clouds (XYZ, TXT, CSV, ASC, PTS): rows of numbers that say little about themselves.

What the columns mean comes from a header line where there is one, else from the customs of the format.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from stepfield.errors import ScanError
from stepfield.progress import Progress
from stepfield.scan.cloud import Cloud, Numbers
from stepfield.scan.columns import USEFUL, cloud_of, in_one_sentence, plain
from stepfield.scan.numbers import first_rows, read_table
from stepfield.scan.rows import Layout, Table, fields, is_comment, is_number, layout_of

_HEAD = 1 << 16
_BOM = b"\xef\xbb\xbf"
_XYZ = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True)
class Head:
    """What stands before the first row of numbers: its byte, the count and the names given there."""

    start: int
    count: int | None = None
    names: tuple[str, ...] = ()


@in_one_sentence
def read(path: Path, progress: Progress) -> Cloud:
    """Read a text cloud.

    Raises
    ------
    ScanError
        A row cannot be understood, or there are none.
    """
    head = _head(path)
    rows = first_rows(path, head.start)
    if not rows:
        raise ScanError(f"{path.name}: holds no points (no row of numbers); choose a file of x y z rows")
    places, warnings = _places(path, head.names, rows)
    layout = _layout(path, rows, places)
    table = read_table(path, head.start, layout, progress=progress)
    columns = _columns(table, places, path.suffix.lower() == ".pts" or bool(head.names))
    warnings += _remarks(path, head, table, layout)
    return cloud_of(path, columns, "rows", warnings=tuple(warnings))


def _head(path: Path) -> Head:
    """Find the first row of numbers, and what the lines before it say."""
    with path.open("rb") as file:
        text = file.read(_HEAD)
    at = 3 if text.startswith(_BOM) else 0
    count: int | None = None
    names: tuple[str, ...] = ()
    told = False
    for line in text[at:].splitlines(keepends=True):
        parts = fields(line)
        if is_comment(line):
            names = names or _named_in_comment(line)
        elif len(parts) == 1 and parts[0].isdigit() and count is None and not told:
            count = int(parts[0][:18])
        elif told or all(is_number(part) or not part for part in parts[:3]):
            break
        else:
            names, told = _names(line), True
        at += len(line)
    return Head(at, count, names)


def _named_in_comment(line: bytes) -> tuple[str, ...]:
    """Return a comment's words if they name the coordinates, as CloudCompare's exports do."""
    names = _names(line.strip().lstrip(b"#/ \t"))
    return names if set("xyz") <= set(names) else ()


def _names(line: bytes) -> tuple[str, ...]:
    """Return the plain names in a header, quoted or not."""
    text = line.decode("utf-8", "replace").replace("\0", " ").strip()
    mark = next((mark for mark in ";,\t" if mark in text), " ")
    return tuple(plain(name) for name in next(csv.reader([text], delimiter=mark, skipinitialspace=True), []))


def _places(path: Path, names: tuple[str, ...], rows: list[bytes]) -> tuple[dict[str, int], list[str]]:
    """Find which column holds what: by the header, else by custom."""
    width = len(fields(rows[0], layout_of(rows, ()).decimal_comma))
    named = {name: names.index(name) for name in names if name in USEFUL}
    if _XYZ.keys() <= named.keys() and max(named[axis] for axis in _XYZ) < width:
        return {name: place for name, place in named.items() if place < width}, []
    if not names:
        return _customary(path.suffix.lower(), rows, width), []
    missing = " or ".join(axis for axis in _XYZ if axis not in named) or "column for each coordinate"
    remark = f"{path.name}: its header names no {missing}; the first three columns are taken as x, y, z"
    return dict(_XYZ), [remark]


def _customary(suffix: str, rows: list[bytes], width: int) -> dict[str, int]:
    """Return what the columns of a file without a header usually are."""
    places = dict(_XYZ)
    if suffix == ".pts" and width in (4, 7):
        places["intensity"] = 3
    first = 4 if suffix == ".pts" and width == 7 else 3
    if width == first + 3 and all(_is_byte(part) for row in rows[:100] for part in fields(row)[first:width]):
        places |= {"red": first, "green": first + 1, "blue": first + 2}
    return places


def _is_byte(field: bytes) -> bool:
    return field.isdigit() and len(field) < 4 and int(field) <= 255


def _layout(path: Path, rows: list[bytes], places: dict[str, int]) -> Layout:
    """Return the layout of the rows, x, y and z first."""
    wanted = tuple(places[name] for name in _ordered(places))
    return replace(layout_of(rows, wanted), counts=path.suffix.lower() == ".pts")


def _ordered(places: dict[str, int]) -> list[str]:
    return [*_XYZ, *(name for name in places if name not in _XYZ)]


def _columns(table: Table, places: dict[str, int], sure: bool) -> dict[str, Numbers]:
    """Name the columns; colours that were only guessed must be bytes in every row."""
    columns = dict(zip(_ordered(places), table.columns, strict=True))
    guessed = [] if sure else [name for name in ("red", "green", "blue") if name in columns]
    if not all(_all_bytes(columns[name]) for name in guessed):
        for name in guessed:
            del columns[name]
    return columns


def _all_bytes(column: Numbers) -> bool:
    return bool(np.all((column >= 0) & (column <= 255) & (column == np.floor(column))))


def _remarks(path: Path, head: Head, table: Table, layout: Layout) -> list[str]:
    """Say what the operator should know of the rows."""
    remarks = []
    declared = (head.count or 0) + table.announced
    if head.count is not None and declared != len(table):
        remarks.append(f"{path.name}: announces {declared} points but holds {len(table)}; all were read")
    if table.cut:
        remarks.append(f"{path.name}: ends within its last line, which was left out")
    if layout.decimal_comma:
        remarks.append(f"{path.name}: commas were read as decimal points")
    return remarks
