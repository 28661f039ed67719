"""Numbers as the window writes them: grouped in threes, a true minus, short, with their unit."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

#: Parts groups of digits; a line never breaks there.
_GROUP = "\N{NARROW NO-BREAK SPACE}"
_MINUS = "\N{MINUS SIGN}"
#: What stands for a number nobody knows.
UNKNOWN = "–"
_STEPS = ((1e9, "G"), (1e6, "M"), (1e3, "k"))

#: Options of the command that a warning of the core advises, and where the window has them.
_OPTIONS = (
    (re.compile(r"try --up=-(\w)"), f"choose “{_MINUS}\\1 is up” under Cleaning"),
    (re.compile(r"try --up=(\w)"), r"choose “\1 is up” under Cleaning"),
    (re.compile(r"say so with --unit"), "choose it under Cleaning"),
)


def advice(warning: str) -> str:
    """Say a warning of the core as a sentence that speaks of the window, not of options of the command."""
    for option, place in _OPTIONS:
        warning = option.sub(place, warning)
    return f"{warning[:1].upper()}{warning[1:]}."


def grouped(number: int) -> str:
    """Return a whole number with its digits in threes: 12 431."""
    return f"{number:,}".replace(",", _GROUP)


def counted(number: int, thing: str) -> str:
    """Return a number with the word for one or several of a thing: 3 layers."""
    return f"{grouped(number)} {thing}" if number == 1 else f"{grouped(number)} {thing}s"


def short(number: float) -> str:
    """Return a number in three figures: 10.0 M, 431."""
    return _stepped(number, _STEPS, "")


def file_size(count: int) -> str:
    """Return a number of bytes in three figures: 1.20 MB."""
    return _stepped(count, tuple((step, f"{letter}B") for step, letter in _STEPS), "bytes")


def duration(seconds: float) -> str:
    """Return a time in three figures: 38 ms, 1.25 s."""
    return f"{1000 * seconds:.0f} ms" if seconds < 0.9995 else f"{_three_figures(seconds)} s"


def number(value: float, digits: int = 0) -> str:
    """Write a number with ``digits`` after the point, never with an exponent."""
    if not math.isfinite(value):
        return UNKNOWN
    text = f"{value:,.{digits}f}".replace(",", _GROUP).replace("-", _MINUS)
    return text.removeprefix(_MINUS) if not text.strip(f"{_MINUS}0.{_GROUP}") else text


def metres(value: float, digits: int = 2) -> str:
    """Write a length or an elevation with its unit."""
    return f"{number(value, digits)} m" if math.isfinite(value) else UNKNOWN


def distance(value: float) -> str:
    """Write a small length in a unit that suits it: 4.7 mm, 1.2 cm, 1.58 m."""
    if not math.isfinite(value):
        return UNKNOWN
    if abs(value) < 0.00995:
        return f"{number(1000 * value, 1)} mm"
    return f"{number(100 * value, 1)} cm" if abs(value) < 0.9995 else metres(value)


def share(value: float) -> str:
    """Write a share as per cent, never as a round hundred that it is not: 99.1 %."""
    digits = 1 if value < 0.9995 or value == 1 else 2 if value < 0.99995 else 3
    return f"{number(100 * min(value, 0.99999 if value < 1 else 1), digits)} %"


def area(value: float) -> str:
    """Write an area in square metres."""
    return f"{number(value, 0 if value >= 100 else 2)} m²"


def reading(mode: str, value: float, names: Sequence[str] = ()) -> str:
    """Say what an overlay of the map shows at a place; nothing where it shows nothing."""
    if not math.isfinite(value):
        return ""
    if names:
        return names[int(value)]
    if mode == "error":
        return f"scan {distance(abs(value))} {'above' if value > 0 else 'below'}"
    words = {"gaps": "gap of {}", "clearance": "{} of room", "lost": "{} not drawn"}
    return words[mode].format(f"{number(value)} %" if mode == "lost" else distance(value))


def digits_for(step: float) -> int:
    """Digits after the point that tell multiples of ``step`` apart."""
    return max(0, math.ceil(-math.log10(step) - 1e-9)) if step > 0 else 0


def round_step(least: float) -> float:
    """Smallest of 1, 2 or 5 times a power of ten that is at least ``least``."""
    unit = 10.0 ** math.floor(math.log10(least))
    return next(unit * factor for factor in (1, 2, 5, 10) if unit * factor >= least * (1 - 1e-9))


def _stepped(number: float, steps: tuple[tuple[float, str], ...], plain: str) -> str:
    for step, unit in steps:
        if number >= step:
            return f"{_three_figures(number / step)} {unit}"
    return f"{number:.0f} {plain}".rstrip()


def _three_figures(value: float) -> str:
    return f"{value:.2f}" if value < 9.995 else f"{value:.1f}" if value < 99.95 else f"{value:.0f}"
