"""A stack on disk against its scan, against the truth, and by itself: areas, holes, seams."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from stepfield.fidelity import (
    Fidelity,
    LayerFigures,
    TruthFidelity,
    against_truth,
    compare,
    layer_figures,
    true_mesh,
)
from stepfield.fidelity.reconstructions import Bottoms, Layers, Way, chosen_way, meshes_of, surface_of
from stepfield.progress import Progress, part
from stepfield.scan import open_scan
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
