"""How points get their colours: by height, intensity, class, layer, their own, or all the same."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield.scan import Scan
from stepfield_app.ramps import ramp
from stepfield_app.scenes import membership
from stepfield_app.scenes.arrays import frozen, in_chunks, robust_range, sample, steps
from stepfield_app.scenes.classes import class_name, class_palette
from stepfield_app.scenes.legend import Colour, Legend
from stepfield_app.scenes.palette import (
    layer_palette,
    plain_palette,
)
from stepfield_app.theme import rgb

Mode = Literal["height", "intensity", "rgb", "class", "layer", "single"]
Codes = NDArray[np.uint8]

#: Points that tell the range of heights and intensities.
SAMPLE = 200_000
#: The attribute of the scan that a mode needs.
_NEEDS = {"rgb": "rgb", "intensity": "intensity", "class": "classification"}
_ORDER: tuple[Mode, ...] = ("height", "layer", "rgb", "intensity", "class", "single")


@dataclass(frozen=True, eq=False)
class Colouring:
    """Colours of all points of a scan.

    Attributes
    ----------
    codes : ndarray of shape (N,) or (N, 3), uint8
        Rows of ``palette``, or colours of their own.
    palette : ndarray of shape (256, 3), uint8, or None
    legend : Legend or None
        None where the colours speak for themselves.
    """

    codes: Codes
    palette: NDArray[np.uint8] | None
    legend: Legend | None = None


def modes(scan: Scan, result: Reconstruction | None = None) -> tuple[Mode, ...]:
    """Return the modes that have something to show; layers only once there is a result."""
    present = {mode for mode in _ORDER if _NEEDS.get(mode, "") in {"", *scan.attributes}}
    return tuple(mode for mode in _ORDER if mode in present and (mode != "layer" or result is not None))


def by_height(scan: Scan) -> Colouring:
    """Colour points by elevation, robust against strays; the legend gives scan coordinates."""
    lowest, distance = scan.z.bounds()[0], scan.z.measure()
    low, high = robust_range(distance(sample(len(scan), SAMPLE)))
    codes = np.empty(len(scan), np.uint8)

    def fill(part: slice) -> None:
        codes[part] = steps(distance(part), low, high, 256)

    in_chunks(len(scan), fill)
    legend = Legend("Elevation", "m", ramp("height"), low=lowest + low, high=lowest + high)
    return Colouring(frozen(codes), ramp("height"), legend)


def by_intensity(scan: Scan) -> Colouring:
    """Colour points by the strength of the return, dark to bright."""
    values = scan.attributes["intensity"]
    low, high = robust_range(values[sample(len(values), SAMPLE)])
    codes = np.empty(len(scan), np.uint8)

    def fill(part: slice) -> None:
        codes[part] = steps(values[part], low, high, 256)

    in_chunks(len(scan), fill)
    legend = Legend("Intensity", "", ramp("intensity"), low=low, high=high)
    return Colouring(frozen(codes), ramp("intensity"), legend)


def by_own_colour(scan: Scan) -> Colouring:
    """Give points the colours that the scanner's camera saw."""
    return Colouring(_read_only_view(scan.attributes["rgb"]), None)


def by_class(scan: Scan) -> Colouring:
    """Colour points by their LAS class; the legend names the classes there are."""
    codes, palette = scan.attributes["classification"], class_palette()
    present = np.flatnonzero(np.bincount(codes, minlength=256))
    entries = tuple((_colour(palette[code]), f"{code}  {class_name(int(code))}") for code in present)
    return Colouring(_read_only_view(codes), palette, Legend("Class", entries=entries))


def by_layer(scan: Scan, result: Reconstruction, colours: NDArray[np.uint8]) -> Colouring:
    """Colour points by the layer of their pillar.

    Parameters
    ----------
    scan : Scan
    result : Reconstruction
        Of this scan, or of a part of it.
    colours : ndarray of shape (layers + 1, 3), uint8
        Unassigned last.
    """
    entries = [(_colour(colours[layer.index]), layer.name) for layer in reversed(result.layers)]
    legend = Legend("Layer", entries=(*entries, (_colour(colours[-1]), "Unassigned")))
    return Colouring(membership.point_codes(scan, result), layer_palette(colours), legend)


def single(scan: Scan, colour: Colour) -> Colouring:
    """Give all points one colour."""
    return Colouring(frozen(np.zeros(len(scan), np.uint8)), plain_palette(colour))


def coloured(
    scan: Scan,
    mode: Mode,
    *,
    result: Reconstruction | None = None,
    colours: NDArray[np.uint8] | None = None,
    plain: str = "#9aa0a6",
) -> Colouring:
    """Colour a scan by mode; a mode that has nothing to show falls back to height.

    Parameters
    ----------
    scan : Scan
    mode : str
        See :func:`modes`.
    result, colours
        As in :func:`by_layer`; for the mode ``layer`` only.
    plain : str
        The colour of the mode ``single``, #rrggbb.
    """
    if mode == "single":
        return single(scan, rgb(plain))
    if mode == "layer" and result is not None and colours is not None:
        return by_layer(scan, result, colours)
    by = {"intensity": by_intensity, "rgb": by_own_colour, "class": by_class}
    return by[mode](scan) if mode in by and mode in modes(scan) else by_height(scan)


def _read_only_view(values: NDArray[np.uint8]) -> Codes:
    return frozen(np.ascontiguousarray(values).view())


def _colour(row: NDArray[np.uint8]) -> Colour:
    return int(row[0]), int(row[1]), int(row[2])
