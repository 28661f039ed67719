"""Write points as a scan in the formats of the field: whole files or none, the same bytes every time."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator, Mapping
from datetime import date
from pathlib import Path
from typing import IO

import numpy as np

from stepfield.errors import ScanError
from stepfield.files import reason
from stepfield.scan.cloud import Floats, Numbers

#: Columns by name, x, y and z first; every one of shape (N,).
Table = dict[str, Numbers]

#: Coordinates go as float32 where that moves no point by more than this.
EXACT_ENOUGH = 1e-6
#: Scales of LAS coordinates, the finest first; the first whose integers reach across the scan is taken.
_SCALES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0)
_ROWS = 1 << 16
_RGB = ("red", "green", "blue")
_PLY_TYPES = {
    "f4": "float", "f8": "double", "i1": "char", "u1": "uchar",
    "i2": "short", "u2": "ushort", "i4": "int", "u4": "uint",
}  # fmt: skip


def write(path: Path, points: Floats, attributes: Mapping[str, Numbers]) -> None:
    """Write a scan; the suffix says in which format.

    Parameters
    ----------
    path : Path
        ``.ply`` and ``.pcd`` (binary), ``.las``, ``.laz``, ``.e57``, ``.npy``, ``.csv`` (with a header),
        ``.xyz`` and ``.txt`` (without).
    points : ndarray of shape (N, 3)
        Finite coordinates. PLY and PCD store float32 if that moves no point by more than
        :data:`EXACT_ENOUGH`, else float64; LAS stores multiples of 0.001 or finer unless the scan is
        over 4000 km wide; the others store float64.
    attributes : mapping
        Any of ``rgb`` (N, 3) uint8 and further columns (N,) such as ``intensity``, ``classification`` and
        ``surface``; the latter are kept under their names in every format.

    Raises
    ------
    ScanError
        The format is unknown, there is no point or one that is not finite, or the file cannot be written.
    """
    writer = _WRITERS.get(path.suffix.lower())
    if writer is None:
        known = " ".join(sorted(_WRITERS))
        raise ScanError(
            f"{path.name}: scans cannot be written as {path.suffix or 'such a file'}; use {known}"
        )
    if not len(points) or not np.isfinite(points).all():
        raise ScanError(
            f"{path.name}: there are no points to write, or not all are finite; nothing was written"
        )
    try:
        with _replacing(path) as temporary:
            writer(temporary, _table(points, attributes))
    except OSError as error:
        raise ScanError(f"{path}: cannot be written ({reason(error)}); choose another place") from None


@contextlib.contextmanager
def _replacing(path: Path) -> Iterator[Path]:
    """Offer a name beside ``path`` that takes its place once all is written, and is removed otherwise."""
    temporary = path.with_name(f".{path.name[:80]}.{os.getpid()}{path.suffix}")
    try:
        yield temporary
        with temporary.open("rb+") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def _table(points: Floats, attributes: Mapping[str, Numbers]) -> Table:
    table: Table = dict(zip("xyz", np.asarray(points, np.float64).T, strict=True))
    for name, values in attributes.items():
        if name == "rgb":
            table |= dict(zip(_RGB, np.asarray(values, np.uint8).T, strict=True))
        else:
            table[name] = _compact(np.asarray(values))
    return table


def _compact(values: Numbers) -> Numbers:
    """Bring a column to a type that every format has."""
    if values.dtype.kind in "iub" and values.dtype.itemsize == 8:
        return values.astype(np.int32)
    return values.astype(np.uint8) if values.dtype.kind == "b" else values


def _narrow(table: Table) -> Table:
    """Make the coordinates float32 if nothing is lost by it."""
    narrow = {name: table[name].astype(np.float32) for name in "xyz"}
    exact = all(np.abs(table[name] - values).max() <= EXACT_ENOUGH for name, values in narrow.items())
    return table | narrow if exact else table


def _records(table: Table) -> Numbers:
    """Interleave columns into little-endian records."""
    kinds = [(name, values.dtype.newbyteorder("<")) for name, values in table.items()]
    records = np.empty(len(table["x"]), np.dtype(kinds))
    for name, values in table.items():
        records[name] = values
    return records


def _ply(path: Path, table: Table) -> None:
    table = _narrow(table)
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(table['x'])}"]
    lines += [f"property {_PLY_TYPES[values.dtype.str[1:]]} {name}" for name, values in table.items()]
    with path.open("wb") as file:
        file.write("\n".join([*lines, "end_header", ""]).encode())
        _dump(file, _records(table))


def _pcd(path: Path, table: Table) -> None:
    table = _narrow(table)
    if "red" in table:
        red, green, blue = (table.pop(name).astype(np.uint32) for name in _RGB)
        # The library's convention: 0x00RRGGBB, declared as a float.
        table["rgb"] = (red << 16 | green << 8 | blue).view(np.float32)
    count = len(table["x"])
    kinds = [values.dtype for values in table.values()]
    header = {
        "VERSION": "0.7",
        "FIELDS": " ".join(table),
        "SIZE": " ".join(str(kind.itemsize) for kind in kinds),
        "TYPE": " ".join(kind.kind.upper() for kind in kinds),
        "COUNT": " ".join("1" for _ in kinds),
        "WIDTH": str(count),
        "HEIGHT": "1",
        "VIEWPOINT": "0 0 0 1 0 0 0",
        "POINTS": str(count),
        "DATA": "binary",
    }
    with path.open("wb") as file:
        file.write("".join(f"{key} {value}\n" for key, value in header.items()).encode())
        _dump(file, _records(table))


def _dump(file: IO[bytes], records: Numbers) -> None:
    file.write(records.view(np.uint8).data)


def _npy(path: Path, table: Table) -> None:
    plain = np.column_stack(list(table.values())) if len(table) == 3 else _records(table)
    with path.open("wb") as file:
        np.lib.format.write_array(file, plain, version=(1, 0), allow_pickle=False)


def _csv(path: Path, table: Table) -> None:
    _rows(path, table, ",", ",".join(table) + "\n")


def _xyz(path: Path, table: Table) -> None:
    _rows(path, table, " ", "")


def _rows(path: Path, table: Table, separator: str, head: str) -> None:
    """Write rows with the fewest digits that give the same numbers back."""
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(head)
        for start in range(0, len(table["x"]), _ROWS):
            columns = [map(str, values[start : start + _ROWS].tolist()) for values in table.values()]
            file.writelines(separator.join(row) + "\n" for row in zip(*columns, strict=True))


def _las(path: Path, table: Table) -> None:
    """Write LAS or LAZ 1.4, whichever the suffix says."""
    import laspy
    from lazrs import LazrsError

    header = laspy.LasHeader(version="1.4", point_format=7 if "red" in table else 6)
    header.generating_software = header.system_identifier = "stepfield"
    header.creation_date = date(2000, 1, 1)  # any fixed one: the same scan makes the same bytes
    offsets = np.array([np.floor(table[axis].min()) for axis in "xyz"])
    widths = [table[axis].max() - offset for axis, offset in zip("xyz", offsets, strict=True)]
    scale = next((s for s in _SCALES if max(widths) / s < 2**31 - 1), max(widths) / 2**30)
    header.offsets, header.scales = offsets, np.full(3, scale)
    extra = [name for name in table if name not in {*"xyz", *_RGB, "intensity", "classification"}]
    header.add_extra_dims([laspy.ExtraBytesParams(name, table[name].dtype) for name in extra])
    las = laspy.LasData(header)
    for axis, offset in zip("xyz", offsets, strict=True):
        las[axis.upper()] = np.rint((table[axis] - offset) / scale).astype(np.int32)
    for name in [name for name in table if name not in "xyz"]:
        las[name] = _las_column(name, table[name])
    try:
        with path.open("wb") as file:
            las.write(file, do_compress=path.suffix.lower() == ".laz")
    except LazrsError as error:
        raise OSError(str(error)) from error


def _las_column(name: str, values: Numbers) -> Numbers:
    """Bring a column to what LAS wants: 16 bits for colours and intensity."""
    if name in _RGB:
        return values.astype(np.uint16) * 257
    if name == "intensity":
        fractions = values.dtype.kind == "f" and values.max() <= 1
        whole: Numbers = np.clip(np.rint(values * (65535 if fractions else 1)), 0, 65535)
        return whole.astype(np.uint16)
    return values


def _e57(path: Path, table: Table) -> None:
    from stepfield.scan import e57write

    e57write.write(path, table)


_WRITERS: dict[str, Callable[[Path, Table], None]] = {
    ".ply": _ply,
    ".pcd": _pcd,
    ".npy": _npy,
    ".csv": _csv,
    ".xyz": _xyz,
    ".txt": _xyz,
    ".las": _las,
    ".laz": _las,
    ".e57": _e57,
}
