"""The layers as surfaces: over exactly their pillars, as a simulator draws them (paper 6), or as pillars."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield.surface import Mesh, as_edges, as_simulator
from stepfield_app.ramps import ramp
from stepfield_app.render.scene import Triangles
from stepfield_app.scenes.arrays import frozen, steps
from stepfield_app.scenes.blocks import local_span, meshes
from stepfield_app.scenes.paled import on_filled, paled
from stepfield_app.scenes.stacks import own_columns, solids
from stepfield_app.scenes.thinned import pooled, stride_for, with_filled

Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]
Way = Literal["edges", "simulator", "pillars"]
Mode = Literal["layer", "height"]

#: Levels of detail; each has every second row and column of the one before.
LEVELS = 3
#: Where the light comes from: high in the north-west.
LIGHT = np.array([-0.46, 0.38, 0.80], np.float32)
#: Light that reaches every face.
AMBIENT = 0.38
#: Pixels above which the finest level is left out: no screen shows them.
MOST_PIXELS = 1 << 21
#: The same for ``edges``, which has twice the triangles a pixel.
MOST_COVERED = 1 << 20


def surfaces(
    result: Reconstruction,
    origin: Floats,
    colours: Bytes,
    visible: Collection[int],
    way: Way = "edges",
    mode: Mode = "layer",
    most: int | None = None,
    least: int = 1,
    *,
    sampled: bool = False,
) -> tuple[Triangles, ...]:
    """Return the visible layers in levels of detail, the finest first.

    Parameters
    ----------
    result : Reconstruction
    origin : ndarray of shape (3,)
        Scan coordinates, metres.
    colours : ndarray of shape (layers + 1, 3), uint8
        Unassigned last; it has no surface.
    visible : collection of int
    way : str
        ``edges``: exactly the compartments of the pillars. ``simulator``: a vertex a pixel, a quad where
        all four are occupied. Obstacles are solid in both. ``pillars``: blocks from the base plane to
        each pillar's top.
    mode : str
        Colour by ``layer``, or by ``height`` over :func:`~stepfield_app.scenes.blocks.height_range`.
    most : int
        Pixels of the finest level, about; :data:`MOST_PIXELS` or :data:`MOST_COVERED`.
    least : int
        Every so manieth row and column at most.
    sampled : bool
        Draw ``edges`` from every so manieth compartment instead of joining them: quicker, with more holes.
    """
    span = local_span(result, origin) if mode == "height" else None
    layers = [layer for layer in result.layers if layer.index in visible]
    if way == "pillars":
        own = [meshes(own_columns(result, layer, origin), colours, span, LEVELS) for layer in layers]
        return tuple(merged([levels[min(i, len(levels) - 1)] for levels in own]) for i in range(LEVELS))
    walls = [
        meshes(solids(result, layer, origin), colours, span, LEVELS) for layer in layers if layer.is_obstacles
    ]
    shown = [layer for layer in layers if not layer.is_obstacles]
    most = (MOST_COVERED if way == "edges" else MOST_PIXELS) if most is None else most
    finest = max(least, stride_for(sum(len(layer.pillars) for layer in shown), most))
    corner = origin - [0, 0, result.field.compartments.lowest]
    indices = [layer.index for layer in shown]
    made = _covering(result, finest, sampled) if way == "edges" else _simulated(result, indices, finest)
    return tuple(
        merged(
            [_drawn(each[index], result, index, corner, colours[index], span) for index in indices]
            + [levels[min(level, len(levels) - 1)] for levels in walls]
        )
        for level, each in enumerate(made)
    )


def _simulated(result: Reconstruction, indices: Sequence[int], finest: int) -> Iterator[Mapping[int, Mesh]]:
    """Make triangles of layers in levels of detail, at elevations above the lowest point."""
    for level in range(LEVELS):
        parts = with_filled(result, indices, finest << level)
        yield {
            index: as_simulator(part.grid, part.compartment, part.elevation)
            for index, part in zip(indices, parts, strict=True)
        }


def _covering(result: Reconstruction, finest: int, sampled: bool) -> Iterator[Mapping[int, Mesh]]:
    """Cover the ground of all layers in levels of detail, at elevations above the lowest point.

    Hidden layers take part: what is shown must not change its shape when others are hidden.
    """
    indices = [layer.index for layer in result.layers if not layer.is_obstacles]
    parts = with_filled(result, indices, finest if sampled else 1)
    if finest > 1 and not sampled:
        parts = [pooled(part, finest) for part in parts]
    # Places further apart may differ by as much more and still be one slope.
    step = finest * float(result.parameters.link_step)
    for level in range(LEVELS):
        grounds = [(part.compartment, part.elevation) for part in parts]
        made = as_edges(parts[0].grid, grounds, step * (1 << level)) if parts else []
        yield dict(zip(indices, made, strict=True))
        if level < LEVELS - 1:
            parts = [pooled(part, 2) for part in parts]


def merged(parts: Collection[Triangles]) -> Triangles:
    """Make one mesh of several, in order."""
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    empty = Triangles(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32), np.zeros((0, 3), np.uint8))
    shifted = [part.triangles + np.int32(start) for part, start in zip(parts, starts, strict=False)]
    return Triangles(
        frozen(np.concatenate([empty.vertices, *(part.vertices for part in parts)])),
        frozen(np.concatenate([empty.triangles, *shifted])),
        frozen(np.concatenate([empty.colours, *(part.colours for part in parts)])),
    )


def _drawn(
    mesh: Mesh,
    result: Reconstruction,
    index: int,
    corner: Floats,
    colour: Bytes,
    span: tuple[float, float] | None,
) -> Triangles:
    """Colour a layer; ``corner`` is the origin, at elevations above the lowest point."""
    mesh, layer = _creased(mesh), result.layers[index]
    vertices = (mesh.vertices - corner).astype(np.float32)
    triangles = mesh.triangles.astype(np.int32)
    base = colour if span is None else ramp("height")[steps(vertices[:, 2], *span, 256)]
    drawn = shaded(vertices, triangles, base)
    if not len(layer.filled.compartment):
        return drawn
    middles = mesh.vertices[mesh.triangles].mean(axis=1)[:, :2]
    return _with_paled(drawn, on_filled(result, layer, middles) & ~_upright(mesh))


def _with_paled(drawn: Triangles, chosen: Flags) -> Triangles:
    """Give triangles over what was filled its colour, and vertices of their own, so that it ends there."""
    own = drawn.triangles[chosen].ravel()
    triangles = drawn.triangles.copy()
    triangles[chosen] = np.arange(len(own), dtype=np.int32).reshape(-1, 3) + np.int32(len(drawn.vertices))
    return Triangles(
        frozen(np.concatenate([drawn.vertices, drawn.vertices[own]])),
        frozen(triangles),
        frozen(np.concatenate([drawn.colours, paled(drawn.colours[own])])),
    )


def shaded(
    vertices: Singles, triangles: NDArray[np.int32], colours: Bytes, *, both_sides: bool = False
) -> Triangles:
    """Shade a surface, shape (V, 3), of one colour or one a vertex; lit from its own side or from both."""
    light = _light(vertices, triangles, both_sides=both_sides)
    lit = np.rint(colours * light[:, np.newaxis]).astype(np.uint8).reshape(-1, 3)
    return Triangles(frozen(vertices), frozen(triangles), frozen(lit))


def _creased(mesh: Mesh) -> Mesh:
    """Give upright triangles vertices of their own, so that light does not bleed around a step."""
    is_upright = _upright(mesh)
    own = mesh.triangles[is_upright].ravel()
    if not len(own):
        return mesh
    number = np.arange(len(own)).reshape(-1, 3) + len(mesh.vertices)
    return Mesh(
        np.concatenate([mesh.vertices, mesh.vertices[own]]),
        np.concatenate([mesh.triangles[~is_upright], number]),
    )


def _upright(mesh: Mesh) -> Flags:
    """Tell which triangles are upright."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i], :2] for i in range(3))
    across, along = b - a, c - a
    upright: Flags = np.abs(across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0]) < 1e-12
    return upright


def _light(vertices: Singles, triangles: NDArray[np.int32], *, both_sides: bool) -> Singles:
    """Light at each vertex by the average of its faces' normals, shape (V,), at most 1."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    faces = np.cross(b - a, c - a)
    normals = np.empty_like(vertices)
    for i in range(3):
        weights = np.repeat(faces[:, i], 3)
        normals[:, i] = np.bincount(triangles.ravel(), weights, minlength=len(vertices))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    towards = normals @ (LIGHT / np.linalg.norm(LIGHT))
    if both_sides:
        towards = np.abs(towards)
    light: Singles = np.clip(AMBIENT + (1 - AMBIENT) * towards * 1.12, AMBIENT, 1)
    return light
