"""The meshing process: ``python -m stepfield.complex_parts.worker FOLDER``; prints its progress."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from stepfield.complex_parts.fitting import fitted
from stepfield.complex_parts.job import Done, Job
from stepfield.complex_parts.pivoting import pivoted
from stepfield.complex_parts.reducing import distances, reduced
from stepfield.progress import Progress, part
from stepfield.surface import Mesh

#: How much the window's own processes go before this one.
COURTESY = 5


def main(folder: Path) -> None:
    """Do the job in a folder."""
    if sys.platform != "win32":
        os.nice(COURTESY)
    do(Job.load(folder), _say).save(folder)


def do(job: Job, progress: Progress) -> Done:
    """Mesh, leave out what is flat, draw what is left to the points, and measure."""
    import open3d as o3d

    o3d.utility.set_verbosity_level(o3d.utility.VerbosityLevel.Error)
    triangles = pivoted(job.points, job.spacing, part(progress, 0, 0.8))
    progress(0.8, "reducing complex parts")
    mesh = reduced(Mesh(job.points, triangles), job.spacing)
    progress(0.85, "fitting complex parts")
    mesh = fitted(mesh, job.points, job.spacing)
    progress(0.95, "measuring complex parts")
    return Done(mesh, distances(job.samples, mesh))


def _say(share: float, what: str) -> None:
    sys.stdout.write(f"{share:.4f} {what}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
