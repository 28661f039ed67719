"""The mesh of the complex parts in the targets: what it is called, and who cannot have it."""

from __future__ import annotations

from stepfield.targets.terrain import Terrain

#: What its files and bodies are called, beside those of layers.
LABEL = "complex"
#: What people read.
TITLE = "Complex parts"


def left_out(terrain: Terrain) -> list[str]:
    """Say that a target has no place for the mesh, if there is one."""
    if terrain.complex_mesh is None or terrain.manifest.complex is None:
        return []
    return [
        f"the mesh of the complex parts has no place here: the layers have holes where it stands "
        f"in for {terrain.manifest.complex.pillars:,} pillars; build the stack with --complex off"
    ]
