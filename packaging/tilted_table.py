"""Make the two projects of the README's tour: a table top that fell apart into two layers, and whole again.

    python tilted_table.py SCAN FOLDER

SCAN is made from ``tilted_table.json``. What an operator does with a click of *Connected surface* and a digit
is done here by the same functions; the projects are FOLDER/before.stepfield and FOLDER/after.stepfield.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from stepfield import moving, selecting
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.project import LayerStyle, Project, ScanFile
from stepfield.reconstruction import Reconstruction

#: The table top rises from layer to layer; the upper half of it went to what is above.
TABLE, WRONG = 1, 2
NAMES = ("Floor", "Table top", "Beam, below", "Beam, above")
#: A place of the upper half, and a line lengthwise through the whole, x and y in metres.
UPPER_HALF = 0.75, 0.0
LINE = {"start": (-1.6, 0.0), "end": (1.6, 0.0), "width": 0.06}
#: The paper's way, which the table top falls apart by.
PARAMETERS = Parameters(layering="elevation")
CAMERA = {"centre": (0.1, 0.0, 0.62), "azimuth": -24.0, "elevation": 24.0, "distance": 3.7}


def main() -> None:
    """Write both projects."""
    scan, folder = Path(sys.argv[1]), Path(sys.argv[2])
    before = Project(
        scans=(ScanFile(path=str(scan.resolve())),),
        parameters=PARAMETERS,
        layers=tuple(LayerStyle(index=index, name=name) for index, name in enumerate(NAMES)),
        view={"camera": CAMERA, "shown": ["pillars"], "layer": TABLE, "map": "hillshade", "line": LINE},
    )
    before.save(folder / "before.stepfield")
    result = Pipeline().run([scan], PARAMETERS)
    plan = moving.move_to(result, upper_half(result), TABLE)
    plan.applied(before).save(folder / "after.stepfield")


def upper_half(result: Reconstruction) -> selecting.Mask:
    """Return all pillars of the wrong layer that are connected to the one under the click."""
    grid = result.field.compartments.grid
    x, y = UPPER_HALF
    column, row = int((x - grid.west) / grid.cell_size), int((y - grid.south) / grid.cell_size)
    clicked = (grid.rows - 1 - row) * grid.columns + column
    seed = (result.field.compartment == clicked) & (result.layering.layer == WRONG)
    return selecting.connected(result, np.asarray(seed), selecting.Reach(layer=WRONG))


if __name__ == "__main__":
    main()
