"""Layers as triangle meshes: pillars, what a simulator draws, and what covers exactly the pillars' ground."""

from stepfield.surface.edges import as_edges
from stepfield.surface.losses import Loss, losses
from stepfield.surface.mesh import Mesh
from stepfield.surface.pillars import as_pillars
from stepfield.surface.sheets import Sheet, sheets
from stepfield.surface.simulator import as_simulator

__all__ = ["Loss", "Mesh", "Sheet", "as_edges", "as_pillars", "as_simulator", "losses", "sheets"]
