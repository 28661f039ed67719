"""Names and numbers in files of other programs: names come from scans and operators, so may hold anything."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from xml.sax.saxutils import escape

from stepfield.files import one_line
from stepfield.targets.terrain import Terrain

_NOT_A_WORD = re.compile(r"[^A-Za-z0-9]+")
#: Characters that XML 1.0 does not have, not even escaped.
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def in_xml(text: str) -> str:
    """Return text for XML, be it content or an attribute in either kind of quotes."""
    return escape(
        _NOT_XML.sub("\ufffd", text), {'"': "&quot;", "'": "&apos;", "\n": " ", "\r": " ", "\t": " "}
    )


def in_python(text: str) -> str:
    """Return a Python string literal, quotes included, of ASCII alone."""
    return ascii(text)


def as_word(text: str) -> str:
    """Return what a program's identifiers may be made of: letters, digits and underscores of ASCII."""
    return _NOT_A_WORD.sub("_", text).strip("_")[:40]


def number(value: float) -> str:
    """Return a number to a millionth, without an exponent or trailing zeros."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def numbers(values: Iterable[float], parting: str = " ") -> str:
    """Return numbers side by side."""
    return parting.join(map(number, values))


def write_text(path: Path, text: str) -> None:
    """Write a file of text, the same bytes on every system."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text.encode("utf-8", "replace"))


def readme(terrain: Terrain, title: str, steps: str, notes: Sequence[str] = ()) -> str:
    """Return README.txt: what this is, the steps of the import, coordinates, layers, what was not held.

    Parameters
    ----------
    terrain : Terrain
    title : str
    steps : str
        The target's own part, with its numbers filled in.
    notes : sequence of str
    """
    shown = one_line(terrain.name)
    parts = [f"{title}: {shown}\n{'=' * (len(title) + len(shown) + 2)}", steps.strip(), _coordinates(terrain)]
    parts.append("Layers, the lowest first\n" + "\n".join(_layers(terrain)))
    if notes:
        parts.append("Please note\n" + "\n".join(f"- {note}" for note in notes))
    parts.append(f"Made by {one_line(terrain.manifest.generator)} from a stack of height-maps.")
    return "\n\n".join(parts) + "\n"


def _coordinates(terrain: Terrain) -> str:
    x, y, z = terrain.local_origin
    moved = "which is zero: they are the scan's own" if (x, y, z) == (0, 0, 0) else "add it to get the scan's"
    return (
        "Coordinates\n"
        "Metres; x is east, y is north, z is up, unless it says otherwise above.\n"
        f"local_origin = ({numbers((x, y, z), ', ')}) was subtracted from the scan's coordinates,\n"
        f"{moved}.\n"
        f"{terrain.columns} x {terrain.rows} samples (columns x rows), {number(terrain.cell_size)} m apart,\n"
        f"from x = {number(terrain.west)} to {number(terrain.east)} and y = {number(terrain.south)} to "
        f"{number(terrain.north)}; a sample is the middle of its compartment.\n"
        f"The base plane lies at z = {number(terrain.base_elevation)}."
    )


def _layers(terrain: Terrain) -> Iterable[str]:
    for layer, entry in zip(terrain.layers, terrain.manifest.layers, strict=True):
        there = layer.elevations[layer.occupied]
        span = f"z = {number(there.min())} to {number(there.max())}" if there.size else "empty"
        holes = terrain.columns * terrain.rows - entry.pillars - entry.filled
        filled = f" and {entry.filled} where holes were filled" if entry.filled else ""
        yield f"{layer.label}  {one_line(layer.name)}: {span}, {entry.pillars} samples{filled}, {holes} holes"
