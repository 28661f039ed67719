"""What a camera sees of pillars, kept for a stroke: every dab of a brush asks for the same million."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield.selecting import Mask, Reach
from stepfield_app.render.camera import Camera, Size
from stepfield_app.scenes.arrays import in_chunks
from stepfield_app.scenes.shapes import Shape

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Outlook:
    """Where one looks from, and what may be taken of what is seen.

    Attributes
    ----------
    camera : Camera
    size : tuple of int
        Width and height of the picture, device pixels.
    origin : ndarray of shape (3,)
        Of local coordinates, scan coordinates, metres.
    visible : tuple of int
        Layers that are shown, -1 for Unassigned.
    reach : Reach
    """

    camera: Camera
    size: Size
    origin: Floats
    visible: tuple[int, ...]
    reach: Reach

    def is_as(self, other: Outlook) -> bool:
        """Whether the same is seen from another one."""
        return self.origin is other.origin and self._parts == other._parts

    @property
    def _parts(self) -> tuple[object, ...]:
        return self.camera, self.size, self.visible, self.reach


@dataclass(frozen=True, eq=False)
class Seen:
    """Tops of pillars in a picture.

    Attributes
    ----------
    pillars : ndarray of shape (n,), int64
    pixels : ndarray of shape (n, 2), float64
    half : ndarray of shape (n, 1), float64
        Half the side of each top in pixels, as if seen from above.
    """

    pillars: Integers
    pixels: Floats
    half: Floats


@dataclass(eq=False)
class Lens:
    """Sees pillars once for all dabs of a stroke, and touches only what the last of them came to.

    For one thread at a time.
    """

    _result: Reconstruction | None = None
    _outlook: Outlook | None = None
    _seen: Seen | None = field(default=None, repr=False)
    _brushed: tuple[Shape, Mask] | None = field(default=None, repr=False)

    def covered(self, result: Reconstruction, outlook: Outlook, shape: Shape) -> Integers:
        """Return the pillars whose top a shape covers, or touches if it is a brush, be they hidden or not."""
        seen = self._look(result, outlook)
        taken = self._touched(seen, shape) if shape.kind == "brush" else shape.covers(seen.pixels)
        return seen.pillars[taken]

    def _look(self, result: Reconstruction, outlook: Outlook) -> Seen:
        known = self._outlook
        if self._seen is None or self._result is not result or known is None or not outlook.is_as(known):
            self._seen = self._brushed = None  # the old ones go before the new ones take their memory
            self._seen = _seen(result, outlook)
            self._result, self._outlook = result, outlook
        return self._seen

    def _touched(self, seen: Seen, shape: Shape) -> Mask:
        before, rest = self._brushed, shape
        if before is not None and _goes_on(shape, before[0]):
            rest = replace(shape, path=shape.path[len(before[0].path) - 1 :])
        taken = rest.touches(seen.pixels, seen.half)
        if rest is not shape and before is not None:
            taken = taken | before[1]
        self._brushed = shape, taken
        return taken


def _goes_on(shape: Shape, before: Shape) -> bool:
    """Whether a stroke is another one that has gone on."""
    length = len(before.path)
    return (
        shape.radius == before.radius
        and 0 < length <= len(shape.path)
        and np.array_equal(shape.path[:length], before.path)
    )


def _seen(result: Reconstruction, outlook: Outlook) -> Seen:
    there = np.flatnonzero(outlook.reach.mask(result) & visible_mask(result, outlook.visible))
    tops = _Tops(result, outlook.origin)
    pixels, depth = np.empty((len(there), 2)), np.empty(len(there))

    def project(part: slice) -> None:
        pixels[part], depth[part] = outlook.camera.project(tops(there[part]), outlook.size)

    in_chunks(len(there), project)
    return Seen(there, pixels, _half_tops(result, outlook, depth))


def _half_tops(result: Reconstruction, outlook: Outlook, depth: Floats) -> Floats:
    """Half the side of tops in pixels, as if seen from above; shape (n, 1)."""
    camera, size = outlook.camera, outlook.size
    half = result.field.compartments.grid.cell_size / 2 / camera.metres_per_pixel(size)
    if camera.parallel:
        return np.full((len(depth), 1), half)
    nearest = half * camera.distance / max(size)  # nearer ones are larger than the picture
    return (half * camera.distance / np.maximum(depth, nearest))[:, np.newaxis]


class _Tops:
    """Middles of the tops of pillars, local coordinates: looked up by compartment, so quick for many."""

    def __init__(self, result: Reconstruction, origin: Floats) -> None:
        field, cells = result.field, result.field.compartments
        self._centres = cells.grid.centres(cells.occupied) - origin[:2]
        self._place = np.repeat(np.arange(len(cells.occupied)), np.diff(field.first))
        self._elevation, self._shift = field.elevation, cells.lowest - origin[2]

    def __call__(self, chosen: Integers) -> Floats:
        tops = np.empty((len(chosen), 3))
        tops[:, :2] = self._centres.take(self._place.take(chosen), axis=0)
        tops[:, 2] = self._elevation.take(chosen) + self._shift
        return tops


def visible_mask(result: Reconstruction, layers: Collection[int]) -> Mask:
    """Mask of the pillars of layers, -1 for those in none."""
    shown = np.zeros(result.layering.count + 1, bool)  # the last one is that of Unassigned
    shown[[layer for layer in layers if layer < result.layering.count]] = True
    visible: Mask = shown[result.layering.layer]
    return visible
