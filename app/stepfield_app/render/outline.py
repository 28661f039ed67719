"""Outlines painted over a picture that has been drawn: light where they are seen, faint dots where hidden.

The depth of the picture tells what is seen, so a new outline needs no new picture, and lines follow the
camera in the process that draws.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield_app.render.camera import Camera, Size
from stepfield_app.render.scene import Bytes, Singles
from stepfield_app.render.strokes import Strokes, strokes
from stepfield_app.theme import HALO, OUTLINES, rgb

Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]
Words = NDArray[np.uint32]

#: What outlines go round, in the order they are painted: a place that is pointed out, what is selected.
PLACE, SELECTION = KINDS = ("place", "selection")
#: Thickness of their light lines, pixels: what is pointed out is often small.
THICK = {PLACE: 2, SELECTION: 1}
#: How much farther than the picture a line may be and still be seen, as a share of its depth.
TOLERANCE = 2e-3
#: Hidden lines show one light and one dark dot in so many pixels; crowds of them in so many both ways.
PERIOD, SPARSE = 5, 8
#: Side in pixels of the squares in which lines count as crowded, and so many of their pixels that they do: a
#: line and a corner are not, but from afar the outlines of many small things would hide what they go round.
BLOCK, CROWDED = 4, 9
#: Three channels, each without the bit that halving shifts into it from the next.
_HALVES = np.uint32(0x7F7F7F)


@dataclass(frozen=True, eq=False)
class Outline:
    """Lines to paint over a picture.

    Attributes
    ----------
    segments : ndarray of shape (n, 2, 3), float32
        Ends in local coordinates, metres.
    slack : float
        How far behind what is drawn a line still counts as seen, metres: where a view draws not the blocks
        that the lines go round but points or a surface near them.
    """

    segments: Singles
    slack: float = 0.0


def paint(pixels: Bytes, depth: Singles | None, camera: Camera, outline: Outline, kind: str) -> None:
    """Paint an outline into a picture.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 4), uint8
        Blue, green, red and 255; painted over.
    depth : ndarray of shape (height, width), float32, or None
        Metres, 0 where nothing is drawn; without it everything is seen.
    camera : Camera
        What the picture was drawn with.
    outline : Outline
    kind : str
        One of :data:`KINDS`.
    """
    height, width = pixels.shape[:2]
    lines = strokes(outline.segments, camera, (width, height))
    seen = _seen(lines, depth, width, outline.slack)
    words: Words = pixels.reshape(-1, 4).view(np.uint32).reshape(-1)
    light, dark = _word(OUTLINES[kind]), _word(HALO)
    _dot(words, lines.of(~seen), (width, height), light, dark)
    core, crowd = _parted(lines.pixel[seen], (width, height))
    _blend(words, _spread(core, range(-1, THICK[kind] + 1), (width, height)), dark)
    _blend(words, crowd, light)
    words[_spread(core, range(THICK[kind]), (width, height))] = light


def _seen(lines: Strokes, depth: Singles | None, width: int, slack: float) -> Mask:
    """Tell which samples are in front of what is drawn in their pixel or in one beside it."""
    if depth is None:
        return np.ones(len(lines.pixel), bool)
    flat = np.ascontiguousarray(depth).reshape(-1)
    nearest: Singles = np.abs(lines.depth)
    nearest *= np.float32(-TOLERANCE)
    nearest += lines.depth - np.float32(slack)
    seen = _in_front(flat, lines.pixel, nearest)
    for step in (1, -1, width, -width):  # an edge is often drawn beside the pixel of its block
        rest = np.flatnonzero(~seen)
        seen[rest] = _in_front(flat, lines.pixel[rest] + step, nearest[rest])
    return seen


def _in_front(depth: Singles, pixel: Indices, nearest: Singles) -> Mask:
    drawn = depth[pixel]
    in_front: Mask = (nearest <= drawn) | (drawn == 0)
    return in_front


def _dot(words: Words, lines: Strokes, size: Size, light: np.uint32, dark: np.uint32) -> None:
    """Dot hidden lines, light and dark, so that they show a little on every colour; few of a crowd."""
    phase = lines.along % PERIOD
    apart, crowd = _parted(lines.pixel, size)
    is_apart = np.zeros(size[0] * size[1], bool)
    is_apart[apart] = True
    row, column = np.divmod(crowd, size[0])
    sparse = crowd[(row % SPARSE == 0) & (column % SPARSE == 0)]
    for dots, colour in ((lines.pixel[phase == 1], dark), (lines.pixel[phase == 0], light)):
        _blend(words, dots[is_apart[dots]], colour)
    _blend(words, sparse + 1, dark)
    _blend(words, sparse, light)


def _parted(pixel: Indices, size: Size) -> tuple[Indices, Indices]:
    """Part pixels, each once, into those of lines and those of a crowd of lines."""
    is_line = np.zeros(size[0] * size[1], bool)
    is_line[pixel] = True
    pixel = np.flatnonzero(is_line)
    row, column = np.divmod(pixel, size[0])
    block = (row // BLOCK) * (size[0] // BLOCK + 1) + column // BLOCK
    is_crowded = np.bincount(block)[block] >= CROWDED if len(block) else np.zeros(0, bool)
    return pixel[~is_crowded], pixel[is_crowded]


def _spread(core: Indices, steps: range, size: Size) -> Indices:
    """Pixels at all these steps from others, down and to the right, each once."""
    width, height = size
    near = np.zeros(width * height, bool)
    for down in steps:
        for right in steps:
            near[core + (down * width + right)] = True
    return np.flatnonzero(near)


def _blend(words: Words, pixel: Indices, colour: np.uint32) -> None:
    """Mix pixels half and half with a colour."""
    half = (words[pixel] >> np.uint32(1)) & _HALVES
    words[pixel] = np.uint32(0xFF000000) | (half + ((colour >> np.uint32(1)) & _HALVES))


def _word(colour: str) -> np.uint32:
    """Blue, green, red and 255 as they lie in the memory of a little-endian machine."""
    red, green, blue = rgb(colour)
    return np.uint32(0xFF000000 | red << 16 | green << 8 | blue)
