"""Palettes of 256 colours, and which of their rows stand for a layer."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from stepfield.project import LayerStyle
from stepfield_app.scenes.arrays import frozen
from stepfield_app.theme import UNASSIGNED_COLOUR, layer_colour, rgb

Palette = NDArray[np.uint8]

#: Row of a layer palette for pillars in no layer.
UNASSIGNED_CODE = 254


def layer_colours(count: int, styles: Iterable[LayerStyle] = ()) -> Palette:
    """Colours of ``count`` layers, the operator's own where chosen, and of Unassigned in the last row.

    Returns
    -------
    ndarray of shape (count + 1, 3), uint8
        So that row -1 is the colour of layer -1.
    """
    chosen = {style.index: style.color for style in styles if style.color}
    colours = [rgb(chosen.get(index, layer_colour(index))) for index in range(count)]
    return frozen(np.array([*colours, rgb(UNASSIGNED_COLOUR)], np.uint8))


def layer_codes(layer: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Rows of :func:`layer_palette` of layer numbers; layers beyond the palette share its last colour."""
    return np.where(layer < 0, UNASSIGNED_CODE, np.minimum(layer, UNASSIGNED_CODE - 1)).astype(np.uint8)


def layer_palette(colours: Palette) -> Palette:
    """Spread the colours of layers, Unassigned last, over a palette of 256."""
    palette = np.empty((256, 3), np.uint8)
    palette[:] = colours[-1]
    shown = min(len(colours) - 1, UNASSIGNED_CODE)
    palette[:shown] = colours[:shown]
    return frozen(palette)


def plain_palette(colour: tuple[int, int, int]) -> Palette:
    """Return a palette of one colour."""
    return frozen(np.tile(np.array(colour, np.uint8), (256, 1)))
