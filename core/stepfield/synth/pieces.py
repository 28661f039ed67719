"""Pieces of buildings, whole and broken, that several scenes are put together from."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stepfield.synth.geometry import Assembly, Floats, Mesh, Pose, merged, rotation, turned
from stepfield.synth.primitives import Plane, box
from stepfield.synth.sheets import Sheet, prism

#: About how far apart the corners of a broken edge are, metres.
_BREAK = 0.45


def flight(steps: int, rise: float, tread: float, width: float, *, soffit_from: int = 0) -> Assembly:
    """Build a flight of stairs climbing towards +x from its own origin, the width centred on y = 0.

    Parameters
    ----------
    steps : int
        The last one is level with the floor above.
    rise, tread, width : float
        Height, length and breadth of a step, metres.
    soffit_from : int
        Step where the sloping underside begins, so that it need not dip into the floor below.
    """
    parts: list[tuple[Plane, Pose]] = []
    for step in range(steps):
        x, z = step * tread, step * rise
        parts.append((Plane(rise, width), Pose.at(x, 0, z + rise / 2, pitch=-90)))
        parts.append((Plane(tread, width), Pose.at(x + tread / 2, 0, z + rise)))
    hidden, length = (steps - soffit_from), float(np.hypot(rise, tread))
    middle = (steps + soffit_from) / 2
    slope = float(np.degrees(np.arctan2(rise, tread)))
    under = Pose.at(middle * tread, 0, middle * rise - 0.15, roll=180, pitch=-slope)
    return Assembly([*parts, (Plane(hidden * length, width), under)])


def beam(length: float, side: float) -> Assembly:
    """Build a beam or column along its own x axis, of square section, both in metres."""
    return box(length, side, side)


def broken_slab(
    width: float,
    depth: float,
    thickness: float,
    broken: str,
    rng: np.random.Generator,
    depth_of_break: float = 0.5,
) -> Sheet:
    """Build a slab, centred, whose edges named in ``broken`` (of "snwe") are ragged; metres."""
    x, y = width / 2, depth / 2
    corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
    inward = {"s": (0, 1), "e": (-1, 0), "n": (0, -1), "w": (1, 0)}
    outline = []
    for start, stop, (side, normal) in zip(corners, corners[1:] + corners[:1], inward.items(), strict=True):
        count = max(1, round(float(np.hypot(stop[0] - start[0], stop[1] - start[1])) / _BREAK))
        along = np.linspace(start, stop, count, endpoint=False)
        if side in broken:
            # Uneven steps along the edge as well: concrete does not break in a rhythm.
            along[1:] += rng.uniform(-0.3, 0.3, (count - 1, 1)) * (along[1] - along[0]) if count > 1 else 0
            along += _break_line(count, rng)[:, None] * depth_of_break * normal
        outline.append(along)
    return prism(np.concatenate(outline), thickness)


def _break_line(count: int, rng: np.random.Generator) -> Floats:
    """How far a broken edge keeps behind the whole one, 0 to 1: large bites with a small tooth."""
    bites = rng.random(count // 4 + 2)
    line: Floats = 0.75 * np.interp(np.arange(count) / 4, np.arange(len(bites)), bites) + 0.25 * rng.random(
        count
    )
    return line


def chunks(
    centres: Floats, sizes: Floats, floor: Callable[[Floats, Floats], Floats], rng: np.random.Generator
) -> Sheet:
    """Build angular lumps of concrete in any attitude, flattened where they lie on the floor.

    Parameters
    ----------
    centres : ndarray of shape (K, 3)
        Metres.
    sizes : ndarray of shape (K,)
        Longest side of each, metres.
    floor : callable
        Elevation of what they lie on at x and y, metres; nothing of a lump is buried below it.
    rng : numpy.random.Generator
    """
    cube = box(1.0, 1.0, 1.0).mesh()
    # A corner belongs to three faces; it must move with all of them.
    corners, same = np.unique(cube.vertices.round(6), axis=0, return_inverse=True)
    block = Mesh(corners, same.ravel().astype(np.int32)[cube.triangles])
    lumps = merged(_chunk(block, *lump, rng) for lump in zip(centres, sizes, strict=True))
    x, y, z = lumps.vertices.T
    return Sheet(Mesh(np.column_stack([x, y, np.maximum(z, floor(x, y))]), lumps.triangles))


def _chunk(block: Mesh, centre: Floats, size: float, rng: np.random.Generator) -> Mesh:
    corners = block.vertices + rng.uniform(-0.18, 0.18, block.vertices.shape)
    turn = rotation(*rng.uniform(0, 360, 3))
    return Mesh(turned(corners * size * [1.0, 0.7, 0.45], turn) + centre, block.triangles)
