"""The points of a LAZ file, decoded chunk by chunk in parallel and in bounded memory.

LASzip data is checked before the decoder sees it: chunk sizes, layer sizes and item sizes that do not fit
the file make the decoder panic, or abort the process by asking for memory that is not there.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from stepfield.errors import ScanError
from stepfield.scan.lasheader import LASZIP, Header

Bytes = NDArray[np.uint8]

#: Points decoded at a time: enough chunks of the usual 50 000 to keep every core busy.
BLOCK = 1_000_000
#: A chunk that would unpack to more is refused: no writer makes one, and memory must stay bounded.
LARGEST_CHUNK = 1 << 31
#: Even a plane of evenly spaced points takes more bytes; a chunk that claims more is damaged.
MOST_POINTS_PER_BYTE = 4096
_VARIABLE = 0xFFFFFFFF
_ITEM_SIZES = {6: 20, 7: 8, 8: 6, 9: 29, 10: 30, 11: 6, 12: 8, 13: 29}
#: Separately packed layers of the items of point formats 6 to 10; extra bytes have one layer each.
_LAYERS = {10: 9, 11: 1, 12: 2, 13: 1}
_POINTWISE_ITEMS, _LAYERED_ITEMS = {0, 6, 7, 8, 9}, {10, 11, 12, 13, 14}
_ONE_STREAM, _CHUNKED, _LAYERED = 1, 2, 3


@dataclass(frozen=True, slots=True)
class Packing:
    """What the LASzip record says of how the points are packed."""

    record: bytes
    kind: int
    chunk_size: int
    layers: int


@dataclass(frozen=True, slots=True)
class Chunk:
    """One independently packed run of points: where its bytes are and how many points they make."""

    start: int
    size: int
    points: int


def read_packing(header: Header, name: str) -> Packing:
    """Read and check the LASzip record, refusing what the decoder cannot do or would trip over.

    Raises
    ------
    ScanError
        The record is missing, damaged, or of a LASzip version that cannot be decoded.
    """
    record = header.records.get(LASZIP, b"")
    if len(record) < 34:
        raise ScanError(
            f"{name}: has no LASzip record, so its points cannot be unpacked; export the file again"
        )
    kind, coder, chunk_size, item_count = struct.unpack("<HH8xI16xH", record[:34])
    items = list(struct.iter_unpack("<HHH", record[34 : 34 + 6 * item_count][: (len(record) - 34) // 6 * 6]))
    known = coder == 0 and kind in (_ONE_STREAM, _CHUNKED, _LAYERED) and 0 < item_count == len(items)
    if not known or not _fit(items, kind, header):
        raise ScanError(
            f"{name}: is packed in a way that cannot be read (LASzip kind {kind}, coder {coder}, items "
            f"{[item[0] for item in items]}); save it again with a current LASzip or PDAL"
        )
    layers = sum(size if item == 14 else _LAYERS.get(item, 0) for item, size, _ in items)
    return Packing(record, kind, chunk_size or _VARIABLE, layers)


def _fit(items: list[tuple[int, int, int]], kind: int, header: Header) -> bool:
    """Tell whether the packed items have their own sizes, make up one record and belong together."""
    family, versions = (_LAYERED_ITEMS, {3, 4}) if kind == _LAYERED else (_POINTWISE_ITEMS, {1, 2})
    return (
        items[0][0] == (10 if header.point_format >= 6 else 6)
        and all(item in family and version in versions for item, _, version in items)
        and all(_ITEM_SIZES.get(item, size) == size for item, size, _ in items)
        and sum(size for _, size, _ in items) == header.record_length
    )


def blocks(file: BinaryIO, header: Header, name: str) -> Iterator[Bytes]:
    """Decode the points in order.

    Yields
    ------
    ndarray of uint8
        Whole records, at most about :data:`BLOCK` of them unless a chunk is larger.
        Ends early where a damaged or truncated file can be decoded no further.

    Raises
    ------
    ScanError
        The packing is unknown, or a chunk is too large.
    """
    packing = read_packing(header, name)
    chunks = None if packing.kind == _ONE_STREAM else find_chunks(file, header, packing)
    if chunks is None:
        yield from _decode_stream(file, header, packing, name)
    else:
        yield from _decode_chunks(file, header, packing, chunks, name)


def find_chunks(file: BinaryIO, header: Header, packing: Packing) -> list[Chunk] | None:
    """Locate the chunks that lie whole in the file, or None if only decoding can tell where they end."""
    table = _table_start(file, header)
    if packing.kind == _LAYERED:
        return list(_layered_chunks(file, header, packing, table or header.size))
    return None if table is None else _tabled_chunks(file, header, packing, table)


def _table_start(file: BinaryIO, header: Header) -> int | None:
    """Find the table of chunks: named at the start of the points, or at the end of a streamed file."""
    for place in (header.start, header.size - 8):
        file.seek(place)
        raw = file.read(8)
        if len(raw) == 8 and header.start + 8 <= (start := struct.unpack("<q", raw)[0]) <= header.size - 8:
            return int(start)
    return None


def _layered_chunks(file: BinaryIO, header: Header, packing: Packing, end: int) -> Iterator[Chunk]:
    """Walk chunks that say their own length, which needs no table: point formats 6 to 10."""
    start, left = header.start + 8, header.count
    head = header.record_length + 4 + 4 * packing.layers
    while left > 0 and start + head <= end:
        file.seek(start + header.record_length)
        points, *sizes = struct.unpack(f"<{1 + packing.layers}I", file.read(head - header.record_length))
        size = head + sum(sizes)
        if not 0 < points <= size * MOST_POINTS_PER_BYTE or start + size > end:
            return
        yield Chunk(start, size, min(points, left))
        start, left = start + size, left - points


def _tabled_chunks(file: BinaryIO, header: Header, packing: Packing, table: int) -> list[Chunk] | None:
    """Read the table of chunks; None if it is damaged."""
    import lazrs

    file.seek(table)
    _, count = struct.unpack("<II", file.read(8))
    if count > (table - header.start) // header.record_length:  # every chunk begins with one unpacked record
        return None
    file.seek(table)
    entries: list[tuple[int, int]] = []
    with _until_damage():
        entries = lazrs.read_chunk_table_only(file, lazrs.LazVlr(packing.record))
    chunks: list[Chunk] = []
    start, left = header.start + 8, header.count
    for points, size in entries:
        if left == 0:
            break
        points = min(points if packing.chunk_size == _VARIABLE else packing.chunk_size, left)
        if not 0 < points <= size * MOST_POINTS_PER_BYTE or start + size > table:
            return chunks if packing.chunk_size == _VARIABLE else None
        chunks.append(Chunk(start, size, points))
        start, left = start + size, left - points
    return chunks


def _decode_chunks(
    file: BinaryIO, header: Header, packing: Packing, chunks: list[Chunk], name: str
) -> Iterator[Bytes]:
    for group in _groups(chunks):
        if any(chunk.points * header.record_length > LARGEST_CHUNK for chunk in group):
            raise ScanError(
                f"{name}: the chunk at byte {group[-1].start} would unpack to {group[-1].points} points at "
                "once; save the file again with chunks of 50000 points"
            )
        decoded = _decode(file, header, packing, group)
        if decoded is not None:
            yield decoded
            continue
        for chunk in group if len(group) > 1 else []:
            decoded = _decode(file, header, packing, [chunk])
            if decoded is None:
                return
            yield decoded
        return


def _groups(chunks: list[Chunk]) -> Iterator[list[Chunk]]:
    group: list[Chunk] = []
    points = 0
    for chunk in chunks:
        if group and points + chunk.points > BLOCK:
            yield group
            group, points = [], 0
        group.append(chunk)
        points += chunk.points
    if group:
        yield group


def _decode(file: BinaryIO, header: Header, packing: Packing, chunks: list[Chunk]) -> Bytes | None:
    """Decode neighbouring chunks at once; None if one of them is damaged."""
    import lazrs

    file.seek(chunks[0].start)
    packed = file.read(sum(chunk.size for chunk in chunks))
    out = np.empty(sum(chunk.points for chunk in chunks) * header.record_length, np.uint8)
    table = [(chunk.points, chunk.size) for chunk in chunks]
    with _until_damage():
        lazrs.decompress_points_with_chunk_table(packed, packing.record, out, table, _selection())
        return out
    return None


@contextmanager
def _until_damage() -> Iterator[None]:
    """Leave the block where the decoder meets data it cannot make sense of."""
    import lazrs

    try:
        yield
    except (lazrs.LazrsError, OSError):
        pass
    except BaseException as error:
        # A panic of the decoder is no Exception, and its class has no name to import.
        if type(error).__name__ != "PanicException":
            raise


def _selection() -> Any:
    """Choose the layers this program uses; the others (time, angle, ...) stay packed."""
    import lazrs

    return lazrs.DecompressionSelection(
        lazrs.SELECTIVE_DECOMPRESS_XY_RETURNS_CHANNEL
        | lazrs.SELECTIVE_DECOMPRESS_Z
        | lazrs.SELECTIVE_DECOMPRESS_CLASSIFICATION
        | lazrs.SELECTIVE_DECOMPRESS_INTENSITY
        | lazrs.SELECTIVE_DECOMPRESS_RGB
    )


class _Stream(io.RawIOBase):
    """A file that only reads on: the decoder then looks for no table of chunks."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        data = self._file.read(len(buffer))
        buffer[: len(data)] = data
        return len(data)


def _decode_stream(file: BinaryIO, header: Header, packing: Packing, name: str) -> Iterator[Bytes]:
    """Decode from first to last: the oldest LASzip files, and files whose table of chunks is lost."""
    import lazrs

    if packing.chunk_size == _VARIABLE and packing.kind != _ONE_STREAM:
        raise ScanError(
            f"{name}: the table of its chunks is lost, probably cut off; copy or export the file again"
        )
    record = packing.record
    if packing.kind == _ONE_STREAM:
        # Those files leave the chunk size at 0, which the decoder takes for chunks of varying size.
        record = record[:12] + struct.pack("<I", 1) + record[16:]
    step = BLOCK if packing.kind == _ONE_STREAM else min(packing.chunk_size, BLOCK)
    file.seek(header.start)
    with _until_damage():
        decoder = lazrs.LasZipDecompressor(_Stream(file), record, _selection())
        for first in range(0, header.count, step):
            out = np.empty(min(step, header.count - first) * header.record_length, np.uint8)
            decoder.decompress_many(out)
            yield out
