"""Reading a stack back: gray levels to elevations, and whether the folder is whole and true."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from stepfield.errors import StackError
from stepfield.grid import Grid
from stepfield.stack.complexfile import load_complex
from stepfield.stack.entries import LayerEntry
from stepfield.stack.manifest import Manifest
from stepfield.surface import Mesh


@dataclass(frozen=True)
class Stack:
    """A stack on disk; its layers are read when asked for.

    Attributes
    ----------
    folder : Path
    manifest : Manifest
    """

    folder: Path
    manifest: Manifest

    @classmethod
    def open(cls, folder: Path) -> Stack:
        """Open the stack in ``folder``, raising StackError in one sentence if there is none."""
        return cls(folder, Manifest.of(folder))

    @property
    def grid(self) -> Grid:
        """The grid of compartments."""
        entry = self.manifest.grid
        return Grid(*entry.origin, entry.cell_size, entry.columns, entry.rows)

    def gray(self, layer: LayerEntry) -> NDArray[np.uint8] | NDArray[np.uint16]:
        """Gray levels of a layer's image, padding included, shape (height, width)."""
        return self._gray(layer.image)

    def bottom_gray(self, layer: LayerEntry) -> NDArray[np.uint8] | NDArray[np.uint16] | None:
        """Gray levels of the lower ends of a layer of obstacles, shape (height, width); None for others."""
        return None if layer.bottom is None else self._gray(layer.bottom)

    def _gray(self, name: str) -> NDArray[np.uint8] | NDArray[np.uint16]:
        image = self._pixels(name)
        wanted = np.uint8 if self.manifest.image.bits == 8 else np.uint16
        if image.dtype != wanted:
            raise StackError(
                f"{self.folder / name}: has {8 * image.itemsize} bits a pixel where the manifest says "
                f"{self.manifest.image.bits}; build the stack again"
            )
        return image

    def mask(self, layer: LayerEntry) -> NDArray[np.bool_]:
        """Occupied pixels of a layer, padding included, shape (height, width)."""
        mask: NDArray[np.bool_] = self._pixels(layer.mask) > 0
        return mask

    def filled(self, layer: LayerEntry) -> NDArray[np.bool_]:
        """Pixels of a layer that were filled, padding included, shape (height, width)."""
        if layer.filled_mask is None:
            return np.zeros((self.manifest.image.height, self.manifest.image.width), bool)
        filled: NDArray[np.bool_] = self._pixels(layer.filled_mask) > 0
        return filled

    def elevations(self, layer: LayerEntry, *, filled: bool = False) -> NDArray[np.float64]:
        """Elevations of a layer over the grid in scan coordinates, shape (rows, columns), NaN in holes.

        With ``filled``, those that were filled have one, too.
        """
        elevations = self._elevations(layer, self.gray(layer))
        if filled and layer.filled_mask is not None:
            inside = self._inside
            levels = layer.offset + layer.scale * self.gray(layer)[inside]
            elevations = np.where(self.filled(layer)[inside], levels, elevations)
        return elevations

    def bottoms(self, layer: LayerEntry) -> NDArray[np.float64] | None:
        """Elevations of the lower ends of obstacles, as :meth:`elevations`; None for a surface."""
        gray = self.bottom_gray(layer)
        return None if gray is None else self._elevations(layer, gray)

    def clearance_gray(self, layer: LayerEntry) -> NDArray[np.uint16] | None:
        """Levels of the room above a layer, padding included, shape (height, width); None if not written."""
        if layer.clearance is None:
            return None
        image = self._pixels(layer.clearance.image)
        if image.dtype != np.uint16:
            raise StackError(
                f"{self.folder / layer.clearance.image}: has not 16 bits a pixel; build the stack again"
            )
        return image.astype(np.uint16)

    def clearances(self, layer: LayerEntry) -> NDArray[np.float64] | None:
        """Room above a layer over the grid, shape (rows, columns), metres; None if it was not written.

        Infinite where nothing is above, NaN in holes.
        """
        gray = self.clearance_gray(layer)
        if gray is None or layer.clearance is None:
            return None
        inside = self._inside
        room = np.where(gray == 0, np.inf, layer.clearance.offset + layer.clearance.scale * gray)[inside]
        return np.where(self.mask(layer)[inside], room, np.nan)

    @property
    def _inside(self) -> tuple[slice, slice]:
        """Where the grid lies in the images."""
        column, row = self.manifest.image.offset
        return np.s_[row : row + self.manifest.grid.rows, column : column + self.manifest.grid.columns]

    def _elevations(
        self, layer: LayerEntry, gray: NDArray[np.uint8] | NDArray[np.uint16]
    ) -> NDArray[np.float64]:
        inside = self._inside
        return np.where(self.mask(layer)[inside], layer.offset + layer.scale * gray[inside], np.nan)

    def complex_mesh(self) -> Mesh | None:
        """Return the mesh of the complex parts in scan coordinates, metres; None if nothing was meshed."""
        entry = self.manifest.complex
        if entry is None:
            return None
        return load_complex(self.folder / entry.mesh, entry.vertices, entry.triangles)

    def _pixels(self, name: str) -> NDArray[np.uint8] | NDArray[np.uint16]:
        """Read an image, checking its size before it is decoded so that none is absurd."""
        path, size = self.folder / name, (self.manifest.image.width, self.manifest.image.height)
        try:
            with Image.open(path) as image:
                if image.size != size:
                    found = f"{image.size[0]} x {image.size[1]}"
                    raise StackError(
                        f"{path}: is {found} pixels where the manifest says {size[0]} x {size[1]}; "
                        f"build the stack again"
                    )
                if image.mode not in {"L", "I;16"}:
                    raise StackError(f"{path}: is not a gray image; build the stack again")
                return np.asarray(image)
        except FileNotFoundError:
            raise StackError(f"{path}: the image is missing; build the stack again") from None
        except (OSError, UnidentifiedImageError, ValueError, SyntaxError, Image.DecompressionBombError):
            raise StackError(f"{path}: the image is damaged; build the stack again") from None
