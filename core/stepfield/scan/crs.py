"""What a file's coordinate reference system says of its unit.

The text (WKT) is taken apart here: loading GDAL takes longer than reading most scans, and it writes its
own complaints to the terminal. Only an EPSG code needs its database, and only then is it loaded.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass

#: Metres in one unit, by the names of :data:`stepfield.parameters.METRES`.
_FACTORS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "us-ft": 1200 / 3937}
#: EPSG codes of units of length, as GeoTIFF keys give them.
_EPSG_UNITS = {9001: "m", 9002: "ft", 9003: "us-ft", 1033: "cm", 1025: "mm"}
_MODEL, _PROJECTED_CODE, _PROJECTED_UNIT, _VERTICAL_UNIT = 1024, 3072, 3076, 4099
_GEOGRAPHIC_MODEL = 2
_USER_DEFINED = 32767

_COMPOUND = {"COMPD_CS", "COMPOUNDCRS"}
_DEGREES = {"GEOGCS", "GEOGCRS", "GEOGRAPHICCRS"}
_VERTICAL = {"VERT_CS", "VERTCRS", "VERTICALCRS"}
_LENGTH = {"PROJCS", "PROJCRS", "PROJECTEDCRS", "GEOCCS", "LOCAL_CS", "ENGCRS", "ENGINEERINGCRS", *_VERTICAL}
_EITHER = {"GEODCRS", "GEODETICCRS"}
_TOKEN = re.compile(r'\s*(?:"((?:[^"]|"")*)"|([A-Za-z_][A-Za-z0-9_]*)|([-+.0-9][-+.0-9eE]*)|([\[(\])]),?|,)')

IN_DEGREES = (
    "the coordinates are in degrees, not in a unit of length; project the scan to a metric system first"
)


@dataclass(frozen=True, slots=True)
class Reference:
    """A coordinate reference system: its text and the unit it declares, as far as known."""

    wkt: str | None = None
    unit: str | None = None
    warnings: tuple[str, ...] = ()


@dataclass(slots=True)
class _Node:
    keyword: str
    values: list[str]
    children: list[_Node]


def from_wkt(text: str) -> Reference:
    """Read the unit of the well-known text, of version 1 or 2.

    A compound system counts by its horizontal part; a warning says so when its heights differ.
    """
    root = _parse(text)
    if root is None:
        return Reference(None, None, ("its coordinate reference system cannot be understood and is ignored",))
    systems = [node for node in _walk(root) if node.keyword in _LENGTH | _DEGREES | _EITHER]
    if not systems:
        return Reference(text)
    unit, degrees = _unit(systems[0])
    if degrees:
        return Reference(text, None, (IN_DEGREES,))
    vertical = next((_unit(node)[0] for node in systems[1:] if node.keyword in _VERTICAL), None)
    return Reference(text, unit, _disagreement(unit, vertical))


def from_geo_keys(directory: bytes) -> Reference:
    """Read the unit and the EPSG code of a GeoTIFF key directory."""
    numbers = struct.unpack(f"<{len(directory) // 2}H", directory[: len(directory) // 2 * 2])
    keys = {
        numbers[at]: numbers[at + 3]
        for at in range(4, len(numbers) - 3, 4)
        if numbers[at + 1] == 0  # the value is in the directory itself
    }
    if keys.get(_MODEL) == _GEOGRAPHIC_MODEL:
        return Reference(None, None, (IN_DEGREES,))
    wkt = _wkt_of_epsg(keys.get(_PROJECTED_CODE, _USER_DEFINED))
    unit = _EPSG_UNITS.get(keys.get(_PROJECTED_UNIT, 0))
    if unit is None and wkt is not None:
        unit = from_wkt(wkt).unit
    return Reference(wkt, unit, _disagreement(unit, _EPSG_UNITS.get(keys.get(_VERTICAL_UNIT, 0))))


def _disagreement(unit: str | None, vertical: str | None) -> tuple[str, ...]:
    if unit is None or vertical is None or unit == vertical:
        return ()
    return (
        f"the plan is declared in {unit} but the heights in {vertical}; all three are taken to be in {unit}",
    )


def _wkt_of_epsg(code: int) -> str | None:
    """Look the code up; None if it is not one, or the database is not there."""
    if not 1024 <= code < _USER_DEFINED:
        return None
    import rasterio
    from rasterio.errors import CRSError

    with rasterio.Env():  # without it GDAL prints its errors
        try:
            return str(rasterio.crs.CRS.from_epsg(code).to_wkt())
        except CRSError:
            return None


def _unit(system: _Node) -> tuple[str | None, bool]:
    """Tell the unit a system's own coordinates are in, and whether that is degrees."""
    if system.keyword in _DEGREES:
        return None, True
    own = [child for child in system.children if child.keyword in {"UNIT", "LENGTHUNIT", "ANGLEUNIT"}]
    axes = [child for axis in system.children if axis.keyword == "AXIS" for child in axis.children]
    given = own or [child for child in axes if child.keyword in {"UNIT", "LENGTHUNIT", "ANGLEUNIT"}]
    if not given:
        return None, False
    if system.keyword in _EITHER and (given[0].keyword == "ANGLEUNIT" or "deg" in given[0].values[0].lower()):
        return None, True
    return _unit_named(given[0].values), False


def _unit_named(values: list[str]) -> str | None:
    """Tell a unit by its metres; by its name if the metres are a careless 1."""
    try:
        name, metres = values[0].lower(), float(values[1])
    except (IndexError, ValueError):
        return None
    if metres == 1.0 and ("foot" in name or "feet" in name):
        return "us-ft" if "us" in name.replace("_", " ").split() or "survey" in name else "ft"
    return next((unit for unit, factor in _FACTORS.items() if abs(metres / factor - 1) < 5e-7), None)


def _walk(node: _Node) -> Iterator[_Node]:
    """Every node, outermost first, without going into a system that is only a base for another."""
    yield node
    for child in node.children:
        if child.keyword not in {"BASEGEOGCRS", "BASEGEODCRS", "BASEPROJCRS", "TARGETCRS"}:
            yield from _walk(child)


def _parse(text: str) -> _Node | None:
    """Parse the text into nested keywords; None if it is not well formed."""
    top = _Node("", [], [])
    open_nodes = [top]
    last, at = top, 0
    text = text.strip()
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None or len(open_nodes) > 50:
            return None
        at = match.end()
        quoted, word, number, bracket = match.groups()
        if word is not None:
            last = _Node(word.upper(), [], [])
            open_nodes[-1].children.append(last)
        elif bracket in {"[", "("}:
            open_nodes.append(last)
        elif bracket is not None:
            open_nodes.pop()
            if not open_nodes:
                return None
        elif quoted is not None or number is not None:
            open_nodes[-1].values.append(quoted if quoted is not None else number)
    return top.children[0] if len(open_nodes) == 1 and top.children else None
