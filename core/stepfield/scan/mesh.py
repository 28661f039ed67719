"""Meshes (OBJ, STL, OFF) as clouds: their vertices are the points, their faces are left alone."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from stepfield.errors import ScanError
from stepfield.progress import Progress
from stepfield.scan.cloud import Cloud, Numbers
from stepfield.scan.columns import cloud_of, in_one_sentence, shortened
from stepfield.scan.numbers import BLOCK, Growing, first_rows, read_rows, read_table
from stepfield.scan.records import packed, read_columns
from stepfield.scan.rows import Layout, Table, fields, is_comment, is_number, layout_of

_OBJ_VERTEX = re.compile(rb"^[ \t]*v[ \t]+([^\r\n]*)", re.MULTILINE)
_STL_VERTEX = re.compile(rb"^[ \t]*vertex[ \t]+([^\r\n]*)", re.MULTILINE | re.IGNORECASE)
_STL_HEADER = 84
_STL_FACET = packed([("<f4", 3), *[("<f4", 1)] * 9, ("<u2", 1)])


@in_one_sentence
def read(path: Path, progress: Progress) -> Cloud:
    """Read the vertices of a mesh, by the kind its name ends in.

    Raises
    ------
    ScanError
        The file is not of that kind, or has no vertices.
    """
    return {".obj": _obj, ".stl": _stl, ".off": _off}[path.suffix.lower()](path)


def _obj(path: Path) -> Cloud:
    """Read the ``v`` lines; six or more numbers are a position and a colour."""
    table, width = _marked_rows(path, _OBJ_VERTEX)
    names = ["x", "y", "z", "red", "green", "blue"][: 3 if width < 6 else 6]
    columns = dict(zip(names, table.columns, strict=True))
    if any(np.isnan(columns[name]).any() for name in names[3:]):
        columns = {axis: columns[axis] for axis in "xyz"}  # only some vertices are coloured
    return cloud_of(path, columns, "vertices", warnings=_cut(path, table))


def _cut(path: Path, table: Table) -> tuple[str, ...]:
    return (f"{path.name}: ends within its last vertex, which was left out",) if table.cut else ()


def _marked_rows(path: Path, mark: re.Pattern[bytes]) -> tuple[Table, int]:
    """Read the rows of numbers on the lines that a pattern picks, and how wide the first is."""
    layout = Layout(3, (0, 1, 2))
    growing: Growing | None = None
    for block, last in _blocks(path):
        rows = mark.findall(block)
        if not rows:
            continue
        if growing is None:
            layout = layout_of(rows[:1], tuple(range(6 if len(fields(rows[0])) >= 6 else 3)))
            growing = Growing(layout)
        part = read_rows(path, b"\n".join(rows), layout, growing.rows, last)
        growing.add(part, path.stat().st_size / len(block))
    return (growing or Growing(layout)).table(), layout.columns


def _blocks(path: Path) -> Iterator[tuple[bytes, bool]]:
    """Return blocks of whole lines, and whether each is the last; a line may be cut if it is endless."""
    rest = b""
    with path.open("rb") as file:
        while more := file.read(BLOCK):
            data = rest + more
            stop = data.rfind(b"\n") + 1 or len(data)
            rest = data[stop:]
            yield data[:stop], False
    yield rest, True


def _stl(path: Path) -> Cloud:
    """Read the corners of the facets, each place once."""
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(512)
    facets = int.from_bytes(head[80:_STL_HEADER], "little")
    whole = size == _STL_HEADER + facets * _STL_FACET.itemsize  # binary files may start with "solid", too
    if head.lstrip().lower().startswith(b"solid") and not whole and b"\0" not in head:
        table, _ = _marked_rows(path, _STL_VERTEX)
        return _welded(path, table.columns, _cut(path, table))
    if len(head) < _STL_HEADER:
        raise ScanError(f"{path.name}: is no STL file (too short); check the file's kind")
    found = min(facets, (size - _STL_HEADER) // _STL_FACET.itemsize)
    if not found and facets:
        raise ScanError(f"{path.name}: holds no points (none of its {facets} facets); export it again")
    corners = read_columns(path, _STL_HEADER, _STL_FACET, found, {f"f{i}": f"f{i}" for i in range(1, 10)})
    axes = [np.concatenate([corners[f"f{i}"] for i in (axis, axis + 3, axis + 6)]) for axis in (1, 2, 3)]
    return _welded(path, axes, () if found == facets else (shortened(path, found, facets, "facets"),))


def _welded(path: Path, axes: list[Numbers], warnings: tuple[str, ...]) -> Cloud:
    """Make the cloud of corners, equal ones once: every facet repeats those of its neighbours."""
    order = np.lexsort(axes)
    new = np.zeros(len(order), bool)
    new[:1] = True
    for axis in axes:
        new[1:] |= axis[order[1:]] != axis[order[:-1]]
    keep = np.sort(order[new])
    columns = {name: axis[keep] for name, axis in zip("xyz", axes, strict=True)}
    return cloud_of(path, columns, "facets", warnings=warnings)


def _off(path: Path) -> Cloud:
    """Read the vertices of an OFF file; normals and texture coordinates are passed over."""
    start, kind, count = _off_head(path)
    colour = 6 if "N" in kind else 3
    rows = first_rows(path, start)[:1]
    coloured = "C" in kind and rows and len(fields(rows[0])) >= colour + 3
    names = ["x", "y", "z", *(["red", "green", "blue"] if coloured else [])]
    wanted = (0, 1, 2, colour, colour + 1, colour + 2)[: len(names)]
    table = read_table(path, start, layout_of(rows, wanted), count)
    warnings = () if len(table) == count else (shortened(path, len(table), count, "vertices"),)
    return cloud_of(path, dict(zip(names, table.columns, strict=True)), "vertices", warnings=warnings)


def _off_head(path: Path) -> tuple[int, str, int]:
    """Return where the vertices start, the letters before OFF, and how many vertices there are."""
    kind: str | None = None
    with path.open("rb") as file:
        while (line := file.readline(1 << 16)) and file.tell() < 1 << 20:
            words = [] if is_comment(line) else fields(line.split(b"#")[0])
            if kind is None and words:
                kind, words = _off_kind(path, words)
            if words and words[0].isdigit():
                return file.tell(), kind or "", int(words[0][:18])
            if words:
                break
    raise ScanError(f"{path.name}: is no OFF file with counts of its vertices; check the file's kind")


def _off_kind(path: Path, words: list[bytes]) -> tuple[str, list[bytes]]:
    """Split the keyword from the counts, which may follow it on its line."""
    if is_number(words[0]):
        return "", words
    found = re.fullmatch(r"((?:ST)?C?N?)OFF", words[0].decode("ascii", "replace"))
    if not found or b"BINARY" in words:
        raise ScanError(
            f"{path.name}: starts with {words[0][:20].decode('ascii', 'replace')!r}, no ascii OFF in three "
            "dimensions; export it as plain OFF"
        )
    return found[1], words[1:]
