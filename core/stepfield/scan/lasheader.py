"""The fixed-layout part of a LAS or LAZ file: header, and where its variable length records lie.

Read here rather than by a library because every number in it can lie: a claimed billion of records or
points must cost nothing, and points behind an odd header are still worth having.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import BinaryIO

from stepfield.errors import ScanError
from stepfield.scan.cloud import GREATEST

#: Shortest header, that of LAS 1.0 to 1.2, and the length from which 64-bit counts are present (LAS 1.4).
HEADER_LENGTH, WIDE_HEADER_LENGTH = 227, 375
#: Bytes of one record of point formats 0 to 10, without extra bytes.
RECORD_LENGTHS = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)
LASZIP = ("laszip encoded", 22204)
WKT = ("LASF_Projection", 2112)
GEO_KEYS = ("LASF_Projection", 34735)
_WANTED = {LASZIP, WKT, GEO_KEYS}
#: Far more than any writer makes; keeps a lying count from being walked for long.
_MOST_RECORDS, _LONGEST_RECORD = 1 << 16, 1 << 20


@dataclass(frozen=True, slots=True)
class Header:
    """What is needed to find and scale the points.

    Attributes
    ----------
    size : int
        Bytes in the file.
    start : int
        Byte at which the points begin.
    count : int
        Points the header promises.
    point_format, record_length : int
        Layout of one (uncompressed) point record.
    compressed : bool
        True for LAZ.
    scales, offsets : tuple of three float
        Coordinate = integer * scale + offset.
    records : mapping of (user id, record id) to bytes
        The variable length records of interest: LASzip, WKT, GeoTIFF keys.
    """

    size: int
    start: int
    count: int
    point_format: int
    record_length: int
    compressed: bool
    scales: tuple[float, float, float]
    offsets: tuple[float, float, float]
    records: Mapping[tuple[str, int], bytes]

    @property
    def room(self) -> int:
        """Whole uncompressed records between the start of the points and the end of the file."""
        return (self.size - self.start) // self.record_length


def read_header(file: BinaryIO, name: str) -> Header:
    """Read and check the header.

    Raises
    ------
    ScanError
        The file is no LAS file, or its points cannot be located.
    """
    size = file.seek(0, 2)
    file.seek(0)
    raw = file.read(WIDE_HEADER_LENGTH)
    if raw[:4] != b"LASF":
        raise ScanError(
            f"{name}: is not a LAS or LAZ file, as it does not begin with LASF; check the file type"
        )
    if len(raw) < HEADER_LENGTH:
        raise ScanError(f"{name}: ends at byte {size}, inside the LAS header; copy or export the file again")
    length, start, record_count, kind, record_length, count = struct.unpack_from("<HIIBHI", raw, 94)
    wide = raw[25] >= 4 and min(length, len(raw)) >= WIDE_HEADER_LENGTH
    if wide:
        count = struct.unpack_from("<Q", raw, 247)[0] or count
    numbers = struct.unpack_from("<6d", raw, 131)
    _check_scaling(numbers, name)
    point_format = kind & 0x3F
    _check_layout(name, size, start, point_format, record_length)
    records = dict(_records(file, length, min(start, size), record_count, extended=False))
    if wide:
        first, extended_count = struct.unpack_from("<QI", raw, 235)
        records = dict(_records(file, first, size, extended_count, extended=True)) | records
    return Header(
        size, start, count, point_format, record_length, bool(kind & 0x80), numbers[:3], numbers[3:], records
    )


def _check_scaling(numbers: tuple[float, ...], name: str) -> None:
    """Refuse scales and offsets with which a coordinate could not be a finite number."""
    for axis, scale, offset in zip("xyz", numbers[:3], numbers[3:], strict=True):
        if scale == 0 or not abs(scale) * 2.0**31 + abs(offset) <= GREATEST:
            raise ScanError(
                f"{name}: the LAS header scales {axis} by {scale:g} and shifts it by {offset:g}, which makes "
                "no coordinate; export the file again"
            )


def _check_layout(name: str, size: int, start: int, point_format: int, record_length: int) -> None:
    if point_format >= len(RECORD_LENGTHS):
        raise ScanError(
            f"{name}: point format {point_format} at byte 104 is not one of the LAS formats 0 to 10; "
            "export the file again"
        )
    if record_length < RECORD_LENGTHS[point_format]:
        raise ScanError(
            f"{name}: point records of {record_length} bytes (byte 105) are too short for point format "
            f"{point_format}, which needs {RECORD_LENGTHS[point_format]}; export the file again"
        )
    if start < HEADER_LENGTH:
        raise ScanError(
            f"{name}: the points are said to begin at byte {start}, inside the header; export the file again"
        )
    if start > size:
        raise ScanError(
            f"{name}: holds no points; they should begin at byte {start} but the file ends at byte {size}, "
            "so copy or export it again"
        )


def _records(
    file: BinaryIO, start: int, end: int, count: int, *, extended: bool
) -> Iterator[tuple[tuple[str, int], bytes]]:
    """Walk the variable length records that lie whole between ``start`` and ``end``."""
    head = 60 if extended else 54
    for _ in range(min(count, _MOST_RECORDS)):
        if start + head > end:
            return
        file.seek(start)
        _, user, number, *length = struct.unpack("<H16sH" + ("Q" if extended else "H"), file.read(head - 32))
        body = start + head
        start = body + length[0]
        if start > end:
            return
        key = (user.split(b"\0")[0].decode("latin-1"), number)
        if key in _WANTED and length[0] <= _LONGEST_RECORD:
            file.seek(body)
            yield key, file.read(length[0])
