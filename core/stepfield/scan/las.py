"""LAS and LAZ, versions 1.0 to 1.4, and COPC: the integers of the file, never rounded.

The records are taken straight from the file, and only the columns this program has a use for are kept:
a general library reads whole records into memory, trusts the header's counts, and loops on some.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from stepfield.errors import ScanError
from stepfield.progress import Progress
from stepfield.scan import crs, lasheader, laz
from stepfield.scan.cloud import Axis, Cloud, Numbers
from stepfield.scan.columns import in_one_sentence, shortened
from stepfield.scan.lasheader import Header

#: Records read at a time: few enough to stay in the processor's cache while columns are picked out.
_BLOCK = 1 << 15
_RGB_AT = {2: 20, 3: 28, 5: 28, 7: 30, 8: 30, 10: 30}
_LEGACY_CLASSES = 0b11111  # formats 0 to 5 keep flags in the upper three bits


@in_one_sentence
def read(path: Path, progress: Progress) -> Cloud:
    """Read the points of a LAS or LAZ file.

    Parameters
    ----------
    path : Path
    progress : Progress

    Returns
    -------
    Cloud
        Axes of int32, scaled as the header says; ``rgb``, ``intensity`` and ``classification`` where
        the file has any that are not zero.

    Raises
    ------
    ScanError
        The file cannot be read or holds no points.
    """
    with path.open("rb") as file:
        return _read(file, path, progress)


def _read(file: BinaryIO, path: Path, progress: Progress) -> Cloud:
    name = path.name
    header = lasheader.read_header(file, name)
    columns = _Columns(header)
    for block in laz.blocks(file, header, name) if header.compressed else _blocks(file, header):
        columns.append(block)
        progress(min(1.0, columns.filled / max(1, header.count)), f"reading {name}")
    if not columns.filled:
        raise ScanError(f"{name}: holds no points{_promise(header)}; choose another file or export it again")
    reference = _reference(header)
    warnings = [f"{name}: {warning}" for warning in reference.warnings]
    if columns.filled < header.count:
        warnings.append(shortened(path, columns.filled, header.count))
    axes, attributes = columns.cloud_parts()
    return Cloud(axes, attributes, reference.unit, reference.wkt, warnings=tuple(warnings))


def _promise(header: Header) -> str:
    return f" though its header promises {header.count}" if header.count else ""


def _blocks(file: BinaryIO, header: Header) -> Iterator[NDArray[np.uint8]]:
    """Read the records of an uncompressed file, as many whole ones as there are."""
    file.seek(header.start)
    left = min(header.count, header.room)
    block = np.empty(min(_BLOCK, left) * header.record_length, np.uint8)
    while left > 0:
        block = block[: left * header.record_length]
        read = file.readinto(block.data) // header.record_length  # type: ignore[attr-defined]
        if read == 0:
            return
        yield block[: read * header.record_length]
        left -= read


def _reference(header: Header) -> crs.Reference:
    """Tell the coordinate reference system: of text and GeoTIFF keys, the text counts."""
    text = header.records.get(lasheader.WKT, b"").split(b"\0")[0].decode("utf-8", "replace").strip()
    if text:
        return crs.from_wkt(text)
    return crs.from_geo_keys(header.records.get(lasheader.GEO_KEYS, b""))


class _Columns:
    """The columns of interest, filled block by block."""

    def __init__(self, header: Header) -> None:
        self._header = header
        self._record = _record_type(header)
        # Claims are not believed: unpacked points fit the file, packed ones get room as they come.
        self._room = min(header.count, laz.BLOCK if header.compressed else header.room)
        self._columns = {
            name: np.empty(
                (self._room, *self._record[name].shape), "u1" if name == "rgb" else self._record[name]
            )
            for name in self._record.names or ()
        }
        self._deep_colour = False
        self.filled = 0

    def append(self, block: NDArray[np.uint8]) -> None:
        """Add whole records, given as bytes."""
        records = block.view(self._record)
        part = slice(self.filled, self.filled + len(records))
        if part.stop > self._room:
            self._grow(max(part.stop, min(self._header.count, self._room + self._room // 8)))
        for name, column in self._columns.items():
            column[part] = self._colours(records[name]) if name == "rgb" else records[name]
        self.filled = part.stop

    def _grow(self, room: int) -> None:
        for column in self._columns.values():
            column.resize((room, *column.shape[1:]), refcheck=False)
        self._room = room

    def _colours(self, colours: Numbers) -> Numbers:
        """Bring colours to 8 bits: by their upper byte, unless none is in use anywhere."""
        if not self._deep_colour and colours.max() > 255:
            self._deep_colour = True
            self._columns["rgb"][: self.filled] = 0  # the upper byte of all so far
        return colours >> 8 if self._deep_colour else colours

    def cloud_parts(self) -> tuple[tuple[Axis, Axis, Axis], dict[str, Numbers]]:
        """Hand over the axes, and the attributes that are not zero throughout."""
        self._grow(self.filled)
        x, y, z = (
            Axis(self._columns.pop(name), scale, offset)
            for name, scale, offset in zip("xyz", self._header.scales, self._header.offsets, strict=True)
        )
        if self._header.point_format < 6:
            self._columns["classification"] &= _LEGACY_CLASSES
        return (x, y, z), {name: column for name, column in self._columns.items() if column.any()}


def _record_type(header: Header) -> np.dtype[Any]:
    """Describe the columns of interest within one point record."""
    fields = {
        "x": ("<i4", 0),
        "y": ("<i4", 4),
        "z": ("<i4", 8),
        "intensity": ("<u2", 12),
        "classification": ("u1", 15 if header.point_format < 6 else 16),
    }
    if header.point_format in _RGB_AT:
        fields["rgb"] = ("(3,)<u2", _RGB_AT[header.point_format])
    formats, offsets = zip(*fields.values(), strict=True)
    return np.dtype(
        {"names": list(fields), "formats": formats, "offsets": offsets, "itemsize": header.record_length}
    )
