"""Meshing in a process of its own: Open3D takes seconds to load, holds the interpreter, and keeps memory."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from stepfield.complex_parts.job import Done, Job
from stepfield.errors import StepfieldError
from stepfield.progress import Progress, silent

WORKER = "stepfield.complex_parts.worker"


def mesh_apart(job: Job, progress: Progress = silent) -> Done:
    """Do a job in another process; ``progress`` may raise Cancelled, which ends it.

    Raises
    ------
    StepfieldError
        In one sentence, when the process fails.
    """
    with tempfile.TemporaryDirectory(prefix="stepfield-mesh-") as place:
        folder = Path(place)
        job.save(folder)
        with (folder / "log").open("wb") as log:
            _watch(_started(folder, log.fileno()), progress)
        try:
            return Done.load(folder)
        except OSError:
            raise StepfieldError(
                f"the complex parts cannot be meshed: {_last_line(folder / 'log')}"
            ) from None


def _started(folder: Path, log: int) -> subprocess.Popen[str]:
    root = str(Path(__file__).parents[2])
    path = os.pathsep.join(filter(None, [root, os.environ.get("PYTHONPATH")]))
    return subprocess.Popen(
        [sys.executable, "-m", WORKER, str(folder)],
        stdout=subprocess.PIPE,
        stderr=log,
        stdin=subprocess.DEVNULL,
        text=True,
        env=os.environ | {"PYTHONPATH": path},
    )


def _watch(process: subprocess.Popen[str], progress: Progress) -> None:
    """Pass the process's progress on until it ends; end it if that raises."""
    assert process.stdout is not None
    try:
        for line in process.stdout:
            share, _, what = line.strip().partition(" ")
            if what and share.replace(".", "", 1).isdigit():  # Open3D may say something as well
                progress(float(share), what)
    finally:
        if process.poll() is None:
            process.terminate() if sys.exc_info()[0] else process.wait()
        process.wait()
        process.stdout.close()


def _last_line(log: Path) -> str:
    lines = log.read_text(errors="replace").strip().splitlines()
    return lines[-1] if lines else "the process for it was ended"
