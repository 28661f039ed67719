"""Ramps of colours, by what they show."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

Palette = NDArray[np.uint8]

#: Ramps by what they show: names of cmap's catalogue, and where in them to begin and to end. The darkest
#: tenth of batlow would vanish on a dark ground.
RAMPS = {
    "height": ("crameri:batlow", 0.1, 1.0),
    "intensity": ("gray", 0.0, 1.0),
    "error": ("colorbrewer:RdBu_r", 0.0, 1.0),
    "clearance": ("crameri:lajolla", 0.15, 0.9),
    "lost": ("colorbrewer:YlOrRd", 0.1, 1.0),
}


@cache
def ramp(what: str) -> Palette:
    """Return the ramp of :data:`RAMPS` as an array of shape (256, 3), read-only."""
    from cmap import Colormap  # takes long to load, and nothing needs a ramp before a scan is open

    name, start, end = RAMPS[what]
    colours = np.rint(Colormap(name)(np.linspace(start, end, 256))[:, :3] * 255).astype(np.uint8)
    colours.flags.writeable = False
    return colours
