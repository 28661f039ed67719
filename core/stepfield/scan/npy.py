"""NumPy's own files: NPY and NPZ, checked before an array is made, and never unpickled."""

from __future__ import annotations

import lzma
import math
import struct
import tokenize
import warnings
import zipfile
import zlib
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.lib import format as npy_format

from stepfield.errors import ScanError
from stepfield.progress import Progress
from stepfield.scan.cloud import Cloud, Numbers
from stepfield.scan.columns import cloud_of, in_one_sentence, plain, shortened

_NAMES = ("points", "xyz", "pos")
#: Deflate cannot pack tighter: a member that claims more is lying.
_DENSEST = 1032
#: Far more than NumPy itself takes.
_LONGEST_HEADER = 1 << 16
_DAMAGE = (
    *(ValueError, TypeError, KeyError, IndexError, EOFError, SyntaxError, RecursionError, RuntimeError),
    *(OverflowError, struct.error, tokenize.TokenError, zipfile.BadZipFile, zlib.error, lzma.LZMAError),
)


@in_one_sentence
def read(path: Path, progress: Progress) -> Cloud:
    """Read an array of points, or of records with x, y and z.

    Raises
    ------
    ScanError
        The file is damaged, or holds no array that can be points.
    """
    try:
        if path.suffix.lower() == ".npz":
            return _npz(path)
        with path.open("rb") as file:
            array, declared = _array(file, path.stat().st_size)
    except ScanError:
        raise
    except _DAMAGE as error:
        # NumPy's own sentences run over several lines; the first says what is wrong.
        cause = (str(error).splitlines() or [type(error).__name__])[0][:100]
        kind = path.suffix[1:].upper()
        raise ScanError(f"{path.name}: cannot be read as {kind} ({cause}); save it again") from error
    short = () if len(array) == declared else (shortened(path, len(array), declared),)
    return _cloud(path, array, short)


def _array(file: BinaryIO, size: int) -> tuple[Numbers, int]:
    """Read the whole rows that a file of so many bytes holds, and how many it declares."""
    shape, fortran, dtype = _header(file)
    if dtype.hasobject:
        raise ValueError("its array holds Python objects")
    short = math.prod(shape) * dtype.itemsize > size - file.tell()
    if not shape or (fortran and len(shape) > 1 and short):
        raise ValueError(f"its shape {shape} does not fit its {size} bytes")
    row = math.prod(shape[1:]) * dtype.itemsize
    rows = min(shape[0], (size - file.tell()) // row) if row else 0
    values = np.frombuffer(file.read(rows * row), dtype)
    if fortran:
        return values.reshape(shape[::-1]).T, shape[0]
    return values.reshape(rows, *shape[1:]), shape[0]


def _header(file: BinaryIO) -> tuple[tuple[int, ...], bool, np.dtype[np.generic]]:
    version = npy_format.read_magic(file)
    start = file.tell()
    length = int.from_bytes(file.read(2 if version == (1, 0) else 4), "little")
    if length > _LONGEST_HEADER:  # room for all of it would be taken before it is read
        raise ValueError(f"its header claims {length} bytes")
    file.seek(start)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about headers written by Python 2, which read well
        read = npy_format.read_array_header_1_0 if version == (1, 0) else npy_format.read_array_header_2_0
        shape, fortran, dtype = read(file)
    if any(side < 0 for side in shape):
        raise ValueError(f"its shape {shape} is impossible")
    return shape, fortran, dtype


def _cloud(path: Path, array: Numbers, notes: tuple[str, ...] = ()) -> Cloud:
    """Make the Cloud of records or of rows of numbers."""
    if array.dtype.names:
        columns = _fields(path, array)
    else:
        _refuse_shape(path, array)
        columns = {axis: np.ascontiguousarray(array[:, i]) for i, axis in enumerate("xyz")}
    if all(columns[axis].dtype.kind in "iu" for axis in "xyz" if axis in columns):
        notes += (f"{path.name}: integer coordinates carry no scale; they are taken as they are",)
    return cloud_of(path, columns, "records", warnings=notes)


def _fields(path: Path, array: Numbers) -> dict[str, Numbers]:
    """Return the fields of records that hold one number each."""
    if array.ndim != 1:
        raise ScanError(
            f"{path.name}: its records stand in {array.ndim} dimensions; save them in one, with x, y and z"
        )
    columns: dict[str, Numbers] = {}
    for name in array.dtype.names or ():
        if array[name].ndim == 1 and array[name].dtype.kind in "iufb":
            columns.setdefault(plain(name), _usual(array[name]))
    return columns


def _refuse_shape(path: Path, array: Numbers) -> None:
    """Refuse what is not a row of three or more numbers a point."""
    shape = " x ".join(map(str, array.shape))
    lying = array.ndim == 2 and array.shape[0] == 3 and array.shape[1] > 9
    if array.ndim != 2 or array.shape[1] < 3 or lying:
        hint = "transpose it" if lying else "save it as one row of x, y, z a point"
        raise ScanError(f"{path.name}: its array is {shape}, not a row of x, y, z a point; {hint}")
    if array.dtype.kind not in "iuf":
        raise ScanError(f"{path.name}: its array holds {array.dtype}, not numbers; save x, y, z as numbers")


def _usual(column: Numbers) -> Numbers:
    """Return a column in a kind that everything downstream knows."""
    if column.dtype.kind == "b":
        return column.astype(np.uint8)
    return np.ascontiguousarray(column)


def _npz(path: Path) -> Cloud:
    """Choose the array of points in an archive: by name, by x, y, z, or the only one that can be."""
    with zipfile.ZipFile(path) as archive:
        members = {Path(info.filename).stem.lower(): info for info in archive.infolist()}
        named = next((members[name] for name in _NAMES if name in members), None)
        if named is not None:
            return _cloud(path, _member(archive, named))
        if {"x", "y", "z"} <= members.keys():
            return _cloud_of_three(path, [_member(archive, members[axis]) for axis in "xyz"])
        fitting = [info for info in members.values() if _can_be_points(archive, info)]
        if len(fitting) != 1:
            raise ScanError(
                f"{path.name}: holds {len(fitting)} arrays that could be points; name the right one 'points'"
            )
        return _cloud(path, _member(archive, fitting[0]))


def _cloud_of_three(path: Path, axes: list[Numbers]) -> Cloud:
    if any(axis.ndim != 1 or len(axis) != len(axes[0]) or axis.dtype.kind not in "iuf" for axis in axes):
        raise ScanError(f"{path.name}: its arrays x, y and z are not equally long numbers; save them again")
    return cloud_of(path, dict(zip("xyz", axes, strict=True)))


def _can_be_points(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bool:
    with archive.open(info) as file:
        shape, _, dtype = _header(file)  # type: ignore[arg-type]
    names = {plain(name) for name in dtype.names or ()}
    return set("xyz") <= names or (len(shape) == 2 and shape[1] == 3 and dtype.kind in "iuf")


def _member(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> Numbers:
    """Read one array of an archive, which is whole or damaged."""
    if info.file_size > (info.compress_size + 1) * _DENSEST:
        raise ValueError(f"{info.filename} declares more bytes than it can hold")
    with archive.open(info) as file:
        array, declared = _array(file, info.file_size)  # type: ignore[arg-type]
    if len(array) < declared:
        raise ValueError(f"{info.filename} ends early")
    return array
