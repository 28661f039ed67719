"""Rows of numbers written as text: what they look like, and parsing some lines of them.

Tidy rows go to Arrow's parser, the fastest that could be had. Lines that it refuses are tidied (mixed
separators, runs of blanks) and offered again; what is still refused is read row by row, which forgives the
most and can name the line that is wrong.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stepfield.scan.cloud import Numbers

#: Up to this many bytes are read row by row: loading Arrow would take longer.
SMALL = 1 << 20
_TIDY = bytes.maketrans(b"\t;", b" ,")
_DECIMAL = bytes.maketrans(b",;", b". ")
_BLANK_EDGES = ((b" ,", b","), (b", ", b","), (b"\r", b""), (b" \n", b"\n"), (b"\n ", b"\n"), (b" ", b","))


@dataclass(frozen=True)
class Layout:
    """How the numbers stand in the rows.

    Attributes
    ----------
    columns : int
        Fields of an ordinary row.
    wanted : tuple of int
        Columns to read: those of x, y and z, which every row must have, then any others.
    delimiter : str
        What separates the fields of a tidy row.
    decimal_comma : bool
        1,5 is one and a half.
    counts : bool
        A row of one integer only announces how many rows follow (PTS).
    exact : int
        So many of the wanted columns are kept as float64, the others as float32.
    """

    columns: int
    wanted: tuple[int, ...]
    delimiter: str = " "
    decimal_comma: bool = False
    counts: bool = False
    exact: int = 3


@dataclass(frozen=True)
class Table:
    """The wanted columns, in memory no larger than they need be.

    ``announced`` is the sum of the counts met in the rows; ``cut`` says that the file ends within a row,
    which is left out.
    """

    columns: list[Numbers]
    announced: int = 0
    cut: bool = False

    def __len__(self) -> int:
        return len(self.columns[0])


def layout_of(rows: list[bytes], wanted: tuple[int, ...]) -> Layout:
    """Guess the layout from the first rows of a table."""
    decimal = _has_decimal_comma(rows)
    row = rows[0] if rows else b""
    delimiter = next((mark for mark in ";,\t" if mark.encode() in row), " ")
    columns = max(len(fields(row, decimal)), max(wanted, default=0) + 1)
    return Layout(columns, wanted, " " if decimal else delimiter, decimal)


def _has_decimal_comma(rows: list[bytes]) -> bool:
    """Tell whether commas are decimal points: only when another separator makes every row whole."""
    found = False
    for row in rows[:50]:
        parts = row.replace(b";", b" ").split()
        if len(parts) < 3 or not all(is_number(part.replace(b",", b".")) for part in parts[:3]):
            return False
        if b"." in row or row.count(b",") > len(parts):
            return False
        found = found or b"," in row
    return found


def is_comment(line: bytes) -> bool:
    """Tell whether a line carries no row: blank, or a comment."""
    line = line.strip()
    return not line or line.startswith((b"#", b"//"))


def fields(line: bytes, decimal_comma: bool = False) -> list[bytes]:
    """Split a row: commas and semicolons separate, with or without blanks; else blanks do."""
    line = line.replace(b'"', b" ").translate(_DECIMAL if decimal_comma else _TIDY)
    if b"," not in line:
        return line.split()
    return [part for piece in line.split(b",") for part in (piece.split() or [b""])]


def is_number(field: bytes) -> bool:
    """Tell whether a field is a number; NaN and infinity are."""
    try:
        float(field)
    except ValueError:
        return False
    return True


class BadRowError(Exception):
    """Line ``index`` of a block (from 0) is not a row of numbers."""

    def __init__(self, index: int, line: bytes) -> None:
        self.index, self.line = index, line


def parse(block: bytes, layout: Layout, last: bool) -> Table:
    """Parse whole lines by the quickest way that accepts them.

    Parameters
    ----------
    block : bytes
    layout : Layout
    last : bool
        The file ends with the block, so its last line may be cut.

    Raises
    ------
    BadRowError
        A line is neither a row nor a comment.
    """
    if len(block) > SMALL:
        for text, delimiter, blank in _attempts(block, layout):
            columns = _by_arrow(text, delimiter, blank, layout)
            if columns:
                return Table(columns)
    return _row_by_row(block, layout, last)


def _attempts(block: bytes, layout: Layout) -> Iterator[tuple[bytes, str, list[str]]]:
    """Offer a block as it is, where an empty field would betray a run of blanks, and then tidied."""
    if 0 not in layout.wanted[:3] and (b"#" in block or b"//" in block):
        return  # a comment could pass for a row whose first field is not looked at
    if layout.decimal_comma:
        block = block.translate(_DECIMAL)
    yield block, layout.delimiter, []
    yield _tidied(block), ",", [""]


def _tidied(block: bytes) -> bytes:
    """Return the rows with single commas between their fields."""
    block = block.translate(_TIDY).strip(b" ")
    while b"  " in block:
        block = block.replace(b"  ", b" ")
    for odd, tidy in _BLANK_EDGES:
        block = block.replace(odd, tidy)
    return block


def _by_arrow(block: bytes, delimiter: str, blank: list[str], layout: Layout) -> list[Numbers]:
    """Return the wanted columns, or none if the rows are not all alike."""
    import pyarrow as pa
    from pyarrow import csv

    names = [f"f{i}" for i in range(layout.columns)]
    wanted = [names[i] for i in layout.wanted]
    try:
        table = csv.read_csv(
            pa.py_buffer(block),
            read_options=csv.ReadOptions(column_names=names, use_threads=False),
            parse_options=csv.ParseOptions(delimiter=delimiter),
            convert_options=csv.ConvertOptions(
                include_columns=wanted, column_types=dict.fromkeys(wanted, pa.float64()), null_values=blank
            ),
        )
    except pa.ArrowInvalid:
        return []
    return [kept(i, table.column(name).to_numpy(), layout) for i, name in enumerate(wanted)]


def _row_by_row(block: bytes, layout: Layout, last: bool) -> Table:
    """Read the rows of a block one at a time, with patience for all that can be understood."""
    values, announced, cut = array("d"), 0, False
    lines = block.splitlines()
    for index, line in enumerate(lines):
        if is_comment(line):
            continue
        parts = fields(line, layout.decimal_comma)
        if layout.counts and len(parts) == 1 and parts[0].isdigit():
            announced += int(parts[0][:18])
            continue
        try:
            values.extend(_row(parts, layout.wanted))
        except (ValueError, IndexError):
            cut = last and not any(map(bytes.strip, lines[index + 1 :]))
            if not cut:
                raise BadRowError(index, line) from None
    table = np.frombuffer(values, np.float64).reshape(-1, len(layout.wanted))
    return Table([kept(i, table[:, i].copy(), layout) for i in range(table.shape[1])], announced, cut)


def _row(parts: list[bytes], wanted: tuple[int, ...]) -> list[float]:
    """Return one row: a missing or wordy attribute is NaN, a coordinate must be there."""
    row = [float(parts[i] or b"nan") for i in wanted[:3]]
    for i in wanted[3:]:
        row.append(float(parts[i]) if i < len(parts) and is_number(parts[i]) else np.nan)
    return row


def kept(i: int, column: Numbers, layout: Layout) -> Numbers:
    """Return column ``i`` as it is kept: attributes in half the memory of coordinates."""
    with np.errstate(over="ignore"):
        return column.astype(np.float64 if i < layout.exact else np.float32, copy=False)
