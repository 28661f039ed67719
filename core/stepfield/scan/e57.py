"""E57: every scan of the file, posed, as one cloud in metres.

The library's lower level is used because its upper one wants poses, colours and intensities to be there
and makes room for however many points the file claims.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stepfield.errors import ScanError
from stepfield.progress import Progress
from stepfield.scan import crs
from stepfield.scan.cloud import Cloud, Floats, Numbers, finite_cloud
from stepfield.scan.columns import in_one_sentence, shortened

#: Points read at a time: the arithmetic on them stays in the processor's cache.
BLOCK = 1 << 16
#: Points that are not all the same take at least a bit each.
_MOST_POINTS_PER_BYTE = 8
_HEADER_LENGTH = 48
_CARTESIAN = ("cartesianX", "cartesianY", "cartesianZ")
_SPHERICAL = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
_SYSTEMS = {_CARTESIAN: "cartesianInvalidState", _SPHERICAL: "sphericalInvalidState"}
_COLOURS = ("colorRed", "colorGreen", "colorBlue")


@in_one_sentence
def read(path: Path, progress: Progress) -> Cloud:
    """Read all scans of an E57 file.

    Parameters
    ----------
    path : Path
    progress : Progress

    Returns
    -------
    Cloud
        Axes of float64 in the file's common coordinates, metres; ``rgb`` and ``intensity`` where every
        scan has them. Points marked invalid count as not finite.

    Raises
    ------
    ScanError
        The file is damaged, or holds no points.
    """
    _check_header(path)
    with _sentences(path.name), _opened(path) as image:
        scans = [_scan(node, path) for node in _scan_nodes(image.root())]
        return _cloud(image, [scan for scan in scans if scan is not None], path, progress)


@contextmanager
def _sentences(name: str) -> Iterator[None]:
    """Turn whatever goes wrong into one sentence."""
    from pye57.libe57 import E57Exception

    try:
        yield
    except (E57Exception, ValueError, TypeError, AttributeError, LookupError, RuntimeError) as error:
        # The library's wrapper answers odd structures with any of these, too.
        what = str(error).split("\n")[0].split(" (")[0] or type(error).__name__
        raise ScanError(f"{name}: damaged E57 file ({what}); copy or export it again") from None


def _check_header(path: Path) -> None:
    with path.open("rb") as file:
        head = file.read(_HEADER_LENGTH)
        size = file.seek(0, 2)
    if head[:8] != b"ASTM-E57":
        raise ScanError(
            f"{path.name}: is not an E57 file, as it does not begin with ASTM-E57; check its type"
        )
    promised = struct.unpack_from("<Q", head, 16)[0] if len(head) == _HEADER_LENGTH else _HEADER_LENGTH
    if promised > size:
        raise ScanError(f"{path.name}: ends at byte {size} of {promised}; copy or export the file again")


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    from pye57 import libe57

    image = libe57.ImageFile(str(path), "r")
    try:
        yield image
    finally:
        image.close()


def _scan_nodes(root: Any) -> Iterator[Any]:
    if root.isDefined("data3D"):
        scans = root["data3D"]
        yield from (scans[index] for index in range(len(scans)))


def _text(node: Any, name: str) -> str:
    return str(node[name].value()) if node.isDefined(name) else ""


@dataclass(frozen=True, slots=True)
class _Scan:
    """One scan of the file: what its points have, and how they stand in the common coordinates.

    ``system`` names the three coordinates and the mark of an invalid point; ``colours`` holds the value
    of no and of full colour for red, green and blue; ``pose`` is rotation and translation.
    """

    points: Any
    count: int
    fields: frozenset[str]
    system: tuple[str, str, str]
    state: str
    colours: tuple[tuple[float, float], ...]
    pose: tuple[Floats, Floats]


def _scan(node: Any, path: Path) -> _Scan | None:
    """Describe one scan, or None if it has no points."""
    from pye57 import libe57

    points = node["points"] if node.isDefined("points") else None
    count = 0 if points is None else int(points.childCount())
    if points is None or count == 0:
        return None
    if count > path.stat().st_size * _MOST_POINTS_PER_BYTE:
        raise ScanError(
            f"{path.name}: claims a scan of {count} points, which a file of its size cannot hold; "
            "export it again"
        )
    prototype = libe57.StructureNode(points.prototype())
    fields = frozenset(prototype.get(index).elementName() for index in range(prototype.childCount()))
    for system, state in _SYSTEMS.items():
        if fields.issuperset(system):
            colours = tuple(_colour_range(node, prototype, name) for name in _COLOURS if name in fields)
            return _Scan(points, count, fields, system, state, colours, _pose(node))
    raise ScanError(f"{path.name}: a scan has points without x, y and z; export it with its coordinates")


def _colour_range(scan: Any, prototype: Any, name: str) -> tuple[float, float]:
    """Return the values of no and of full colour."""
    own = prototype[name]
    top = own.maximum() if hasattr(own, "maximum") else 255.0
    low = _number(scan, ("colorLimits", f"{name}Minimum"), 0.0)
    high = _number(scan, ("colorLimits", f"{name}Maximum"), top)
    return (low, high) if low < high < 1e9 else (0.0, 255.0)


def _pose(scan: Any) -> tuple[Floats, Floats]:
    """Return the rotation matrix and the translation of a scan; missing parts change nothing."""
    w, x, y, z = (_number(scan, ("pose", "rotation", name), float(name == "w")) for name in "wxyz")
    translation = np.array([_number(scan, ("pose", "translation", name), 0.0) for name in "xyz"])
    length = w * w + x * x + y * y + z * z
    if not 0 < length < np.inf or not np.isfinite(translation).all():
        raise ValueError("the pose of a scan is no rotation and translation")
    s = 2 / length
    rotation = [
        [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
        [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
        [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
    ]
    return np.array(rotation), translation


def _number(node: Any, path: Sequence[str], default: float) -> float:
    """Return a number within nested structures, if it is there."""
    for name in path:
        if not node.isDefined(name):
            return default
        node = node[name]
    return float(node.scaledValue() if hasattr(node, "scaledValue") else node.value())


def _cloud(image: Any, scans: Sequence[_Scan], path: Path, progress: Progress) -> Cloud:
    """Read the scans one behind the other into shared columns."""
    promised = sum(scan.count for scan in scans)
    if not promised:
        raise ScanError(f"{path.name}: holds no points; choose another file or export it again")
    columns = {axis: np.empty(promised) for axis in "xyz"}
    if all("intensity" in scan.fields for scan in scans):
        columns["intensity"] = np.empty(promised, np.float32)
    if all(len(scan.colours) == len(_COLOURS) for scan in scans):
        columns["rgb"] = np.empty((promised, 3), np.uint8)
    filled = 0
    for scan in scans:
        for block in _blocks(image, scan, columns.keys()):
            part = slice(filled, filled + len(block["x"]))
            for key, values in block.items():
                columns[key][part] = values
            filled = part.stop
            progress(filled / promised, f"reading {path.name}")
    columns = {key: values[:filled] for key, values in columns.items()}
    axes = (columns.pop("x"), columns.pop("y"), columns.pop("z"))
    warnings = () if filled == promised else (shortened(path, filled, promised),)
    wkt = crs.from_wkt(_text(image.root(), "coordinateMetadata")).wkt
    cloud = finite_cloud(axes, columns, unit="m", crs=wkt, warnings=warnings)
    if not len(cloud):
        raise ScanError(
            f"{path.name}: holds no points that are valid; choose another file or export it again"
        )
    return cloud


def _blocks(image: Any, scan: _Scan, wanted: Iterable[str]) -> Iterator[dict[str, Numbers]]:
    """Read a scan block by block, posed and with 8-bit colours."""
    from pye57 import libe57

    kinds = dict.fromkeys(scan.system, "d")
    kinds |= dict.fromkeys({scan.state} & scan.fields, "b")
    kinds |= {"intensity": "f"} if "intensity" in wanted else {}
    kinds |= dict.fromkeys(_COLOURS, "f") if "rgb" in wanted else {}
    memory = {name: np.empty(min(BLOCK, scan.count), kind) for name, kind in kinds.items()}
    buffers = libe57.VectorSourceDestBuffer()
    for name, values in memory.items():
        buffers.append(libe57.SourceDestBuffer(image, name, values, len(values), True, True))
    reader = scan.points.reader(buffers)
    left = scan.count
    while left and (count := min(reader.read(), left)):
        yield _converted(scan, {name: values[:count] for name, values in memory.items()})
        left -= count
    reader.close()


def _converted(scan: _Scan, raw: Mapping[str, Numbers]) -> dict[str, Numbers]:
    first, second, third = (raw[name] for name in scan.system)
    if scan.system == _SPHERICAL:
        level = first * np.cos(third)
        first, second, third = level * np.cos(second), level * np.sin(second), first * np.sin(third)
    rotation, translation = scan.pose
    block = {
        axis: row[0] * first + row[1] * second + row[2] * third + shift
        for axis, row, shift in zip("xyz", rotation, translation, strict=True)
    }
    if scan.state in raw:
        block["x"][raw[scan.state] != 0] = np.nan
    if "intensity" in raw:
        block["intensity"] = raw["intensity"]
    if _COLOURS[0] in raw:
        block["rgb"] = np.column_stack(
            [
                np.clip((raw[name] - low) * (255 / (high - low)) + 0.5, 0, 255).astype(np.uint8)
                for name, (low, high) in zip(_COLOURS, scan.colours, strict=True)
            ]
        )
    return block
