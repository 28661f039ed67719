"""Names and colours of the point classes of LAS 1.4 (ASPRS)."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from stepfield_app.scenes.arrays import frozen
from stepfield_app.theme import LAYER_COLOURS, rgb

#: The first code that makers give a meaning of their own.
FIRST_OWN = 64
#: Name and colour of the standard codes.
CLASSES: dict[int, tuple[str, str]] = {
    0: ("Never classified", "#9aa0a6"),
    1: ("Unclassified", "#c3c7cc"),
    2: ("Ground", "#b07d48"),
    3: ("Low vegetation", "#a6d96a"),
    4: ("Medium vegetation", "#66bd63"),
    5: ("High vegetation", "#1a9850"),
    6: ("Building", "#e5534b"),
    7: ("Low noise", "#ff5fd2"),
    8: ("Model key point", "#f0e442"),
    9: ("Water", "#4c9aff"),
    10: ("Rail", "#7f6bd6"),
    11: ("Road surface", "#7d828a"),
    12: ("Overlap", "#d9c7a3"),
    13: ("Wire guard", "#f6c85f"),
    14: ("Wire conductor", "#ffb000"),
    15: ("Transmission tower", "#d55e00"),
    16: ("Wire connector", "#b58900"),
    17: ("Bridge deck", "#cc79a7"),
    18: ("High noise", "#ff9ae8"),
    19: ("Overhead structure", "#56b4e9"),
    20: ("Ignored ground", "#8c6239"),
    21: ("Snow", "#f4f7fb"),
    22: ("Temporal exclusion", "#6b4f8f"),
}


def class_name(code: int) -> str:
    """Name of a class; the standard keeps some codes back and leaves the others to the makers."""
    if code in CLASSES:
        return CLASSES[code][0]
    return "Reserved" if code < FIRST_OWN else "User defined"


@cache
def class_palette() -> NDArray[np.uint8]:
    """Colours of all codes, shape (256, 3)."""
    spare = len(LAYER_COLOURS)
    colours = [CLASSES[code][1] if code in CLASSES else LAYER_COLOURS[code % spare] for code in range(256)]
    return frozen(np.array([rgb(colour) for colour in colours], np.uint8))
