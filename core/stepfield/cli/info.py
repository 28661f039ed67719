"""``stepfield info``: what a scan holds and which parameters suit it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from stepfield import suggest
from stepfield.cli.report import Reporter, counted
from stepfield.parameters import Parameters
from stepfield.scan import Scan, open_scan


def describe_scan(scans: Sequence[Path], given: dict[str, Any], reporter: Reporter) -> None:
    """Show points, bounds, unit, up axis, attributes and suggested parameters."""
    parameters = Parameters.checked(**given)
    with reporter.progress() as progress:
        scan = open_scan(scans, parameters, progress)
    for warning in scan.warnings:
        reporter.warn(warning)
    low, high = (ends.tolist() for ends in scan.bounds())
    values = {
        "points": len(scan),
        "bounds": {"min": low, "max": high},
        "unit": scan.unit,
        "up": scan.up,
        "attributes": sorted(scan.attributes),
        "suggested": suggested(scan),
    }
    reporter.result(values, _sentences(values, scan))


def suggested(scan: Scan) -> dict[str, float]:
    """Return the values ``auto`` would take, by parameter name."""
    cell = suggest.cell_size(scan)
    return {
        "cell_size": cell,
        "layer_tolerance": suggest.layer_tolerance(scan, cell),
        "alpha": suggest.alpha(cell, scan.z.span()),
    }


def _sentences(values: dict[str, Any], scan: Scan) -> str:
    low, high = values["bounds"]["min"], values["bounds"]["max"]
    removed = ", ".join(f"{n} {why}" for why, n in scan.removed.items() if n)
    lines = [counted(len(scan), "point") + (f" (dropped: {removed})" if removed else "")]
    lines += [
        f"  {axis} {low[i]:.3f} to {high[i]:.3f} m ({high[i] - low[i]:.3f} m)" for i, axis in enumerate("xyz")
    ]
    lines.append(f"unit {scan.unit}, up {scan.up}, attributes: {', '.join(values['attributes']) or 'none'}")
    picked = ", ".join(f"{name} {value:g} m" for name, value in values["suggested"].items())
    return "\n".join([*lines, f"suggested: {picked}"])
