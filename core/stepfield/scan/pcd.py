"""PCD, the Point Cloud Library's format: ascii, binary and compressed.

The header's VIEWPOINT is read over on purpose: by the library's convention the points are already in the
frame of the sensor, and the viewpoint only tells where that sensor stood.
"""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np

from stepfield.errors import ScanError
from stepfield.progress import Progress
from stepfield.scan import text
from stepfield.scan.cloud import Cloud, Numbers
from stepfield.scan.columns import USEFUL, cloud_of, in_one_sentence, require_xyz, shortened
from stepfield.scan.numbers import first_rows, read_table
from stepfield.scan.pcdheader import Field, Header, read_header
from stepfield.scan.records import packed, read_columns
from stepfield.scan.rows import layout_of

#: LZF repeats at most 264 bytes for 3: a file that claims to unpack to more is lying.
_DENSEST = 264 / 3
_PACKED = ("rgb", "rgba")


@in_one_sentence
def read(path: Path, progress: Progress) -> Cloud:
    """Read a PCD file; one without a header is read as text.

    Raises
    ------
    ScanError
        The header is damaged, the points lack a coordinate, or there are none.
    """
    header = read_header(path)
    if header is None:
        return text.read(path, progress)
    places = _places(path, header.fields)
    if header.data == "ascii":
        columns, found = _ascii(path, header, places, progress)
    else:
        columns, found = {"binary": _binary, "binary_compressed": _compressed}[header.data](
            path, header, places
        )
    warnings = () if found == header.points else (shortened(path, found, header.points),)
    _unpack_colours(columns)
    return cloud_of(path, columns, "fields", organised=header.height > 1, warnings=warnings)


def _places(path: Path, fields: list[Field]) -> dict[str, int]:
    """Return which field holds each useful column, x, y and z first."""
    names = [field.name for field in fields]
    require_xyz(path, names, "FIELDS")
    useful = [name for name in names if name in USEFUL or name in _PACKED]
    chosen = [*"xyz", *(name for name in dict.fromkeys(useful) if name not in "xyz")]
    return {name: names.index(name) for name in chosen if fields[names.index(name)].count}


def _ascii(
    path: Path, header: Header, places: dict[str, int], progress: Progress
) -> tuple[dict[str, Numbers], int]:
    """Read rows of text, in float64 whatever the header says: the digits are there to be kept."""
    first = np.cumsum([0, *(field.count for field in header.fields)])
    wanted = tuple(int(first[place]) for place in places.values())
    layout = layout_of(first_rows(path, header.offset)[:1], wanted)
    layout = replace(layout, exact=len(wanted))  # float32 would blur a packed colour
    table = read_table(path, header.offset, layout, header.points, progress)
    return dict(zip(places, table.columns, strict=True)), len(table)


def _binary(path: Path, header: Header, places: dict[str, int]) -> tuple[dict[str, Numbers], int]:
    """Read the whole records that are there."""
    record = packed([(field.kind, field.count) for field in header.fields])
    found = min(header.points, max(0, path.stat().st_size - header.offset) // record.itemsize)
    wanted = {name: f"f{place}" for name, place in places.items()}
    return read_columns(path, header.offset, record, found, wanted), found


def _compressed(path: Path, header: Header, places: dict[str, int]) -> tuple[dict[str, Numbers], int]:
    """Unpack the fields, which stand one after another: all x, then all y."""
    raw = _unpacked(path, header)
    starts = np.cumsum([0, *(field.size * header.points for field in header.fields)])
    columns = {}
    for name, place in places.items():
        field = header.fields[place]
        values = np.frombuffer(raw, field.kind, header.points * field.count, int(starts[place]))
        columns[name] = values[:: field.count]
    return columns, header.points


def _unpacked(path: Path, header: Header) -> bytes:
    """Return the unpacked data, after the sizes they declare have been found possible."""
    with path.open("rb") as file:
        file.seek(header.offset)
        sizes = file.read(8)
        if len(sizes) < 8:
            raise ScanError(f"{path.name}: ends at its header; copy or export the file again")
        small, large = struct.unpack("<II", sizes)
        there = path.stat().st_size - file.tell()
        if there < small:
            raise ScanError(
                f"{path.name}: ends early ({there} of its {small} compressed bytes are there) and cannot be "
                "read in part; copy or export the file again"
            )
        if large > small * _DENSEST or large < header.points * sum(field.size for field in header.fields):
            raise ScanError(
                f"{path.name}: declares {header.points} points but {small} bytes that unpack to {large}; "
                "export the file again"
            )
        return _lzf(path, file.read(small), large)


def _lzf(path: Path, data: bytes, size: int) -> bytes:
    from imagecodecs import LzfError, lzf_decode

    try:
        raw = lzf_decode(data, out=size) if size else b""
    except (LzfError, ValueError) as error:
        raise ScanError(f"{path.name}: its compressed data are damaged; copy the file again") from error
    if len(raw) < size:
        raise ScanError(f"{path.name}: its compressed data end early; copy or export the file again")
    return bytes(raw)


def _unpack_colours(columns: dict[str, Numbers]) -> None:
    """Replace a packed colour, 0x00RRGGBB as an integer or as the bits of a float, by its channels."""
    for name in _PACKED:
        if name in columns:
            bits = _bits(columns.pop(name))
            if bits is not None:
                columns |= {"red": bits >> 16 & 255, "green": bits >> 8 & 255, "blue": bits & 255}


def _bits(column: Numbers) -> Numbers | None:
    """Return a packed colour's 32 bits, or None for a field too small to be one."""
    if column.dtype.itemsize == 4:
        return np.ascontiguousarray(column).view(np.uint32)
    if column.dtype.itemsize < 4:
        return None
    if column.dtype.kind in "iu":
        return (column & 0xFFFFFFFF).astype(np.uint32)
    # Ascii: written as the float that has these bits, or plainly as a whole number.
    whole = (column >= 1) & (column < 2**32)
    with np.errstate(invalid="ignore", over="ignore"):
        as_float = column.astype(np.float32).view(np.uint32)
    return np.where(whole, np.where(whole, column, 0).astype(np.uint32), as_float)
