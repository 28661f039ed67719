"""Faces of blocks: four corners each, counter-clockwise seen from outside, with colours baked in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield_app.render.scene import Triangles
from stepfield_app.scenes.arrays import frozen
from stepfield_app.scenes.stacks import Stack

Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]

#: Which edges of the compartment each corner lies on: west or east, south or north.
_TOP = (("west", "south"), ("east", "south"), ("east", "north"), ("west", "north"))
#: The same for the two lower corners of the walls that face north, east, south and west.
_WALLS = (
    (("east", "north"), ("west", "north")),
    (("east", "south"), ("east", "north")),
    (("west", "south"), ("east", "south")),
    (("west", "north"), ("west", "south")),
)
#: Corners of a face's two triangles, cut along one diagonal or the other.
_UPRIGHT, _CROSSED = np.array([0, 1, 2, 0, 2, 3], np.int32), np.array([1, 2, 3, 1, 3, 0], np.int32)


@dataclass(frozen=True, eq=False)
class Patches:
    """Some faces.

    Attributes
    ----------
    corners : ndarray of shape (n, 4, 3), float32
    colours : ndarray of shape (n, 4, 3), uint8
    crossed : ndarray of shape (n,), bool, or None
        Faces to be cut along the other diagonal, so that a dark corner stays in its corner.
    """

    corners: Singles
    colours: Bytes
    crossed: NDArray[np.bool_] | None = None


@dataclass(frozen=True, eq=False)
class Faces:
    """The outlines of blocks and their colours, from which faces are made.

    Attributes
    ----------
    west, south, east, north, bottom, top : ndarray of shape (n,), float32
    colour : ndarray of shape (n, 3), uint8
    """

    west: Singles
    south: Singles
    east: Singles
    north: Singles
    bottom: Singles
    top: Singles
    colour: Bytes

    @classmethod
    def of(cls, stack: Stack, colour: Bytes) -> Faces:
        """Take the outlines of a stack's blocks."""
        row, column = np.divmod(stack.compartment, stack.lattice.shape[1])
        across, down = (edges.astype(np.float32) for edges in (stack.lattice.across, stack.lattice.down))
        bottom, top = stack.bottom.astype(np.float32), stack.top.astype(np.float32)
        return cls(across[column], down[row + 1], across[column + 1], down[row], bottom, top, colour)

    def tops(self, light: Singles) -> Patches:
        """Return the upper faces; ``light`` of shape (n, 4) from the south-west corner anticlockwise."""
        corners = self._level(_TOP, self.top)
        crossed = light[:, 1] + light[:, 3] > light[:, 0] + light[:, 2]
        return Patches(corners, _lit(self.colour, light), crossed)

    def undersides(self, chosen: NDArray[np.bool_], light: float) -> Patches:
        """Return the lower faces of the chosen blocks."""
        some = self._some(chosen)
        corners = some._level(_TOP[::-1], some.bottom)
        return Patches(corners, _lit(some.colour, np.full((len(corners), 4), light, np.float32)))

    def walls(self, side: int, foot: Singles, head: Singles, light: Singles) -> Patches:
        """Return one side of every block whose ``head`` is above its ``foot``.

        Parameters
        ----------
        side : int
            0 to 3: facing north, east, south, west.
        foot, head : ndarray of shape (n,)
            Elevations between which it can be seen.
        light : ndarray of shape (n, 2)
            At the foot and at the head.
        """
        seen = head > foot
        some, foot, head, light = self._some(seen), foot[seen], head[seen], light[seen]
        lower = _WALLS[side]
        corners = some._level((*lower, *lower[::-1]), head)
        corners[:, :2, 2] = foot[:, np.newaxis]
        return Patches(corners, _lit(some.colour, light[:, [0, 0, 1, 1]]))

    def _some(self, chosen: NDArray[np.bool_]) -> Faces:
        names = ("west", "south", "east", "north", "bottom", "top", "colour")
        return Faces(*(getattr(self, name)[chosen] for name in names))

    def _level(self, edges: Sequence[tuple[str, str]], height: Singles) -> Singles:
        corners = np.empty((len(height), 4, 3), np.float32)
        for i, (x, y) in enumerate(edges):
            corners[:, i, 0], corners[:, i, 1] = getattr(self, x), getattr(self, y)
        corners[:, :, 2] = height[:, np.newaxis]
        return corners


def joined(parts: Sequence[Patches]) -> Triangles:
    """Make one mesh of faces, in order."""
    vertices = np.concatenate([part.corners for part in parts]).reshape(-1, 3)
    colours = np.concatenate([part.colours for part in parts]).reshape(-1, 3)
    count = len(vertices) // 4
    order = np.arange(0, 4 * count, 4, dtype=np.int32)[:, np.newaxis] + _UPRIGHT
    first = 0
    for part in parts:
        if part.crossed is not None:
            order[first : first + len(part.corners)][part.crossed] += _CROSSED - _UPRIGHT
        first += len(part.corners)
    return Triangles(frozen(vertices), frozen(order.reshape(-1, 3)), frozen(colours), solid=True)


def _lit(colour: Bytes, light: Singles) -> Bytes:
    """Darken colours of shape (n, 3) by the light at each of four corners, shape (n, 4)."""
    share = np.rint(light * np.float32(256)).astype(np.uint16)
    lit: NDArray[np.uint16] = colour[:, np.newaxis, :] * share[:, :, np.newaxis] + np.uint16(128)
    return (lit >> np.uint16(8)).astype(np.uint8)
