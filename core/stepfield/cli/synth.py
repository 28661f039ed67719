"""``stepfield synth``: a synthetic scan whose true surfaces are known."""

from __future__ import annotations

from pathlib import Path

from stepfield.cli.report import Reporter, counted
from stepfield.scan.write import write
from stepfield.synth import synthesise


def write_scene(
    scene: str,
    output: Path,
    points: int | None,
    noise: float | None,
    seed: int,
    *,
    scanner: bool,
    reporter: Reporter,
) -> None:
    """Make the scene's points and write them in the format of the suffix."""
    with reporter.progress() as progress:
        made = synthesise(scene, points, noise, seed, scanner=scanner, progress=progress)
    write(output, made.points, {"surface": made.surface})
    values = {"file": str(output), "points": len(made.points), "surfaces": list(made.names)}
    reporter.result(
        values,
        f"{counted(len(made.points), 'point')} of {counted(len(made.names), 'surface')} written to {output}",
    )
