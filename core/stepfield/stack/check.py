"""Is a stack whole and true: schema, files, ranges, and fidelity to the scan."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stepfield.errors import StackError
from stepfield.fidelity import Fidelity, vertical
from stepfield.progress import Progress, part, silent
from stepfield.scan import open_scan
from stepfield.stack.complexfile import FILE_NAME as COMPLEX
from stepfield.stack.manifest import LayerEntry
from stepfield.stack.read import Stack


@dataclass(frozen=True)
class Report:
    """What a check found.

    Attributes
    ----------
    faults : tuple of str
        One sentence each; none when the stack is whole and true.
    layers, pillars : int
    fidelity : Fidelity or None
        When a scan was given.
    """

    faults: tuple[str, ...]
    layers: int
    pillars: int
    fidelity: Fidelity | None = None


def check_stack(folder: Path, scan: Sequence[Path] = (), progress: Progress = silent) -> Report:
    """Check a stack on disk, against its scan if one is given.

    Raises
    ------
    StackError
        When there is no manifest to check by.
    ScanError
        When the scan cannot be read.
    """
    stack = Stack.open(folder)
    faults = list(_faults(stack, part(progress, 0, 0.4 if scan else 1)))
    fidelity = None
    if scan and not faults:
        fidelity, more = _against(stack, scan, part(progress, 0.4, 1))
        faults += more
    progress(1.0, "done")
    manifest = stack.manifest
    return Report(
        tuple(faults), len(manifest.layers), sum(layer.pillars for layer in manifest.layers), fidelity
    )


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
    if np.any((gray > 0) != mask):
        wrong = np.count_nonzero((gray > 0) != mask)
        yield f"{layer.image}: {wrong} pixels disagree with {layer.mask}: only holes are gray 0"
    column, row = stack.manifest.image.offset
    grid = stack.manifest.grid
    inside = np.s_[row : row + grid.rows, column : column + grid.columns]
    pillars = int(np.count_nonzero(mask))
    if pillars != np.count_nonzero(mask[inside]):
        yield f"{layer.mask}: has occupied pixels in the padding"
    if pillars != layer.pillars:
        yield f"{layer.mask}: {pillars} occupied pixels where the manifest says {layer.pillars} pillars"
    yield from _bottom_faults(stack, layer, gray)
    if pillars:
        yield from _range_faults(stack, layer, layer.offset + layer.scale * gray[mask])


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


def _against(stack: Stack, files: Sequence[Path], progress: Progress) -> tuple[Fidelity, list[str]]:
    """Compare with the scan, cleaned as the manifest says."""
    manifest = stack.manifest
    scan = open_scan(files, manifest.parameters, progress)
    layers = (stack.elevations(layer) for layer in manifest.layers)
    tolerance = manifest.parameters.layer_tolerance
    fidelity = vertical(scan, stack.grid, layers, tolerance if isinstance(tolerance, float) else np.inf)
    digests = [(file.name, file.sha256) for file in scan.files]
    said = [(file.name, file.sha256) for file in manifest.source.files]
    faults = []
    if [d for _, d in digests] != [d for _, d in said]:
        faults.append("the scan is not the one the stack was made from (its SHA-256 differs)")
    if fidelity.outside and not manifest.unassigned and manifest.complex is None and not faults:
        faults.append(f"{fidelity.outside} points of the scan lie where the stack has no pillar")
    return fidelity, faults
