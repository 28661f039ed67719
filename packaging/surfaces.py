"""Make the projects whose pictures SURFACES.md shows: the same scan, the paper's way and ours.

    python surfaces.py INCLINED RUBBLE FOLDER

INCLINED is a cloud of the scene ``inclined-plane``, RUBBLE one of ``rubble``; the projects go into FOLDER.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from stepfield.parameters import Parameters
from stepfield.project import Project, ScanFile

INCLINED = {"cell_size": 0.1, "layer_tolerance": 0.3}
PLANES = {"centre": (-1.0, 0.0, 1.4), "azimuth": -62.0, "elevation": 22.0, "distance": 17.0}
RUBBLE = {"outliers": "isolated", "layering": "surface"}
RECONSTRUCTION = {"shown": ["reconstruction"]}

#: Name, whether it is of the rubble, parameters, view.
PICTURES: tuple[tuple[str, bool, dict[str, Any], dict[str, Any]], ...] = (
    (
        "paper",
        False,
        INCLINED | {"layering": "elevation", "reconstruction": "simulator"},
        RECONSTRUCTION | {"camera": PLANES},
    ),
    (
        "surface",
        False,
        INCLINED | {"layering": "surface", "reconstruction": "edges"},
        RECONSTRUCTION | {"camera": PLANES},
    ),
    ("error", True, RUBBLE, RECONSTRUCTION | {"map": "error"}),
    ("obstacles", True, RUBBLE | {"walls": "layer"}, RECONSTRUCTION),
    ("complex", True, RUBBLE | {"complex_parts": "mesh"}, RECONSTRUCTION),
)


def main() -> None:
    """Write the projects."""
    inclined, rubble, folder = (Path(argument) for argument in sys.argv[1:])
    for name, of_rubble, parameters, view in PICTURES:
        scan = rubble if of_rubble else inclined
        project = Project(
            scans=(ScanFile(path=str(scan.resolve())),), parameters=Parameters(**parameters), view=view
        )
        project.save(folder / f"{name}.stepfield")


if __name__ == "__main__":
    main()
