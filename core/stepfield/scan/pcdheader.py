"""The header of a PCD file: the fields of a point, how many points, and how they are written."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from stepfield.errors import ScanError
from stepfield.scan.columns import plain
from stepfield.scan.rows import is_comment

_LONGEST = 1 << 20
#: A point of more bytes than this is a damaged header, not a point.
_LARGEST = 1 << 20
_POINT_KEYS = {"fields", "columns", "size", "type", "count"}
_KEYS = _POINT_KEYS | {"version", "width", "height", "viewpoint", "points", "data"}
_KINDS = {"i": ("1", "2", "4", "8"), "u": ("1", "2", "4", "8"), "f": ("4", "8")}
_DATA = ("ascii", "binary", "binary_compressed")


@dataclass(frozen=True, slots=True)
class Field:
    """A field of every point: ``count`` values of a numpy kind, little endian."""

    name: str
    kind: str
    count: int

    @property
    def size(self) -> int:
        """Bytes in a point."""
        return int(self.kind[-1]) * self.count


@dataclass(frozen=True, slots=True)
class Header:
    """What the lines before the data declare; the data start at byte ``offset``."""

    fields: list[Field]
    points: int
    height: int
    data: str
    offset: int


def read_header(path: Path) -> Header | None:
    """Read the header, or return None where the file starts with something else.

    Raises
    ------
    ScanError
        It is a PCD header, but says what cannot be.
    """
    with path.open("rb") as file:
        try:
            entries = _entries(file)
            return _checked(entries, file.tell()) if entries else None
        except ValueError as error:
            raise ScanError(f"{path.name}: damaged PCD header ({error}); export the file again") from error


def _entries(file: BinaryIO) -> dict[str, list[str]]:
    """Return the words of each header line by its key; none at all if the first line has no key."""
    entries: dict[str, list[str]] = {}
    while line := file.readline(_LONGEST):
        if is_comment(line):
            continue
        key, *words = line.decode("ascii", "replace").split() or [""]
        if key.lower() not in _KEYS:
            if not entries:
                return {}
            raise ValueError(f"{key[:40]!r} is no entry of it")
        entries[key.lower()] = words
        if key.lower() == "data":
            return entries
        if file.tell() > _LONGEST:
            raise ValueError("it has no end")
    if entries:
        raise ValueError("it ends without DATA")
    return {}


def _checked(entries: dict[str, list[str]], offset: int) -> Header:
    data = " ".join(entries["data"]).lower()
    if data not in _DATA:
        raise ValueError(f"DATA {data[:40]!r} is none of {', '.join(_DATA)}")
    width, height = _number(entries, "width", 0), _number(entries, "height", 1)
    points = _number(entries, "points", width * height)
    return Header(_fields(entries), points, height if height * width == points else 1, data, offset)


def _fields(entries: dict[str, list[str]]) -> list[Field]:
    names = entries.get("fields") or entries.get("columns") or []
    sizes, types = entries.get("size", ["4"] * len(names)), entries.get("type", ["F"] * len(names))
    counts = entries.get("count", ["1"] * len(names))
    if not names or not len(names) == len(sizes) == len(types) == len(counts):
        raise ValueError("FIELDS, SIZE, TYPE and COUNT differ in length")
    fields = [
        _field(name, size, kind.lower(), count)
        for name, size, kind, count in zip(names, sizes, types, counts, strict=True)
    ]
    if not 0 < sum(field.size for field in fields) <= _LARGEST:
        raise ValueError("a point would have an impossible size")
    return fields


def _field(name: str, size: str, kind: str, count: str) -> Field:
    if size not in _KINDS.get(kind, ()):
        raise ValueError(f"{name[:40]!r} has an unknown TYPE {kind[:9]} or SIZE {size[:9]}")
    if not (count.isdecimal() and len(count) < 8):
        raise ValueError(f"{name[:40]!r} has an impossible COUNT")
    return Field(plain(name), f"<{kind}{size}", int(count))


def _number(entries: dict[str, list[str]], key: str, default: int) -> int:
    words = entries.get(key)
    if not words:
        return default
    if not (words[0].isdecimal() and len(words[0]) < 19):
        raise ValueError(f"{key.upper()} {words[0][:40]!r} is no number of points")
    return int(words[0])
