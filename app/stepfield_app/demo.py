"""The demo: a collapsed building as a laser scanner sees it, made once and kept in the user's cache."""

from __future__ import annotations

from pathlib import Path

from platformdirs import user_cache_path

import stepfield
from stepfield.errors import ScanError
from stepfield.files import reason
from stepfield.parameters import Parameters
from stepfield.progress import Progress, part, silent

#: As ``packaging/run`` builds it: a scanner's stray echoes are left out.
PARAMETERS = Parameters(outliers="isolated")
SCENE, POINTS = "rubble", 1_000_000


def demo_file(cache: Path | None = None) -> Path:
    """Return where the demo's scan is, or will be; another version of Stepfield makes its own."""
    return (cache or user_cache_path("stepfield")) / stepfield.__version__ / f"{SCENE}.laz"


def make_demo(cache: Path | None = None, progress: Progress = silent, points: int = POINTS) -> Path:
    """Make the demo's scan unless it is there already, and return where it is.

    Parameters
    ----------
    cache : Path, optional
        The user's cache folder by default.
    progress : Progress
    points : int

    Raises
    ------
    ScanError
        When it cannot be written; nothing is left behind then.
    """
    file = demo_file(cache)
    if file.is_file():
        return file
    from stepfield.scan.write import write
    from stepfield.synth import synthesise

    progress(0.0, "building a collapsed building")
    made = synthesise(SCENE, points, scanner=True, progress=part(progress, 0, 0.9))
    progress(0.9, "writing the demo")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ScanError(f"{file.parent}: the demo cannot be kept there ({reason(error)})") from None
    write(file, made.points, {"surface": made.surface})
    progress(1.0, "done")
    return file
