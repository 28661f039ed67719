"""Meshing in a process of its own: Open3D takes seconds to load, holds the interpreter, and keeps memory."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import IO

from stepfield.complex_parts.job import Done, Job
from stepfield.errors import StepfieldError
from stepfield.progress import Progress, silent

WORKER = "stepfield.complex_parts.worker"
#: Files of what it says: its progress, and why it failed.
SAID, LOG = "progress", "log"
#: Seconds between two looks at it.
PAUSE = 0.05


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
        with (folder / SAID).open("wb") as said, (folder / LOG).open("wb") as log:
            _watch(_started(folder, said, log), folder / SAID, progress)
        try:
            return Done.load(folder)
        except OSError:
            reason = _last_line(folder / LOG) or "the process for it was ended"
            raise StepfieldError(f"the complex parts cannot be meshed: {reason}") from None


def _started(folder: Path, said: IO[bytes], log: IO[bytes]) -> subprocess.Popen[bytes]:
    root = str(Path(__file__).parents[2])
    path = os.pathsep.join(filter(None, [root, os.environ.get("PYTHONPATH")]))
    return subprocess.Popen(
        [sys.executable, "-m", WORKER, str(folder)],
        stdin=subprocess.DEVNULL,
        stdout=said,
        stderr=log,
        env=os.environ | {"PYTHONPATH": path},
    )


def _watch(process: subprocess.Popen[bytes], said: Path, progress: Progress) -> None:
    """Pass the process's progress on until it ends; end it if that raises."""
    try:
        while process.poll() is None:
            share, _, what = _last_line(said).partition(" ")
            if what and share.replace(".", "", 1).isdigit():  # Open3D may say something as well
                progress(float(share), what)
            else:
                progress(0.0, "meshing complex parts")
            with suppress(subprocess.TimeoutExpired):
                process.wait(PAUSE)
    finally:
        process.kill()
        process.wait()


def _last_line(file: Path) -> str:
    lines = file.read_text(errors="replace").strip().splitlines()
    return lines[-1] if lines else ""
