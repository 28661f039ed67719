"""Layers: which pillar belongs to which surface above another (paper 5.3)."""

from stepfield.layers.choice import layer_count, strongest
from stepfield.layers.classify import Method, classify
from stepfield.layers.elevation import cheapest_layers
from stepfield.layers.layering import UNASSIGNED, Layering

__all__ = [
    "UNASSIGNED",
    "Layering",
    "Method",
    "cheapest_layers",
    "classify",
    "layer_count",
    "strongest",
]
