"""Tables of numbers in text files, read block by block: what every ascii format shares.

Some blocks are parsed at a time, as Arrow's parser leaves Python's lock alone; the memory is that of the
columns and a few blocks.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from stepfield.errors import ScanError
from stepfield.progress import Progress, silent
from stepfield.scan.rows import BadRowError, Layout, Table, is_comment, kept, parse

#: Bytes parsed at a time; also the longest line that is believed.
BLOCK = 8 << 20
_WORKERS = min(4, os.cpu_count() or 1)


def read_table(
    path: Path, start: int, layout: Layout, limit: int | None = None, progress: Progress = silent
) -> Table:
    """Read rows of numbers from byte ``start`` to the end of the file, or ``limit`` rows.

    Raises
    ------
    ScanError
        A row is not what it should be; its line is named.
    """
    size = path.stat().st_size - start
    growing = Growing(layout)
    with path.open("rb") as file:
        for block, parsed in _parsed(_Lines(file, start, limit), layout, growing, limit):
            try:
                growing.add(parsed.result(), size / len(block.text))
                progress(min(1.0, file.tell() / (start + size)), f"reading {path.name}")
            except BadRowError as bad:
                raise _named(path, block.at, bad) from bad
    return growing.table(limit)


def _parsed(
    lines: _Lines, layout: Layout, growing: Growing, limit: int | None
) -> Iterator[tuple[_Block, Future[Table]]]:
    """Parse a few blocks at once, in order; after them, lines in place of those that held no row."""
    pending: deque[tuple[_Block, Future[Table]]] = deque()
    with ThreadPoolExecutor(_WORKERS) as pool:
        while True:
            block = lines.take()
            if block.text:
                pending.append((block, pool.submit(parse, block.text, layout, block.last)))
            while pending and (not block.text or len(pending) > _WORKERS):
                yield pending.popleft()
            if not block.text:
                lines.left = 0 if limit is None or block.last else max(0, limit - growing.rows)
                if not lines.left:
                    return


def read_rows(path: Path, block: bytes, layout: Layout, seen: int, last: bool) -> Table:
    """Read rows that were picked out of a file's lines; ``seen`` rows came before.

    Raises
    ------
    ScanError
        A row is not what it should be; its number is named.
    """
    try:
        return parse(block, layout, last)
    except BadRowError as bad:
        raise _no_row(path, f"vertex {seen + bad.index + 1}", bad) from bad


def first_rows(path: Path, start: int, most: int = 1 << 16) -> list[bytes]:
    """Return the first whole lines from byte ``start`` that are neither blank nor comments."""
    with path.open("rb") as file:
        file.seek(start)
        head = file.read(most)
    lines = head.splitlines()
    lines = lines[:-1] if len(head) == most else lines
    return [line for line in lines if not is_comment(line)]


@dataclass(frozen=True)
class _Block:
    """Whole lines that start at byte ``at``; ``last`` if the file ends with them."""

    at: int
    text: bytes
    last: bool


class _Lines:
    """Whole lines of a file, a block at a time, ``left`` of them or all."""

    def __init__(self, file: BinaryIO, start: int, left: int | None) -> None:
        self._file, self._at, self._rest = file, start, b""
        self._ended = False
        self.left = left
        file.seek(start)

    def take(self) -> _Block:
        """Return the next block, which is empty once there are no more lines."""
        at, data = self._at, self._rest
        if len(data) < BLOCK and not self._ended:
            more = self._file.read(BLOCK)
            data, self._ended = data + more, len(more) < BLOCK
        stop = len(data) if self._ended else max(data.rfind(b"\n"), data.rfind(b"\r")) + 1
        if data and not stop:
            raise _no_lines(self._file.name)
        if self.left is not None:
            stop = self._limited(data, stop)
        self._at, self._rest = at + stop, data[stop:]
        return _Block(at, data[:stop], self._ended and not self._rest)

    def _limited(self, data: bytes, stop: int) -> int:
        """Return where the lines that are left end, and count them off."""
        left = self.left or 0
        there = data.count(b"\n", 0, stop)
        if there > left:
            ends = np.flatnonzero(np.frombuffer(data, np.uint8) == ord("\n"))
            stop = int(ends[left - 1]) + 1 if left else 0
        self.left = max(0, left - there)
        return stop


def _no_lines(name: str) -> ScanError:
    return ScanError(
        f"{Path(name).name}: has no line end within {BLOCK >> 20} MB, so it is no text; check the file's kind"
    )


def _named(path: Path, at: int, bad: BadRowError) -> ScanError:
    """Count the lines before a bad row: done only once something is wrong."""
    before = 0
    with path.open("rb") as file:
        while at and (part := file.read(min(BLOCK, at))):
            before += part.count(b"\n")
            at -= len(part)
    return _no_row(path, f"line {before + bad.index + 1}", bad)


def _no_row(path: Path, where: str, bad: BadRowError) -> ScanError:
    shown = bad.line[:40].decode("ascii", "backslashreplace").strip()
    return ScanError(f"{path.name}: {where} ({shown!r}) does not hold three numbers; correct or delete it")


class Growing:
    """Columns that blocks are added to, in memory taken once for as many rows as there will be."""

    def __init__(self, layout: Layout) -> None:
        self._columns = [kept(i, np.empty(0), layout) for i in range(len(layout.wanted))]
        self._announced, self._cut = 0, False
        self.rows = 0

    def add(self, part: Table, blocks: float) -> None:
        """Add the rows of a block, of which about so many may come in all."""
        stop = self.rows + len(part)
        if stop > len(self._columns[0]):
            self._reserve(max(stop, int((len(part) * blocks if not self.rows else stop * 1.25) * 1.02)))
        for column, added in zip(self._columns, part.columns, strict=True):
            column[self.rows : stop] = added
        self.rows = stop
        self._announced += part.announced
        self._cut |= part.cut

    def _reserve(self, rows: int) -> None:
        for i, column in enumerate(self._columns):
            larger = np.empty(rows, column.dtype)
            larger[: self.rows] = column[: self.rows]
            self._columns[i] = larger

    def table(self, limit: int | None = None) -> Table:
        """Return all rows, or the first ``limit``."""
        rows = self.rows if limit is None else min(self.rows, limit)
        return Table([column[:rows] for column in self._columns], self._announced, self._cut)
