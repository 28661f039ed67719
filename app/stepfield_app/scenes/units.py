"""Lengths as people write them, and round numbers for grids and scale bars."""

from __future__ import annotations

import math

#: Metres in a unit, from the largest; a length is written in the first that is not larger.
_UNITS = ((1000.0, "km"), (1.0, "m"), (0.01, "cm"), (0.001, "mm"))
#: Pixels of the longest scale bar; the shortest is 2.5 times shorter, as round numbers go 1, 2, 5.
LONGEST_BAR = 160.0


def format_length(metres: float, digits: int = 3) -> str:
    """Write a length with the unit that suits it: 3.2 mm, 45 cm, 12.4 m, 1.35 km.

    Parameters
    ----------
    metres : float
        NaN and infinities are written as a dash.
    digits : int
        Significant ones; zeros at the end are left out, whole numbers are never cut.
    """
    if not math.isfinite(metres):
        return "–"
    rounded = _significant(metres, digits)  # before the unit is chosen, as 99.99 cm is 1 m
    if not rounded:
        return "0 m"
    size, unit = next((pair for pair in _UNITS if abs(rounded) >= pair[0] * (1 - 1e-9)), _UNITS[-1])
    return f"{_plain(rounded / size, digits)} {unit}"


def nice(value: float) -> float:
    """Greatest of 1, 2, 5 times a power of ten that is no greater than ``value`` (above zero)."""
    power = 10.0 ** math.floor(math.log10(value) + 1e-12)
    step = next(step for step in (5, 2, 1) if value >= step * power * (1 - 1e-9))
    # Dividing by whole powers keeps 0.1 from becoming 0.10000000000000002.
    return step * power if power >= 1 else step / round(1 / power)


def nice_step(span: float, most: int = 20) -> float:
    """Smallest round step that divides ``span`` into no more than ``most`` parts; at least 0.4 ``most``."""
    if not (math.isfinite(span) and span > 0):
        return 1.0
    step = nice(span / most)
    return step if step >= span / most * (1 - 1e-9) else nice(2.5 * step)


def scale_bar(metres_per_pixel: float) -> tuple[float, float, str]:
    """Return the length of a scale bar in metres and in pixels (64 to 160), and its label."""
    metres = nice(LONGEST_BAR * metres_per_pixel)
    return metres, metres / metres_per_pixel, format_length(metres)


def _significant(value: float, digits: int) -> float:
    if not value:
        return 0.0
    return round(value, digits - 1 - math.floor(math.log10(abs(value))))


def _plain(value: float, digits: int) -> str:
    places = max(0, digits - 1 - math.floor(math.log10(abs(value)) + 1e-9))
    text = f"{value:.{places}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text
