"""Named colours of both themes, and colours of layers: beside the ramps, all that the window has."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Theme:
    """The colours of one theme, as #rrggbb."""

    name: str
    window: str
    panel: str
    field: str
    line: str
    text: str
    muted: str
    accent: str
    warning: str
    error: str


DARK = Theme(
    "dark", "#1e1f22", "#26282c", "#2f3237", "#3a3d42", "#e6e6e6", "#9aa0a6", "#4c9aff", "#e5a50a", "#e5534b"
)
LIGHT = Theme(
    "light",
    "#f5f6f8",
    "#ffffff",
    "#ffffff",
    "#d9dce1",
    "#1f2328",
    "#656d76",
    "#0b6bcb",
    "#9a6700",
    "#cf222e",
)

#: Okabe and Ito's colours (without black: it vanishes on a dark ground), then more that stay apart from them.
LAYER_COLOURS = (
    "#0072b2",
    "#e69f00",
    "#009e73",
    "#cc79a7",
    "#56b4e9",
    "#d55e00",
    "#f0e442",
    "#8c6bb1",
    "#7fbf7b",
    "#b15928",
    "#5ab4ac",
    "#de77ae",
    "#a6bddb",
    "#bf812d",
    "#78c679",
    "#9e9ac8",
)
UNASSIGNED_COLOUR = "#8a8f98"

#: What a mesh stands in for, where height-maps fail: unlike any layer, on both grounds.
COMPLEX_COLOUR = "#b4e61e"
#: Hatches walls on the map: in no ramp of heights, and not what a slope in shadow looks like.
WALL_COLOUR = "#f03c32"
#: Heights that nobody measured, on the map: far from every ramp of heights, whatever the light.
FILLED_COLOUR = "#96e6ff"

#: Outlines show on every colour and in both themes: light ones, of a selection or of a place that is pointed
#: out, with something dark around them.
OUTLINES = {"selection": "#ffffff", "place": "#ff66f5"}
HALO = "#101216"

#: Colours of what is wrong with a layer, over its relief in gray.
OVERLAYS = {"hole": "#ffb000", "filled": "#4fb3ff"}


def layer_colour(index: int) -> str:
    """Colour of a layer the operator has given none; the same number always has the same colour."""
    return UNASSIGNED_COLOUR if index < 0 else LAYER_COLOURS[index % len(LAYER_COLOURS)]


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255, of #rrggbb."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
