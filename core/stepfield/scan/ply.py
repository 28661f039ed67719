"""PLY: the vertices of an ascii or binary file, whatever else stands before, between or after them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stepfield.errors import ScanError
from stepfield.progress import Progress
from stepfield.scan.cloud import Cloud, Numbers
from stepfield.scan.columns import USEFUL, cloud_of, in_one_sentence, require_xyz, shortened
from stepfield.scan.numbers import first_rows, read_table
from stepfield.scan.plyheader import Element, Header, read_header
from stepfield.scan.plyrecords import read_element, skip_element
from stepfield.scan.rows import layout_of


@in_one_sentence
def read(path: Path, progress: Progress) -> Cloud:
    """Read the vertices of a PLY file.

    Raises
    ------
    ScanError
        The file is no PLY, or has no vertices with x, y and z.
    """
    header = read_header(path)
    vertex = _vertex(path, header)
    if header.order:
        columns, found = _binary(path, header, vertex)
    else:
        columns, found = _ascii(path, header, vertex, progress)
    warnings = () if found == vertex.count else (shortened(path, found, vertex.count, "vertices"),)
    return cloud_of(path, columns, "vertices", warnings=warnings)


def _vertex(path: Path, header: Header) -> Element:
    """Return the element of the points, refusing one without coordinates before its data are read."""
    vertex = next((e for e in header.elements if e.name in ("vertex", "vertices", "point", "points")), None)
    if vertex is None:
        raise ScanError(f"{path.name}: holds no points (no vertex element); export it with its vertices")
    require_xyz(path, {p.name for p in vertex.properties if not p.length}, "vertices")
    return vertex


def _places(vertex: Element) -> dict[str, int]:
    """Return which property holds each useful column, x, y and z first."""
    places: dict[str, int] = {"x": 0, "y": 0, "z": 0}
    for place, p in reversed(list(enumerate(vertex.properties))):
        if p.name in USEFUL and not p.length:
            places[p.name] = place
    return places


# ------------------------------------------------------------------------------------------------ ascii


def _ascii(path: Path, header: Header, vertex: Element, progress: Progress) -> tuple[dict[str, Numbers], int]:
    """Read the rows of the vertices; every record of every element is one line."""
    start = header.offset
    for element in header.elements[: header.elements.index(vertex)]:
        start = _skip_lines(path, start, element.count)
    places = _places(vertex)
    if any(p.length for p in vertex.properties[: max(places.values())]):
        return _ascii_with_lists(path, start, vertex, places)
    layout = layout_of(first_rows(path, start)[:1], tuple(places.values()))
    table = read_table(path, start, layout, vertex.count, progress)
    columns = dict(zip(places, table.columns, strict=True))
    return {name: _as_declared(vertex, places[name], columns[name]) for name in columns}, len(table)


def _as_declared(vertex: Element, place: int, column: Numbers) -> Numbers:
    """Return an attribute as the integers it is declared to be: as colours, 1 and 1.0 differ."""
    p = vertex.properties[place]
    if p.name in ("x", "y", "z") or p.kind[0] == "f" or not np.isfinite(column).all():
        return column
    return column.astype(np.int64)


def _skip_lines(path: Path, start: int, count: int) -> int:
    """Return the byte after so many lines, or the end of the file."""
    with path.open("rb") as file:
        file.seek(start)
        for _ in range(min(count, path.stat().st_size)):
            if not file.readline():
                break
        return file.tell()


def _ascii_with_lists(
    path: Path, start: int, vertex: Element, places: dict[str, int]
) -> tuple[dict[str, Numbers], int]:
    """Read rows where lists stand before a wanted column, so that its place differs from row to row."""
    rows: list[list[float]] = []
    with path.open("rb") as file:
        file.seek(start)
        while len(rows) < vertex.count and (line := file.readline()):
            if line.strip():
                rows.append(_row(path, line.split(), vertex, places, len(rows)))
    table = np.array(rows, np.float64).reshape(-1, len(places))
    return {name: _as_declared(vertex, places[name], table[:, i]) for i, name in enumerate(places)}, len(rows)


def _row(path: Path, words: list[bytes], vertex: Element, places: dict[str, int], row: int) -> list[float]:
    """Return the wanted values of one row that has lists."""
    values: list[float] = []
    at = 0
    try:
        for p in vertex.properties:
            values.append(float(words[at]))
            at += 1 + (int(words[at]) if p.length else 0)
        return [values[place] for place in places.values()]
    except (ValueError, IndexError, OverflowError) as error:
        raise ScanError(
            f"{path.name}: vertex {row + 1} does not hold what the header declares; export the file again"
        ) from error


# ----------------------------------------------------------------------------------------------- binary


def _binary(path: Path, header: Header, vertex: Element) -> tuple[dict[str, Numbers], int]:
    """Read the whole records of the vertices that are there."""
    start = header.offset
    for element in header.elements[: header.elements.index(vertex)]:
        start = skip_element(path, start, header.order, element)
    return read_element(path, start, header.order, vertex, _places(vertex))
