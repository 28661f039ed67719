"""``stepfield build``: a scan or a project to a stack of height-maps."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from stepfield.cli.report import Reporter, counted
from stepfield.cli.targets import Wanted, described, notes, sentences
from stepfield.errors import ParameterError
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.progress import part
from stepfield.project import Project
from stepfield.reconstruction import Reconstruction
from stepfield.stack import Manifest
from stepfield.targets.writing import write_stack_and_targets


def build_stack(
    scans: Sequence[Path],
    project_file: Path | None,
    output: Path,
    given: dict[str, Any],
    wanted: Wanted,
    *,
    overwrite: bool,
    reporter: Reporter,
) -> None:
    """Build the stack and say what it holds."""
    project, paths = project_of(scans, project_file)
    parameters = Parameters.checked(**(project.parameters.model_dump() | given))
    with reporter.progress() as progress:
        result = Pipeline().run(paths, parameters, project.moves, project.layers, part(progress, 0, 0.8))
        manifest, targets = write_stack_and_targets(
            result, output, wanted.names, wanted.options, overwrite=overwrite, progress=part(progress, 0.8, 1)
        )
    for warning in (*changed(project, result), *manifest.warnings, *notes(targets)):
        reporter.warn(warning)
    values = (
        {"folder": str(output)} | manifest.model_dump(mode="json") | (described(targets) if targets else {})
    )
    reporter.result(values, "\n".join([*_sentences(manifest), *sentences(targets), f"written to {output}"]))


def project_of(scans: Sequence[Path], project_file: Path | None) -> tuple[Project, Sequence[Path]]:
    """Return the project to build and where its scans are; bare scans make a project of their own."""
    if (project_file is None) == (not scans):
        raise ParameterError("give either scans or --project FILE, not both and not neither")
    if project_file is None:
        return Project(), scans
    project = Project.read(project_file)
    return project, project.scan_paths(project_file)


def changed(project: Project, result: Reconstruction) -> list[str]:
    """Say which scans are no longer those the project was made with."""
    pairs = zip(project.scans, result.scan.files, strict=False)
    return [
        f"{file.name}: the scan has changed since the project was saved"
        for stored, file in pairs
        if stored.sha256 is not None and stored.sha256 != file.sha256
    ]


def _sentences(manifest: Manifest) -> list[str]:
    parameters, grid = manifest.parameters, manifest.grid
    lines = [
        f"{counted(len(manifest.layers), 'layer')}, "
        f"{counted(sum(layer.pillars for layer in manifest.layers), 'pillar')} "
        f"of {grid.columns} x {grid.rows} compartments, {manifest.unassigned} unassigned",
        f"cell size {grid.cell_size:g} m, tolerance {parameters.layer_tolerance:g} m, "
        f"alpha {parameters.alpha:g} m, greatest height {manifest.max_height:.4g} m",
        f"{counted(manifest.seams, 'seam')} in {counted(manifest.links, 'link')}",
    ]
    if (mesh := manifest.complex) is not None:
        lines.append(
            f"{mesh.mesh}: {counted(mesh.triangles, 'triangle')} "
            f"in place of {counted(mesh.pillars, 'pillar')}"
        )
    lines += [
        f"  {layer.image}  {layer.name}: {counted(layer.pillars, 'pillar')}, "
        f"mean height {layer.height_mean or 0:.3g} m"
        for layer in manifest.layers
    ]
    return lines
