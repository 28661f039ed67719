"""The style sheet of the window, made from the tokens of a theme: flat, dense, on a grid of 8 pixels."""

from __future__ import annotations

from pathlib import Path
from string import Template

import stepfield_resources
from stepfield_app.theme import DARK, Theme, rgb

#: The marks on controls, as paths in a square of 10 units.
_MARKS = {
    "down": "M2 3.5 L5 6.5 L8 3.5",
    "up": "M2 6.5 L5 3.5 L8 6.5",
    "right": "M3.5 2 L6.5 5 L3.5 8",
    "check": "M1.5 5.2 L4 7.7 L8.5 2.6",
    "part": "M2 5 L8 5",
    "dot": "M4.9 5 L5.1 5",
}
_STROKES = {"dot": 5.0}
_COLOURS = {"check": "on_accent", "part": "on_accent", "dot": "on_accent"}


def style_sheet(theme: Theme, folder: Path) -> str:
    """Return the style sheet of a theme; its few marks are written to ``folder`` as SVG."""
    tokens = _tokens(theme)
    marks = {f"mark_{name}": _write_mark(name, tokens, folder) for name in _MARKS}
    return Template(stepfield_resources.style_sheet()).substitute(tokens | marks)


def mixed(colour: str, other: str, share: float) -> str:
    """Return a colour with a share, 0 to 1, of another one in it."""
    pairs = zip(rgb(colour), rgb(other), strict=True)
    return "#" + "".join(f"{round(a + (b - a) * share):02x}" for a, b in pairs)


def on_accent(theme: Theme) -> str:
    """Return the colour of text on the accent: black or white, whichever reads better."""
    red, green, blue = rgb(theme.accent)
    return "#000000" if 0.299 * red + 0.587 * green + 0.114 * blue > 140 else "#ffffff"


def _tokens(theme: Theme) -> dict[str, str]:
    return {
        "window": theme.window,
        "panel": theme.panel,
        "field": theme.field,
        "line": theme.line,
        "text": theme.text,
        "muted": theme.muted,
        "accent": theme.accent,
        "error": theme.error,
        "warning": theme.warning,
        "on_accent": on_accent(theme),
        "hover": mixed(theme.panel, theme.text, 0.08),
        "pressed": mixed(theme.panel, theme.text, 0.16),
        "faint": mixed(theme.panel, theme.text, 0.04),
        "edge": mixed(theme.line, theme.text, 0.16),
        "handle": mixed(theme.panel, theme.text, 0.28),
        "knob": mixed(theme.muted, theme.text, 0.6 if theme is DARK else 0.2),
        "disabled": mixed(theme.muted, theme.panel, 0.45),
        "chosen": mixed(theme.panel, theme.accent, 0.28),
        "accent_hover": mixed(theme.accent, theme.text, 0.15),
        "small": "12px",
    }


def _write_mark(name: str, tokens: dict[str, str], folder: Path) -> str:
    colour = tokens[_COLOURS.get(name, "muted")]
    path = folder / f"{name}-{colour[1:]}.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10" width="10" height="10">'
        f'<path d="{_MARKS[name]}" fill="none" stroke="{colour}" stroke-width="{_STROKES.get(name, 1.5)}" '
        'stroke-linecap="round" stroke-linejoin="round"/></svg>',
        encoding="ascii",
    )
    return path.as_posix()
