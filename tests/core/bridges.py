"""A bridge that a small robot can cross: its abutments end level with the road, and seams are narrow."""

from __future__ import annotations

from pathlib import Path

from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.scan.write import write
from stepfield.stack import write_stack
from stepfield.synth import synthesise

#: The mean of a wall's points would leave a pit where the road begins, so pillars are as high as they go.
PARAMETERS = Parameters(cell_size=0.15, layer_tolerance=0.5, layering="rank", pillar_height="max")
#: Elevation of the deck, metres.
DECK = 3.4


def bridge_stack(folder: Path) -> Path:
    """Build the stack of the bridge scene in a folder; its scan is beside it."""
    scan = folder / "bridge.ply"
    write(scan, synthesise("bridge", 1_000_000).points, {})
    write_stack(Pipeline().run([scan], PARAMETERS), folder / "bridge")
    return folder / "bridge"
