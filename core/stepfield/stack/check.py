"""Is a stack whole and true: schema, files, ranges, and fidelity to the scan."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from stepfield.errors import StackError
from stepfield.fidelity import Fidelity, FilledFigures, LayerFigures, TruthFidelity, Way
from stepfield.progress import Progress, part, silent
from stepfield.stack.clearances import clearance_faults
from stepfield.stack.compare import Compared
from stepfield.stack.complexfile import FILE_NAME as COMPLEX
from stepfield.stack.entries import LayerEntry
from stepfield.stack.manifest import Manifest
from stepfield.stack.read import Stack


@dataclass(frozen=True)
class Report:
    """What a check found.

    Attributes
    ----------
    faults : tuple of str
        One sentence each; none when the stack is whole and true.
    manifest : Manifest
    way : str
        How the layers are reconstructed where they are compared.
    figures : tuple of LayerFigures
        What each layer covers; none when the stack is not whole.
    filled : tuple of FilledFigures
        What was filled in each layer; none when holes were not to be filled.
    fidelity : Fidelity or None
        When a scan was given.
    truth : TruthFidelity or None
        When the truth was given.
    """

    faults: tuple[str, ...]
    manifest: Manifest
    way: Way = "edges"
    figures: tuple[LayerFigures, ...] = ()
    filled: tuple[FilledFigures, ...] = ()
    fidelity: Fidelity | None = None
    truth: TruthFidelity | None = None

    @property
    def pillars(self) -> int:
        """Exported pillars."""
        return sum(layer.pillars for layer in self.manifest.layers)


def check_stack(
    folder: Path, scan: Sequence[Path] = (), truth: str | None = None, progress: Progress = silent
) -> Report:
    """Check a stack on disk, against its scan and the truth where they are given.

    Parameters
    ----------
    folder : Path
    scan : sequence of Path
        Files of the scan that it was made from.
    truth : str, optional
        A scene's name, its description, or a mesh file.
    progress : Progress

    Raises
    ------
    StackError
        When there is no manifest to check by.
    ScanError
        When the scan cannot be read.
    SceneError
        When there is no such truth.
    """
    stack = Stack.open(folder)
    faults = list(_faults(stack, part(progress, 0, 0.4 if scan or truth else 1)))
    if faults:
        return Report(tuple(faults), stack.manifest)
    compared = Compared(stack)
    report = Report((), stack.manifest, compared.way, compared.figures(), compared.filled(truth))
    if scan:
        fidelity, more = compared.with_scan(scan, part(progress, 0.4, 0.8 if truth else 1))
        report = replace(report, faults=tuple(more), fidelity=fidelity)
    if truth is not None:
        report = replace(report, truth=compared.with_truth(truth, part(progress, 0.8 if scan else 0.4, 1)))
    progress(1.0, "done")
    return report


def _faults(stack: Stack, progress: Progress) -> Iterator[str]:
    """Every fault of the files and numbers, one sentence each."""
    manifest = stack.manifest
    column, row = manifest.image.offset
    if (
        column + manifest.grid.columns > manifest.image.width
        or row + manifest.grid.rows > manifest.image.height
    ):
        yield "manifest.json: the grid does not fit into the images"
        return
    if [layer.index for layer in manifest.layers] != list(range(len(manifest.layers))):
        yield "manifest.json: the layers are not numbered 0, 1, 2, ..."
    yield from _complex_faults(stack)
    for layer in manifest.layers:
        progress(layer.index / max(1, len(manifest.layers)), f"checking {layer.name}")
        try:
            yield from _layer_faults(stack, layer)
        except StackError as error:
            yield str(error)


def _complex_faults(stack: Stack) -> Iterator[str]:
    """Say whether the mesh that stands in for pillars is there, whole, and where the scan is."""
    try:
        mesh = stack.complex_mesh()
    except StackError as error:
        yield str(error)
        return
    if mesh is None or not len(mesh.vertices):
        return
    grid, cell = stack.grid, stack.grid.cell_size
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    corner = np.array([grid.west, grid.south])
    beyond = corner + cell * np.array([grid.columns, grid.rows])
    if (low[:2] < corner - cell).any() or (high[:2] > beyond + cell).any():
        yield f"{COMPLEX}: reaches beyond the grid"


def _layer_faults(stack: Stack, layer: LayerEntry) -> Iterator[str]:
    gray, mask = stack.gray(layer), stack.mask(layer)
    filled = stack.filled(layer)
    if wrong := np.count_nonzero((gray > 0) != (mask | filled)):
        masks = layer.mask if layer.filled_mask is None else f"{layer.mask} and {layer.filled_mask}"
        yield f"{layer.image}: {wrong} pixels disagree with {masks}: only holes are gray 0"
    column, row = stack.manifest.image.offset
    grid = stack.manifest.grid
    inside = np.s_[row : row + grid.rows, column : column + grid.columns]
    pillars = int(np.count_nonzero(mask))
    if pillars != np.count_nonzero(mask[inside]):
        yield f"{layer.mask}: has occupied pixels in the padding"
    if pillars != layer.pillars:
        yield f"{layer.mask}: {pillars} occupied pixels where the manifest says {layer.pillars} pillars"
    yield from _filled_faults(layer, mask, filled, inside)
    yield from _bottom_faults(stack, layer, gray)
    yield from clearance_faults(stack, layer)
    if pillars:
        yield from _range_faults(stack, layer, layer.offset + layer.scale * gray[mask])


def _filled_faults(
    layer: LayerEntry, mask: np.ndarray, filled: np.ndarray, inside: tuple[slice, slice]
) -> Iterator[str]:
    """Say where the mask of what was filled is not that of holes, or not what the manifest says."""
    name, count = layer.filled_mask or "manifest.json", int(np.count_nonzero(filled))
    if wrong := np.count_nonzero(mask & filled):
        yield f"{name}: {wrong} pixels are measured, too, says {layer.mask}"
    if count != np.count_nonzero(filled[inside]):
        yield f"{name}: has filled pixels in the padding"
    if count != layer.filled:
        yield f"{name}: {count} filled pixels where the manifest says {layer.filled}"


def _bottom_faults(stack: Stack, layer: LayerEntry, gray: np.ndarray) -> Iterator[str]:
    """Say where obstacles have no lower end, or one above their top."""
    if (layer.kind == "obstacles") != (layer.bottom is not None):
        yield f"manifest.json: {layer.name} is {layer.kind}, but bottom is {layer.bottom}"
    bottom = stack.bottom_gray(layer)
    if bottom is None:
        return
    if wrong := np.count_nonzero((bottom > 0) != (gray > 0)):
        yield f"{layer.bottom}: {wrong} pixels disagree with {layer.mask}: only holes are gray 0"
    if wrong := np.count_nonzero(bottom > gray):
        yield f"{layer.bottom}: {wrong} pixels are higher than in {layer.image}"


def _range_faults(stack: Stack, layer: LayerEntry, elevation: np.ndarray) -> Iterator[str]:
    """Compare heights in the image with those in the manifest; a lifted zero is a level and a half off."""
    heights = elevation - stack.manifest.base_elevation
    for name, found, said in (
        ("lowest", heights.min(), layer.height_min),
        ("greatest", heights.max(), layer.height_max),
        ("mean", heights.mean(), layer.height_mean),
    ):
        if said is None or abs(found - said) > 1.5 * layer.scale + 1e-9 * abs(stack.manifest.base_elevation):
            yield f"{layer.image}: the {name} height is {found:g} m where the manifest says {said} m"
