"""The header of a PLY file: which elements follow, in which order, and how their properties are stored."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from stepfield.errors import ScanError
from stepfield.scan.columns import plain

_LONGEST = 1 << 20
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_KINDS = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8", "int64": "i8", "uint64": "u8"},
}


@dataclass(frozen=True, slots=True)
class Property:
    """A property of an element; ``length`` is the kind of a list's leading count."""

    name: str
    kind: str
    length: str = ""


@dataclass(frozen=True, slots=True)
class Element:
    """An element: so many records of some properties."""

    name: str
    count: int
    properties: list[Property]

    @property
    def has_lists(self) -> bool:
        """Whether its records differ in size."""
        return any(p.length for p in self.properties)


@dataclass(frozen=True, slots=True)
class Header:
    """``order`` is numpy's byte order mark, empty for ascii; the elements start at byte ``offset``."""

    order: str
    elements: list[Element]
    offset: int


def read_header(path: Path) -> Header:
    """Read the header.

    Raises
    ------
    ScanError
        It is not a PLY header, or says what cannot be.
    """
    with path.open("rb") as file:
        if file.readline(64).strip().lower() != b"ply":
            raise ScanError(
                f"{path.name}: is no PLY file (its first line is not 'ply'); check the file's kind"
            )
        try:
            return _parsed(file)
        except ValueError as error:
            raise ScanError(f"{path.name}: damaged PLY header ({error}); export the file again") from error


def _parsed(file: BinaryIO) -> Header:
    order: str | None = None
    elements: list[Element] = []
    number = 1
    while True:
        line = file.readline(_LONGEST)
        number += 1
        match line.decode("ascii", "replace").split():
            case [] if not line:
                raise ValueError("it ends without end_header")
            case ["end_header", *_]:
                break
            case ["format", form, *_] if form in _ORDERS:
                order = _ORDERS[form]
            case ["element", name, count] if count.isdecimal() and len(count) < 19:
                elements.append(Element(name.lower(), int(count), []))
            case ["property", *words] if elements:
                elements[-1].properties.append(_property(words, number))
            case ["comment" | "obj_info", *_] | []:
                pass
            case words:
                raise ValueError(f"line {number} cannot be understood: {' '.join(words)[:40]!r}")
        if file.tell() > _LONGEST:
            raise ValueError("it has no end")
    if order is None:
        raise ValueError("it does not say whether the data are ascii or binary")
    return Header(order, elements, file.tell())


def _property(words: list[str], number: int) -> Property:
    match words:
        case ["list", length, kind, name] if _KINDS.get(length, "f")[0] in "iu" and kind in _KINDS:
            return Property(plain(name), _KINDS[kind], _KINDS[length])
        case [kind, name] if kind in _KINDS:
            return Property(plain(name), _KINDS[kind])
    raise ValueError(f"line {number} declares no property known: {' '.join(words)[:40]!r}")
