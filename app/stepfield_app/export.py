"""The stack as it will be written, and writing it: what ``stepfield build`` does, to the byte."""

from __future__ import annotations

import io
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from stepfield.heightmap import HeightMap
from stepfield.progress import Progress, silent
from stepfield.reconstruction import Reconstruction
from stepfield.stack import Manifest
from stepfield.stack.entries import LayerEntry
from stepfield.stack.manifest import describe, is_filled
from stepfield.stack.write import COMPRESSION, is_stack
from stepfield.targets.writing import write_stack_and_targets

Pixels = NDArray[np.uint8] | NDArray[np.uint16]

#: Pixels along the longer side of an image on the screen.
SIDE = 1024


@dataclass(frozen=True, eq=False)
class LayerPreview:
    """One layer as it will be written.

    Attributes
    ----------
    entry : LayerEntry
        As the manifest will have it.
    white : float
        The height that is white, metres above the base plane.
    gray, mask : ndarray of shape (height, width), uint8
        The images with their padding, every so many pixels where they are large.
    gray_bytes, mask_bytes : int
        Sizes of the files; of both masks where there are two.
    filled : ndarray of shape (height, width), uint8, or None
        The mask of what was filled, where holes were looked for.
    """

    entry: LayerEntry
    white: float
    gray: NDArray[np.uint8]
    mask: NDArray[np.uint8]
    gray_bytes: int
    mask_bytes: int
    filled: NDArray[np.uint8] | None = None


@dataclass(frozen=True, eq=False)
class StackPreview:
    """A stack as it will be written; ``manifest_bytes`` is the size of that file."""

    manifest: Manifest
    layers: tuple[LayerPreview, ...]
    manifest_bytes: int

    @property
    def files(self) -> int:
        """How many files it has: an image and a mask or two a layer, and the manifest."""
        return 1 + sum(2 + (layer.filled is not None) for layer in self.layers)

    @property
    def bytes(self) -> int:
        """Size of all its files."""
        return self.manifest_bytes + sum(layer.gray_bytes + layer.mask_bytes for layer in self.layers)


@dataclass(frozen=True)
class Export:
    """What is to be written, where, and for which simulators besides."""

    result: Reconstruction
    folder: Path
    overwrite: bool = False
    targets: tuple[str, ...] = ()


@dataclass(frozen=True)
class Exported:
    """What was written; ``notes`` say what a simulator cannot hold."""

    folder: Path
    manifest: Manifest
    files: int
    bytes: int
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Target:
    """What stands where a stack is to go, and a sentence about it."""

    state: Literal["free", "stack", "taken"]
    sentence: str = ""


def preview(result: Reconstruction, progress: Progress = silent) -> StackPreview:
    """Draw every layer as it will be written and say how large its files become.

    Parameters
    ----------
    result : Reconstruction
    progress : Progress
        May raise Cancelled.
    """
    drawn, sizes, holes, lifted = [], [], [], 0
    for layer in result.layers:
        progress(layer.index / len(result.layers), f"drawing {layer.name}")
        image = result.height_map(layer)
        lifted += image.lifted
        mask = _white(image.mask)
        filled = _white(_filled(image)) if is_filled(result, layer) else None
        masks = _png_size(mask) + (0 if filled is None else _png_size(filled))
        sizes.append((_png_size(image.gray), masks))
        drawn.append((_on_screen(image.gray), _on_screen(mask)))
        holes.append(None if filled is None else _on_screen(filled))
    manifest = describe(result, lifted)
    layers = tuple(
        LayerPreview(entry, layer.white, *images, *size, filled)
        for entry, layer, images, size, filled in zip(
            manifest.layers, result.layers, drawn, sizes, holes, strict=True
        )
    )
    return StackPreview(manifest, layers, len(manifest.text().encode()))


def export(wanted: Export, progress: Progress = silent) -> Exported:
    """Write a stack, and what simulators need of it.

    Raises
    ------
    StackError, TargetError
        In one sentence; the folder is then as it was.
    """
    manifest, targets = write_stack_and_targets(
        wanted.result, wanted.folder, wanted.targets, overwrite=wanted.overwrite, progress=progress
    )
    sizes = [path.stat().st_size for path in wanted.folder.rglob("*") if path.is_file()]
    notes = tuple(f"{name}: {note}" for name, made in targets.items() for note in made.notes)
    return Exported(wanted.folder, manifest, len(sizes), sum(sizes), notes)


def target(folder: Path) -> Target:
    """Say whether a stack can go to a folder, by the rules of ``stepfield build``."""
    try:
        if not os.path.lexists(folder):
            return Target("free", "The folder will be made.")
        if not folder.is_dir():
            return Target("taken", "This is a file, not a folder; choose another name.")
        if not any(folder.iterdir()):
            return Target("free", "The folder is empty.")
        if is_stack(folder):
            return Target("stack", "The folder holds a stack, which would be replaced.")
    except OSError:
        return Target("taken", "The folder cannot be read; choose another one.")
    return Target("taken", "The folder holds something other than a stack; choose another name.")


def proposed_folder(parent: Path, scans: tuple[Path, ...]) -> Path:
    """Return where to put the stack of a scan: a folder with the scan's name."""
    return parent / (scans[0].stem if scans else "stack")


def _filled(image: HeightMap) -> NDArray[np.bool_]:
    return np.zeros_like(image.mask) if image.filled is None else image.filled


def _white(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    return mask.astype(np.uint8) * np.uint8(255)


def _png_size(pixels: Pixels) -> int:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, format="PNG", compress_level=COMPRESSION)
    return file.tell()


def _on_screen(pixels: Pixels) -> NDArray[np.uint8]:
    """Thin an image out to the screen's size and 256 levels, without smoothing what will be sharp."""
    step = -(-max(pixels.shape) // SIDE)
    thin = pixels[::step, ::step]
    shown = np.ascontiguousarray(thin >> 8 if thin.dtype == np.uint16 else thin).astype(np.uint8)
    shown.flags.writeable = False
    return shown
