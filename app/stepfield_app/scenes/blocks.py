"""The pillars of a step-field as triangles (paper 5.1), shaded so that blocks read as blocks.

Only faces that can be seen are made. The order of a mesh: the top of every block, in the order of its
:class:`~stepfield_app.scenes.stacks.Stack`; the undersides of slabs; then the walls that face north, east,
south and west. Every face has four vertices of its own and two triangles.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield_app.ramps import ramp
from stepfield_app.render.scene import Triangles
from stepfield_app.scenes.arrays import robust_range, sample, steps
from stepfield_app.scenes.faces import Faces, Patches, joined
from stepfield_app.scenes.neighbours import (
    EAST,
    NORTH,
    NORTH_EAST,
    NORTH_WEST,
    SIDES,
    SOUTH,
    SOUTH_EAST,
    SOUTH_WEST,
    WEST,
    Surroundings,
)
from stepfield_app.scenes.stacks import Stack, coarser, step_field

Floats = NDArray[np.float64]
Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]
Mode = Literal["layer", "height"]

#: Levels of detail; each joins two by two compartments of the one before.
LEVELS = 4
#: More blocks than this are joined before they are drawn: no screen has the pixels for them.
MOST_BLOCKS = 1 << 20
#: Pillars that tell the range of heights.
SAMPLE = 200_000
#: Light on a wall that faces north, east, south, west; on an underside; a top has all of it.
WALL_LIGHT = (0.70, 0.80, 0.84, 0.62)
UNDERSIDE_LIGHT = 0.48
#: What every second compartment loses, so that level ground still shows its blocks.
CHECKER = 0.045
#: What a wall loses on all sides, so that it is told from ground.
WALL = 0.3
#: Light a corner of a top loses to each higher neighbour beside it and across the corner.
BESIDE, ACROSS = 0.17, 0.10
#: Light a wall has left at its foot, standing on a neighbour or free.
FOOT, FREE_FOOT = 0.72, 0.86
#: The neighbours at each corner of a top: beside it twice, then across.
_CORNERS = (
    (SOUTH, WEST, SOUTH_WEST),
    (SOUTH, EAST, SOUTH_EAST),
    (NORTH, EAST, NORTH_EAST),
    (NORTH, WEST, NORTH_WEST),
)


def blocks(
    result: Reconstruction,
    origin: Floats,
    colours: Bytes,
    visible: Collection[int],
    levels: int = LEVELS,
    mode: Mode = "layer",
    stride: int = 1,
    joined: int = 0,
) -> tuple[Triangles, ...]:
    """Return the step-field in levels of detail, the finest first.

    Parameters
    ----------
    result : Reconstruction
    origin : ndarray of shape (3,)
        Scan coordinates, metres.
    colours : ndarray of shape (layers + 1, 3), uint8
        Unassigned last.
    visible : collection of int
        Layers to show, -1 for Unassigned.
    levels : int
    mode : str
        Colour by ``layer``, or by ``height`` over :func:`height_range`.
    stride : int
        Every how manieth row and column of compartments is drawn.
    joined : int
        How often compartments are joined two by two before the finest level.
    """
    span = local_span(result, origin) if mode == "height" else None
    stack = step_field(result, origin, visible, stride)
    for _ in range(joined):
        stack = coarser(stack)
    return meshes(stack, colours, span, levels)


def height_range(result: Reconstruction) -> tuple[float, float]:
    """Elevations that the ends of the height ramp stand for, scan coordinates, metres."""
    part = sample(len(result.field), SAMPLE)
    low, high = robust_range(result.field.elevation[part][result.layering.layer[part] >= 0])
    lowest = result.field.compartments.lowest
    return lowest + low, lowest + high


def local_span(result: Reconstruction, origin: Floats) -> tuple[float, float]:
    """Return :func:`height_range` in local coordinates."""
    low, high = height_range(result)
    return low - origin[2], high - origin[2]


def meshes(
    stack: Stack, colours: Bytes, span: tuple[float, float] | None, levels: int, most: int = MOST_BLOCKS
) -> tuple[Triangles, ...]:
    """Turn blocks into triangles, in levels of detail.

    Parameters
    ----------
    stack : Stack
    colours : ndarray of shape (layers + 1, 3), uint8
    span : tuple of float or None
        Local elevations the height ramp spans; None colours by layer.
    levels, most : int
    """
    while len(stack) > most:
        stack = coarser(stack)
    made = [mesh(stack, colours, span)]
    for _ in range(levels - 1):
        if max(stack.lattice.shape) <= 1:
            break
        stack = coarser(stack)
        made.append(mesh(stack, colours, span))
    return tuple(made)


def mesh(stack: Stack, colours: Bytes, span: tuple[float, float] | None) -> Triangles:
    """Turn blocks into triangles; see the module for their order. Walls are darker."""
    colour = colours[stack.layer] if span is None else ramp("height")[steps(stack.top, *span, 256)]
    faces, around, light = Faces.of(stack, colour), Surroundings(stack), _checker(stack)
    tops = faces.tops(_top_light(around) * light[:, np.newaxis])
    undersides = faces.undersides(~stack.standing, UNDERSIDE_LIGHT)
    return joined([tops, undersides, *(_walls(faces, around, light, side) for side in range(len(SIDES)))])


def _checker(stack: Stack) -> Singles:
    row, column = np.divmod(stack.compartment, stack.lattice.shape[1])
    light: Singles = np.array([1, 1 - CHECKER], np.float32)[(row + column) % 2]
    light[stack.vertical] *= np.float32(1 - WALL)
    return light


def _top_light(around: Surroundings) -> Singles:
    """Light at the corners of each top, shape (n, 4): less where neighbours stand higher."""
    shadow = around.shadow()
    light = np.empty((shadow.shape[1], 4), np.float32)
    for i, (one, other, corner) in enumerate(_CORNERS):
        light[:, i] = 1 - BESIDE * (shadow[one] + shadow[other]) - ACROSS * shadow[corner]
    return light


def _walls(faces: Faces, around: Surroundings, light: Singles, side: int) -> Patches:
    """Return the walls on a side, darker towards the foot."""
    foot, head = around.wall(side)
    lost = np.where(foot > around.bottom, 1 - FOOT, 1 - FREE_FOOT).astype(np.float32)
    lost *= np.clip((head - foot) / np.float32(around.cell_size), 0, 1)
    light = light * np.float32(WALL_LIGHT[side])
    return faces.walls(side, foot, head, np.column_stack([light * (1 - lost), light]))
