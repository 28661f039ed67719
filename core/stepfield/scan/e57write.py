"""Write one scan as E57, by the library's lower level: the upper one rounds to float32 and invents a GUID."""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from stepfield.scan.cloud import Numbers

_BLOCK = 1 << 20
_NAMES = {
    "x": "cartesianX", "y": "cartesianY", "z": "cartesianZ", "intensity": "intensity",
    "red": "colorRed", "green": "colorGreen", "blue": "colorBlue",
}  # fmt: skip
#: Columns that the format does not know go under a prefix of our own, as it asks.
_PREFIX, _URI = "stepfield", "https://stepfield.invalid/e57"


def write(path: Path, table: Mapping[str, Numbers]) -> None:
    """Write the columns ``x``, ``y``, ``z`` and any others, all of shape (N,).

    Raises
    ------
    OSError
        The file cannot be written.
    """
    from pye57 import libe57

    try:
        image = libe57.ImageFile(str(path), "w")
        try:
            _write(image, libe57, table)
        finally:
            image.close()
    except libe57.E57Exception as error:
        raise OSError(str(error).split("\n")[0]) from error


def _write(image: Any, libe57: Any, table: Mapping[str, Numbers]) -> None:
    image.extensionsAdd("", libe57.E57_V1_0_URI)
    image.extensionsAdd(_PREFIX, _URI)
    root = image.root()
    created = libe57.StructureNode(image)
    created.set("dateTimeValue", libe57.FloatNode(image, 0.0))
    created.set("isAtomicClockReferenced", libe57.IntegerNode(image, 0))
    digest = hashlib.sha256(b"".join(np.ascontiguousarray(table[axis]).tobytes() for axis in "xyz"))
    guid = (
        f"{{{uuid.UUID(bytes=digest.digest()[:16])}}}"  # of the content: the same points make the same bytes
    )
    root.set("formatName", libe57.StringNode(image, "ASTM E57 3D Imaging Data File"))
    root.set("guid", libe57.StringNode(image, guid))
    root.set("versionMajor", libe57.IntegerNode(image, libe57.E57_FORMAT_MAJOR))
    root.set("versionMinor", libe57.IntegerNode(image, libe57.E57_FORMAT_MINOR))
    root.set("e57LibraryVersion", libe57.StringNode(image, "stepfield"))
    root.set("coordinateMetadata", libe57.StringNode(image, ""))
    root.set("creationDateTime", created)
    scans = libe57.VectorNode(image, True)
    root.set("data3D", scans)
    root.set("images2D", libe57.VectorNode(image, True))
    scan = libe57.StructureNode(image)
    scan.set("guid", libe57.StringNode(image, guid))
    scan.set("name", libe57.StringNode(image, "scan"))
    _add_limits(scan, image, libe57, table)
    points = libe57.CompressedVectorNode(
        image, _prototype(image, libe57, table), libe57.VectorNode(image, True)
    )
    scan.set("points", points)
    scans.append(scan)
    _write_points(points, image, libe57, table)


def _add_limits(scan: Any, image: Any, libe57: Any, table: Mapping[str, Numbers]) -> None:
    """State the box of the points, and what full intensity and colour are, for programs that ask."""
    box = libe57.StructureNode(image)
    for axis in "xyz":
        box.set(f"{axis}Minimum", libe57.FloatNode(image, float(table[axis].min())))
        box.set(f"{axis}Maximum", libe57.FloatNode(image, float(table[axis].max())))
    scan.set("cartesianBounds", box)
    if "intensity" in table:
        limits = libe57.StructureNode(image)
        limits.set("intensityMinimum", libe57.FloatNode(image, float(table["intensity"].min())))
        limits.set("intensityMaximum", libe57.FloatNode(image, float(table["intensity"].max())))
        scan.set("intensityLimits", limits)
    if "red" in table:
        limits = libe57.StructureNode(image)
        for colour in ("Red", "Green", "Blue"):
            limits.set(f"color{colour}Minimum", libe57.IntegerNode(image, 0))
            limits.set(f"color{colour}Maximum", libe57.IntegerNode(image, 255))
        scan.set("colorLimits", limits)


def _name(column: str) -> str:
    return _NAMES.get(column, f"{_PREFIX}:{column}")


def _prototype(image: Any, libe57: Any, table: Mapping[str, Numbers]) -> Any:
    """Describe one point: floats of their own precision, integers within their range."""
    prototype = libe57.StructureNode(image)
    for column, values in table.items():
        low, high = values.min().item(), values.max().item()
        if values.dtype.kind == "f":
            precision = libe57.E57_DOUBLE if values.dtype.itemsize == 8 else libe57.E57_SINGLE
            node = libe57.FloatNode(image, low, precision, low, high)
        else:
            low, high = (0, 255) if column in {"red", "green", "blue"} else (low, high)
            node = libe57.IntegerNode(image, low, low, high)
        prototype.set(_name(column), node)
    return prototype


def _write_points(points: Any, image: Any, libe57: Any, table: Mapping[str, Numbers]) -> None:
    count = len(table["x"])
    # "q", as the library takes "l" for 32 bits wherever it is 64.
    kinds = {name: "d" if values.dtype.kind == "f" else "q" for name, values in table.items()}
    block = {name: np.empty(min(_BLOCK, count), kind) for name, kind in kinds.items()}
    buffers = libe57.VectorSourceDestBuffer()
    for name, memory in block.items():
        buffers.append(libe57.SourceDestBuffer(image, _name(name), memory, len(memory), True, True))
    writer = points.writer(buffers)
    for start in range(0, count, _BLOCK):
        part = slice(start, min(start + _BLOCK, count))
        for name, memory in block.items():
            memory[: part.stop - start] = table[name][part]
        writer.write(part.stop - start)
    writer.close()
