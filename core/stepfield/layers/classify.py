"""Classification of pillars into layers (paper 5.3): one pillar a compartment a layer, always."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.choice import layer_count, strongest
from stepfield.layers.elevation import by_elevation
from stepfield.layers.layering import Layering
from stepfield.layers.surface import by_surface
from stepfield.layers.towers import Towers
from stepfield.links import link
from stepfield.pillars import StepField

Method = Literal["rank", "elevation", "surface"]
#: Gives the linked pairs among the pillars of a mask, as :func:`stepfield.links.link` does.
Linked = Callable[[NDArray[np.bool_]], NDArray[np.int64]]


def classify(
    field: StepField,
    method: Method = "elevation",
    *,
    linked: Linked | None = None,
    min_points: int = 1,
    max_layers: int | Literal["auto", "none"] = "auto",
    leaving_out: NDArray[np.bool_] | None = None,
) -> Layering:
    """Give every pillar its layer.

    Parameters
    ----------
    field : StepField
    method : str
        ``rank``: in order of creation, from the lowest. ``elevation``: the paper's 5.3.3. ``surface``: a
        continuous surface stays in one layer although it crosses the elevations of others.
    linked : callable, optional
        Finds the neighbours that continue each other, which is all that ``surface`` goes by; by default
        those that differ by no more than the layer tolerance.
    min_points : int
        Pillars of fewer points are left unassigned.
    max_layers : int, "auto" or "none"
        At most this many layers; in a compartment with more pillars those of the fewest points
        (ties: the higher) are left unassigned. ``none`` is the paper's.
    leaving_out : ndarray of shape (P,), bool, optional
        Pillars that are left unassigned as if they were not there.

    Returns
    -------
    Layering
        Layers numbered by ascending average elevation (``elevation``), by rank, or so that each surface is
        as low as those beneath it let it be (``surface``).
    """
    enough = field.points >= min_points
    if leaving_out is not None:
        enough &= ~leaving_out
    count = layer_count(field, enough, max_layers)
    towers = Towers.of(field, strongest(field, enough, count))
    if method == "elevation" and count:
        layering = by_elevation(towers, count)
    elif method == "surface" and count:
        layering = Layering(towers.spread(_by_surface(field, towers, count, linked)), count)
    else:
        layering = Layering(towers.spread(towers.ranks()), count)
    layering.layer.flags.writeable = False
    return layering


def _by_surface(field: StepField, towers: Towers, count: int, linked: Linked | None) -> NDArray[np.int64]:
    chosen = np.zeros(len(field), bool)
    chosen[towers.chosen] = True
    links = link(field, chosen, field.layer_tolerance) if linked is None else linked(chosen)
    number = np.cumsum(chosen) - 1
    return by_surface(field.compartments.grid, towers, number[links], count)
