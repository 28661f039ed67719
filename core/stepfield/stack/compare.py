"""A stack on disk against its scan, against the truth, and by itself: areas, holes, seams."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from stepfield.fidelity import (
    Fidelity,
    FilledFigures,
    LayerFigures,
    Surface,
    TruthFidelity,
    against_truth,
    compare,
    filled_figures,
    layer_figures,
    true_mesh,
    with_truth,
)
from stepfield.fidelity.reconstructions import Bottoms, Layers, Way, chosen_way, meshes_of, surface_of
from stepfield.filling import Filled
from stepfield.progress import Progress, part
from stepfield.scan import open_scan
from stepfield.stack.entries import LayerEntry
from stepfield.stack.read import Stack


class Compared:
    """A stack whose layers have been read, to be compared with one thing after the other."""

    def __init__(self, stack: Stack) -> None:
        self._stack = stack
        self._layers, self._bottoms = _layers(stack)
        mesh = stack.complex_mesh()
        self._besides = [] if mesh is None else [mesh]

    @property
    def way(self) -> Way:
        """How the layers are reconstructed."""
        return chosen_way(self._stack.manifest.parameters)

    def figures(self) -> tuple[LayerFigures, ...]:
        """Tell what the layers cover."""
        return layer_figures(self._stack.grid, self._layers, self._link_step)

    def filled(self, truth: str | None = None) -> tuple[FilledFigures, ...]:
        """Tell what was filled and how far off that is likely to be; how far it is, where truth is known.

        One a layer; nothing if holes were not to be filled.
        """
        stack, method = self._stack, self._stack.manifest.parameters.fill
        if method == "none":
            return ()
        grid, filled = stack.grid, [_filled(stack, entry) for entry in stack.manifest.layers]
        found = filled_figures(grid, self._layers, self._bottoms, filled, method, self._tolerance)
        if truth is None:
            return found
        surface = Surface.of([true_mesh(truth)])
        return tuple(
            with_truth(figures, grid, each, surface, self._tolerance)
            for figures, each in zip(found, filled, strict=True)
        )

    def with_scan(self, files: Sequence[Path], progress: Progress) -> tuple[Fidelity, list[str]]:
        """Compare with the scan, cleaned as the manifest says; say what cannot be of one and the same."""
        stack, manifest = self._stack, self._stack.manifest
        scan = open_scan(files, manifest.parameters, part(progress, 0, 0.5))
        found = compare(
            scan,
            stack.grid,
            self._layers,
            self.way,
            self._link_step,
            self._tolerance,
            bottoms=self._bottoms,
            besides=self._besides,
            progress=part(progress, 0.5, 1),
        ).fidelity
        digests, said = ([file.sha256 for file in files] for files in (scan.files, manifest.source.files))
        if digests != said:
            return found, ["the scan is not the one the stack was made from (its SHA-256 differs)"]
        is_whole = self.way == "edges" and not manifest.unassigned and manifest.complex is None
        if is_whole and found.vertical.missing:
            return found, [f"{found.vertical.missing} points of the scan lie where the stack has no pillar"]
        return found, []

    def with_truth(self, source: str, progress: Progress) -> TruthFidelity:
        """Compare with the true surfaces: a scene's name, its description, or a mesh file."""
        grid, truth = self._stack.grid, true_mesh(source)
        surface = surface_of(grid, self._layers, self.way, self._link_step, self._bottoms, self._besides)
        meshes = meshes_of(grid, self._layers, self.way, self._link_step, self._bottoms)
        return against_truth([*meshes, *self._besides], surface, truth, self._tolerance, progress=progress)

    @property
    def _tolerance(self) -> float:
        tolerance = self._stack.manifest.parameters.layer_tolerance
        return tolerance if isinstance(tolerance, float) else np.inf

    @property
    def _link_step(self) -> float:
        step = self._stack.manifest.parameters.link_step
        return step if isinstance(step, float) else self._tolerance


def _layers(stack: Stack) -> tuple[Layers, Bottoms]:
    made, bottoms = [], {}
    for entry in stack.manifest.layers:
        elevation = stack.elevations(entry).ravel()
        compartment = np.flatnonzero(~np.isnan(elevation))
        made.append((compartment, elevation[compartment]))
        lower = stack.bottoms(entry)
        if lower is not None:
            bottoms[entry.index] = lower.ravel()[compartment]
    return made, bottoms


def _filled(stack: Stack, entry: LayerEntry) -> Filled:
    """Return what was filled in a layer, in scan coordinates."""
    if entry.filled_mask is None:
        return Filled(np.zeros(0, np.int64), np.zeros(0))
    both = stack.elevations(entry, filled=True).ravel()
    compartment = np.flatnonzero(~np.isnan(both) & np.isnan(stack.elevations(entry).ravel()))
    return Filled(compartment, both[compartment])
