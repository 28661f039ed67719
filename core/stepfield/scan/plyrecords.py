"""The records of a binary PLY element: of one size and quick, or with lists that make each size differ."""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from stepfield.errors import ScanError
from stepfield.scan.cloud import Numbers
from stepfield.scan.plyheader import Element
from stepfield.scan.records import Record, packed, read_columns

_CODES = {
    **{"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I"},
    **{"i8": "q", "u8": "Q", "f4": "f", "f8": "d"},
}


def read_element(
    path: Path, start: int, order: str, element: Element, places: dict[str, int]
) -> tuple[dict[str, Numbers], int]:
    """Return the wanted properties as columns, and how many whole records the file holds.

    Parameters
    ----------
    path : Path
    start : int
        Byte of the first record.
    order : str
        Numpy's byte order mark.
    element : Element
    places : mapping of str to int
        Column name to place of the property.
    """
    formats = _formats(path, start, order, element)
    if formats is None:
        return _one_by_one(path, start, order, element, places)
    record = packed(formats)
    count = min(element.count, _room(path, start) // record.itemsize)
    wanted = {name: f"f{_field(element, place)}" for name, place in places.items()}
    return read_columns(path, start, record, count, wanted), count


def _one_by_one(
    path: Path, start: int, order: str, element: Element, places: dict[str, int]
) -> tuple[dict[str, Numbers], int]:
    """Return the wanted scalars of records that differ in size."""
    kinds = [element.properties[place].kind for place in places.values()]
    rows = [[row[place] for place in places.values()] for row, _ in _walk(path, start, order, element)]
    columns = zip(*rows, strict=True) if rows else [() for _ in kinds]
    arrays = [np.array(column, kind) for column, kind in zip(columns, kinds, strict=True)]
    return dict(zip(places, arrays, strict=True)), len(rows)


def skip_element(path: Path, start: int, order: str, element: Element) -> int:
    """Return the byte after an element, or the end of the file if that comes first."""
    formats = _formats(path, start, order, element)
    if formats is not None:
        return start + min(_room(path, start), element.count * _size(formats))
    stop, found = start, 0
    for _, stop in _walk(path, start, order, element):  # noqa: B007
        found += 1
    return stop if found == element.count else path.stat().st_size


def _room(path: Path, start: int) -> int:
    return max(0, path.stat().st_size - start)


def _field(element: Element, place: int) -> int:
    """Return the field of a property in the record, where a list is two: its length and its items."""
    return place + sum(1 for p in element.properties[:place] if p.length)


def _size(formats: list[tuple[str, int]]) -> int:
    return sum(int(kind[-1]) * count for kind, count in formats)


def _formats(path: Path, start: int, order: str, element: Element) -> list[tuple[str, int]] | None:
    """Return the fields that all records share, or None where their lists differ in length."""
    first = next((row for row, _ in _walk(path, start, order, element)), None) if element.has_lists else ()
    if first is None:
        return None
    formats: list[tuple[str, int]] = []
    for place, p in enumerate(element.properties):
        if p.length:
            formats.append((order + p.length, 1))
        formats.append((order + p.kind, int(first[place]) if p.length else 1))
    return formats if not element.has_lists or _alike(path, start, element, formats) else None


def _alike(path: Path, start: int, element: Element, formats: list[tuple[str, int]]) -> bool:
    """Tell whether every list of the element is as long as in its first record."""
    if _room(path, start) < _size(formats) * element.count:
        return False
    record: Record = packed(formats)
    places = [_field(element, place) for place, p in enumerate(element.properties) if p.length]
    wanted = {str(field): f"f{field}" for field in places}
    lengths = read_columns(path, start, record, element.count, wanted)
    return all(bool(np.all(lengths[str(field)] == formats[field + 1][1])) for field in places)


def _walk(path: Path, start: int, order: str, element: Element) -> Iterator[tuple[tuple[float, ...], int]]:
    """Step through whole records: the scalars with the lengths of the lists, and the byte after them."""
    runs = _runs(order, element)
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        for _ in range(element.count):
            row: tuple[float, ...] = ()
            for run, item in runs:
                if start + run.size > len(data):
                    return
                values = run.unpack_from(data, start)
                start += run.size + (int(values[-1]) * item if item else 0)
                row += values
                if item and values[-1] < 0:
                    raise ScanError(
                        f"{path.name}: a list at byte {start} has a negative length; export it again"
                    )
            if start > len(data):
                return
            yield row, start


def _runs(order: str, element: Element) -> list[tuple[struct.Struct, int]]:
    """Split a record after each list's length; with each part goes the size of the items that follow."""
    runs: list[tuple[struct.Struct, int]] = []
    codes = ""
    for p in element.properties:
        codes += _CODES[p.length or p.kind]
        if p.length:
            runs.append((struct.Struct(order + codes), int(p.kind[-1])))
            codes = ""
    return [*runs, (struct.Struct(order + codes), 0)]
