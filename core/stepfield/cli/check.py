"""``stepfield check``: is a stack whole and true."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from stepfield.cli.report import Reporter, counted
from stepfield.stack.check import Report, check_stack


def check_folder(folder: Path, scan: Sequence[Path], reporter: Reporter) -> int:
    """Show what a check finds; return 1 when it finds fault."""
    with reporter.progress() as progress:
        report = check_stack(folder, scan, progress)
    values = {
        "ok": not report.faults,
        "faults": list(report.faults),
        "layers": report.layers,
        "pillars": report.pillars,
        "fidelity": report.fidelity and report.fidelity.as_dict(),
    }
    reporter.result(values, _sentences(report))
    return 1 if report.faults else 0


def _sentences(report: Report) -> str:
    lines = [f"fault: {fault}" for fault in report.faults]
    if not report.faults:
        lines.append(
            f"the stack is whole: {counted(report.layers, 'layer')}, {counted(report.pillars, 'pillar')}"
        )
    if (fidelity := report.fidelity) is not None:
        lines.append(
            f"points to layers: RMSE {fidelity.rmse:.4g} m, median {fidelity.median:.4g} m, "
            f"95 % within {fidelity.p95:.4g} m, greatest {fidelity.max:.4g} m; "
            f"{fidelity.explained:.1%} within the tolerance"
        )
    return "\n".join(lines)
