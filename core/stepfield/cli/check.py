"""``stepfield check``: is a stack whole and true."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from stepfield.cli.report import Reporter, counted
from stepfield.fidelity import Distances, FilledFigures, Hidden, LayerFigures
from stepfield.stack.check import Report, check_stack

#: How each way of reconstruction is called in a sentence.
WAYS = {
    "edges": "the surface with its edges",
    "simulator": "what a simulator draws",
    "pillars": "the pillars",
}


def check_folder(folder: Path, scan: Sequence[Path], truth: str | None, reporter: Reporter) -> int:
    """Show what a check finds; return 1 when it finds fault."""
    with reporter.progress() as progress:
        report = check_stack(folder, scan, truth, progress)
    manifest = report.manifest
    values = {
        "ok": not report.faults,
        "faults": list(report.faults),
        "layers": len(manifest.layers),
        "pillars": report.pillars,
        "seams": manifest.seams,
        "links": manifest.links,
        "reconstruction": report.way,
        "complex": manifest.complex and manifest.complex.model_dump(),
        "areas": [
            {"layer": layer.name} | figures.as_dict()
            for layer, figures in zip(manifest.layers, report.figures, strict=False)
        ],
        "filled": [
            {"layer": layer.name} | figures.as_dict()
            for layer, figures in zip(manifest.layers, report.filled, strict=False)
            if layer.filled_mask is not None
        ],
        "fidelity": report.fidelity and report.fidelity.as_dict(),
        "truth": report.truth and report.truth.as_dict(),
    }
    reporter.result(values, "\n".join(_sentences(report)))
    return 1 if report.faults else 0


def _sentences(report: Report) -> Iterator[str]:
    yield from (f"fault: {fault}" for fault in report.faults)
    manifest = report.manifest
    if not report.faults:
        yield (
            f"the stack is whole: {counted(len(manifest.layers), 'layer')}, "
            f"{counted(report.pillars, 'pillar')}"
        )
    if (mesh := manifest.complex) is not None:
        standing = counted(mesh.pillars, "pillar")
        yield f"{mesh.mesh}: {counted(mesh.triangles, 'triangle')} in place of {standing}"
    yield f"{counted(manifest.seams, 'seam')} in {counted(manifest.links, 'link')}"
    for layer, figures in zip(manifest.layers, report.figures, strict=False):
        yield f"  {layer.image}  {layer.name}: {_covered(figures)}"
    for layer, filled in zip(manifest.layers, report.filled, strict=False):
        if layer.filled_mask is not None:
            first, *more = _filled(filled)
            yield f"  {layer.filled_mask}  {layer.name}: {first}"
            yield from (f"    {line}" for line in more)
    surface = WAYS[report.way]
    if (fidelity := report.fidelity) is not None:
        yield (
            f"{counted(fidelity.points, 'point')} against {surface}: {fidelity.explained:.1%} within the "
            f"tolerance of {fidelity.tolerance:.4g} m above or below, {fidelity.nearest.explained:.1%} "
            f"within it in any direction"
        )
        yield f"  vertical: {_distances(fidelity.vertical, 'points have no surface above or below')}"
        yield f"  nearest:  {_distances(fidelity.nearest, 'points have no surface near')}"
    if (truth := report.truth) is not None:
        yield f"from {surface} to the truth: {_distances(truth.accuracy, 'samples are far from it')}"
        yield f"from the truth to {surface}: {_distances(truth.completeness, 'samples are far from it')}"


def _covered(figures: LayerFigures) -> str:
    lost = 1 - figures.simulator_area / figures.occupied_area if figures.occupied_area else 0.0
    vanished = (
        f", {figures.vanished} of {counted(figures.surfaces, 'surface')} gone" if figures.vanished else ""
    )
    holes = counted(figures.holes, "hole") + (f" of {figures.hole_area:.4g} m2" if figures.holes else "")
    return (
        f"{figures.occupied_area:.4g} m2 occupied, {figures.simulator_area:.4g} m2 as a simulator draws it "
        f"({lost:.1%} lost{vanished}), {holes}"
    )


def _filled(figures: FilledFigures) -> Iterator[str]:
    """Say how much was filled, what is left open, and how far off the filled heights are."""
    pixels = f"{counted(figures.pixels, 'pixel')} of {figures.area:.4g} m2"
    said = f"{counted(figures.holes, 'hole')} filled, {pixels}"
    still = f", {counted(figures.open, 'hole')} of {figures.open_area:.4g} m2 left open"
    yield said + (still if figures.open else "")
    if figures.pixels:
        yield f"  off by {_estimated(figures.hidden)}"
    if (truth := figures.truth) is not None:
        none = f"; {truth.missing} pixels have none above or below" if truth.missing else ""
        yield f"  from the true surface: {_off(truth.rmse, truth.median, truth.p95)}{none}"


def _estimated(hidden: Hidden | None) -> str:
    if hidden is None:
        return "– (too little measured ground to hide patches like these holes in)"
    figures = _off(hidden.rmse, hidden.median, hidden.p95)
    return f"{figures}, estimated from {hidden.patches} hidden patches"


def _off(rmse: float, median: float, p95: float) -> str:
    return f"RMSE {rmse:.3g} m, median {median:.3g} m, 95 % within {p95:.3g} m"


def _distances(distances: Distances, without: str) -> str:
    missing = f"; {distances.missing} {without}" if distances.missing else ""
    return (
        f"RMSE {distances.rmse:.4g} m, median {distances.median:.4g} m, 95 % within {distances.p95:.4g} m, "
        f"greatest {distances.max:.4g} m{missing}"
    )
