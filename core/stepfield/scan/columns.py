"""From named columns to a Cloud: the rules on names, colours and failures that all readers share.

PLY properties, PCD fields, headers of text files and NPY records name the same things in a few ways;
which ones are understood is decided here and nowhere else.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Container, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from stepfield.errors import ScanError
from stepfield.files import one_line, reason
from stepfield.progress import Progress, silent
from stepfield.scan.cloud import Cloud, Numbers, Reader, finite_cloud

Columns = Mapping[str, Numbers]

_COLOURS = (("red", "green", "blue"), ("r", "g", "b"), ("diffuse_red", "diffuse_green", "diffuse_blue"))
_INTENSITY = ("intensity",)
_CLASSES = ("classification", "class", "label", "raw_classification")
#: Every name that has a use, in plain form; the rest of a file need not be converted.
USEFUL = frozenset({"x", "y", "z", *_INTENSITY, *_CLASSES, *(name for names in _COLOURS for name in names)})


def plain(name: str) -> str:
    """Return a name as it is compared: lower case, without quotes, unit or CloudCompare's prefix."""
    bare = re.sub(r"[\[(].*", "", name.strip().strip("\"'/# \t")).strip()
    return bare.lower().removeprefix("scalar_")


def cloud_of(path: Path, columns: Columns, holder: str = "points", **facts: Any) -> Cloud:
    """Make the Cloud of a file's columns.

    Parameters
    ----------
    path : Path
        Named in the errors.
    columns : mapping of str to ndarray of shape (N,)
        By plain name; see :func:`plain`. Columns without a use are ignored.
    holder : str
        What the columns belong to, for the sentence about a missing one.
    **facts
        More fields of the Cloud.

    Raises
    ------
    ScanError
        A coordinate is missing, or no point is left.
    """
    require_xyz(path, columns, holder)
    attributes, remarks = _attributes(columns)
    facts["warnings"] = (*facts.get("warnings", ()), *(f"{path.name}: {remark}" for remark in remarks))
    x, y, z = (native(columns[axis]) for axis in "xyz")
    cloud = finite_cloud((x, y, z), attributes, **facts)
    if not len(cloud):
        found = f"only {cloud.not_finite} that are not finite" if cloud.not_finite else "not one"
        raise ScanError(f"{path.name}: holds no points ({found}); export the scan again with its points")
    return cloud


def require_xyz(path: Path, names: Container[str], holder: str) -> None:
    """Refuse a file whose points, vertices, fields… lack a coordinate, saying which."""
    missing = " or ".join(axis for axis in "xyz" if axis not in names)
    if missing:
        raise ScanError(
            f"{path.name}: its {holder} have no {missing}; export them with x, y and z coordinates"
        )


def native(column: Numbers) -> Numbers:
    """Return a column in this machine's byte order."""
    return column if column.dtype.isnative else column.astype(column.dtype.newbyteorder("="))


def _attributes(columns: Columns) -> tuple[dict[str, Numbers], list[str]]:
    """Choose the attributes there are, and say what had to be left out."""
    attributes: dict[str, Numbers] = {}
    remarks: list[str] = []
    for names in _COLOURS:
        if "rgb" not in attributes and all(name in columns for name in names):
            attributes["rgb"] = colours([columns[name] for name in names])
    for name in _INTENSITY:
        if name in columns:
            attributes["intensity"] = native(columns[name])
    for name in _CLASSES:
        if name in columns and "classification" not in attributes:
            if _fits_byte(columns[name]):
                attributes["classification"] = columns[name].astype(np.uint8)
            else:
                remarks.append(f"its {name} goes beyond 0 to 255 and is left out")
    return attributes, remarks


def _fits_byte(column: Numbers) -> bool:
    return not column.size or bool(column.min() >= 0 and column.max() <= 255)  # False for NaN as well


def colours(channels: list[Numbers]) -> Numbers:
    """Return (N, 3) uint8 of colours stored as 0 to 1, as bytes or as 16-bit numbers."""
    fractions = all(channel.dtype.kind == "f" for channel in channels)
    channels = [np.nan_to_num(c, posinf=0, neginf=0) if c.dtype.kind == "f" else c for c in channels]
    top = max((float(channel.max()) for channel in channels if channel.size), default=0.0)
    # 16-bit colours keep their upper byte; a file whose values all fit a byte holds bytes.
    gain = 255.0 if fractions and top <= 1 else 1 / 256 if top > 255 else 1.0
    rgb = np.empty((len(channels[0]), 3), np.uint8)
    for i, channel in enumerate(channels):
        rgb[:, i] = _byte(channel, gain)
    return rgb


def _byte(channel: Numbers, gain: float) -> Numbers:
    if channel.dtype == np.uint8 and gain == 1:
        return channel
    scaled = channel.astype(np.float32) * np.float32(gain)
    whole: Numbers = np.clip(np.rint(scaled) if gain > 1 else np.floor(scaled), 0, 255)
    return whole.astype(np.uint8)


def in_one_sentence(read: Callable[[Path, Progress], Cloud]) -> Reader:
    """Turn the operating system's refusals inside a reader into its error, and that into one line."""

    @functools.wraps(read)
    def guarded(path: Path, progress: Progress = silent) -> Cloud:
        try:
            return read(path, progress)
        except ScanError as error:
            raise ScanError(one_line(str(error))) from error
        except OSError as error:
            raise ScanError(f"{path.name}: cannot be read ({reason(error)}); check the file") from error
        except MemoryError as error:
            raise ScanError(f"{path.name}: does not fit into memory; crop it or split it first") from error

    return guarded


def shortened(path: Path, found: int, declared: int, what: str = "points") -> str:
    """Return the warning about a file that ends before all it declares."""
    return f"{path.name}: ends early: {found} of its {declared} {what} are there"
