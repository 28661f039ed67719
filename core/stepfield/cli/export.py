"""``stepfield export``: a stack, or the stack of a project, to the files of other programs."""

from __future__ import annotations

import tempfile
from pathlib import Path

from stepfield.cli.build import changed, project_of
from stepfield.cli.report import Reporter
from stepfield.cli.targets import Wanted, described, notes, sentences
from stepfield.errors import ParameterError
from stepfield.pipeline import Pipeline
from stepfield.progress import Progress, part
from stepfield.stack import write_stack
from stepfield.targets import NAMES
from stepfield.targets.target import Written
from stepfield.targets.writing import write_targets


def export_targets(
    source: Path, output: Path, wanted: Wanted, *, overwrite: bool, reporter: Reporter
) -> None:
    """Write the targets and say what they hold."""
    if not wanted.names:
        raise ParameterError(f"no target is named; give --target with one of {', '.join(NAMES)}")
    with reporter.progress() as progress:
        if source.is_dir():
            written = _write(source, output, wanted, overwrite, progress)
            warnings: tuple[str, ...] = ()
        else:
            written, warnings = _of_project(source, output, wanted, overwrite, progress)
    for warning in (*warnings, *notes(written)):
        reporter.warn(warning)
    values = {"folder": str(output)} | described(written)
    reporter.result(values, "\n".join([*sentences(written), f"written to {output}"]))


def _of_project(
    source: Path, output: Path, wanted: Wanted, overwrite: bool, progress: Progress
) -> tuple[dict[str, Written], tuple[str, ...]]:
    """Build the project's stack where nobody sees it; return what was written and what to warn of."""
    project, scans = project_of([], source)
    with tempfile.TemporaryDirectory(prefix="stepfield-") as folder:
        result = Pipeline().run(
            scans, project.parameters, project.moves, project.layers, part(progress, 0, 0.6)
        )
        stack = Path(folder) / "stack"
        manifest = write_stack(result, stack, progress=part(progress, 0.6, 0.7))
        written = _write(stack, output, wanted, overwrite, part(progress, 0.7, 1))
    return written, (*changed(project, result), *manifest.warnings)


def _write(
    stack: Path, output: Path, wanted: Wanted, overwrite: bool, progress: Progress
) -> dict[str, Written]:
    return write_targets(stack, wanted.names, output, wanted.options, overwrite=overwrite, progress=progress)
