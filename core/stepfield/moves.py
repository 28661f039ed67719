"""Moves made by hand, applied after the automatic layering: they are places in the world, not indices.

A pillar follows a move when more than half of its compartment lies within the move's rectangles and its
elevation span overlaps theirs; so edits survive another cell size or tolerance. What no longer resolves is
reported with its reason and kept in the project, to be tried again at the next run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.layers import UNASSIGNED, Layering
from stepfield.pillars import StepField
from stepfield.project import ExistingLayer, Move, NewLayer

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Metres by which places written to a file and read again may differ.
ROUNDING = 1e-6


@dataclass(frozen=True)
class Outcome:
    """What became of one move."""

    moved: int = 0
    swapped: int = 0
    left: int = 0  # found their place taken and stayed where they were
    reason: str = ""  # why nothing could be done; empty when the move resolved

    @property
    def resolved(self) -> bool:
        """Whether the move found its pillars and its layer."""
        return not self.reason


@dataclass(frozen=True)
class Edited:
    """A layering after the moves.

    Attributes
    ----------
    layering : Layering
    names : mapping of int to str
        Names of the layers that moves made.
    outcomes : tuple of Outcome
        One a move, in order.
    """

    layering: Layering
    names: dict[int, str]
    outcomes: tuple[Outcome, ...]


def apply_moves(field: StepField, layering: Layering, moves: Sequence[Move]) -> Edited:
    """Apply moves in order; they never renumber the layers.

    Parameters
    ----------
    field : StepField
    layering : Layering
        The automatic one.
    moves : sequence of Move
    """
    layer, count = layering.layer.copy(), layering.count
    names: dict[int, str] = {}
    outcomes = []
    for move in moves:
        following = pillars_in(field, move.boxes(), one_only=move.to != "unassigned")
        if not len(following):
            outcomes.append(Outcome(reason="no pillar is where the moved ones were"))
            continue
        target = _target(move, layer, count, names, field)
        if target is None:
            outcomes.append(Outcome(reason="there is no layer left to move to"))
            continue
        count = max(count, target + 1)
        outcomes.append(_put(layer, following, target, field, swap=move.conflict == "swap"))
    layer.flags.writeable = False
    return Edited(replace(layering, layer=layer, count=count), names, tuple(outcomes))


def _target(move: Move, layer: Integers, count: int, names: dict[int, str], field: StepField) -> int | None:
    """Find the layer a move goes to; a new one is the next number, None if there is none to go to."""
    match move.to:
        case "unassigned":
            return UNASSIGNED
        case NewLayer(new=name):
            known = [number for number, made in names.items() if made == name]
            if not known:
                names[count] = name
            return known[0] if known else count
        case ExistingLayer(layer=number, of=of) if number < of == count:
            return number
        case ExistingLayer(elevation=elevation):
            averages = Layering(layer, count).averages(field.elevation) + field.compartments.lowest
            if np.isnan(averages).all():
                return None
            return int(np.nanargmin(np.abs(averages - elevation)))


def _put(layer: Integers, following: Integers, target: int, field: StepField, *, swap: bool) -> Outcome:
    """Put pillars into a layer, keeping one pillar a compartment a layer."""
    movers = following[layer[following] != target]
    if target == UNASSIGNED:
        layer[movers] = UNASSIGNED
        return Outcome(moved=len(movers))
    present = np.flatnonzero(layer == target)
    place = np.searchsorted(field.compartment[present], field.compartment[movers])
    place = np.minimum(place, max(len(present) - 1, 0))
    taken = np.zeros(len(movers), bool)
    if len(present):
        taken = field.compartment[present[place]] == field.compartment[movers]
    if swap:
        layer[present[place[taken]]] = layer[movers[taken]]
    else:
        movers = movers[~taken]
    layer[movers] = target
    in_the_way = int(np.count_nonzero(taken))
    return Outcome(len(movers), swapped=in_the_way if swap else 0, left=0 if swap else in_the_way)


def pillars_in(field: StepField, boxes: Floats, *, one_only: bool) -> Integers:
    """Indices of the pillars that follow a move of ``boxes``, ascending.

    Parameters
    ----------
    field : StepField
    boxes : ndarray of shape (B, 6)
        x0, y0, x1, y1, z_low, z_high in scan coordinates, metres.
    one_only : bool
        Keep one pillar a compartment, the most overlapping one: two cannot go to the same layer.
    """
    grid, lowest = field.compartments.grid, field.compartments.lowest
    box, compartment, area = _covered(grid, boxes)
    box, pillar, area = _stacked(field, box, compartment, area)
    low, high = boxes[box, 4] - lowest, boxes[box, 5] - lowest
    overlap = np.minimum(high, field.high[pillar]) - np.maximum(low, field.low[pillar])
    meets = overlap >= -ROUNDING
    box, pillar, area, overlap = box[meets], pillar[meets], area[meets], overlap[meets]
    # A rectangle speaks for one pillar of a compartment: the one its elevation span overlaps most.
    order = np.lexsort((pillar, -overlap, field.compartment[pillar], box))
    spoken = order[_leads(box[order], field.compartment[pillar[order]])]
    share = np.bincount(pillar[spoken], area[spoken], minlength=len(field)) / grid.cell_size**2
    depth = np.bincount(pillar[spoken], overlap[spoken], minlength=len(field))
    following = np.flatnonzero(share > 0.5 + ROUNDING)
    if one_only:
        order = np.lexsort((following, -depth[following], field.compartment[following]))
        following = np.sort(following[order[_leads(field.compartment[following[order]])]])
    return following


def _leads(*keys: Integers) -> NDArray[np.bool_]:
    """Mask of the first of each run of equal keys."""
    changes = [np.diff(key, prepend=-1) != 0 for key in keys]
    leads: NDArray[np.bool_] = np.logical_or.reduce(changes)
    return leads


def _covered(grid: Grid, boxes: Floats) -> tuple[Integers, Integers, Floats]:
    """Pairs of box and compartment that share area: box index, compartment number, square metres."""
    edge = boxes[:, :4] - [grid.west, grid.south, grid.west, grid.south]
    first = np.floor(edge[:, :2] / grid.cell_size + ROUNDING).astype(np.int64)
    last = np.ceil(edge[:, 2:] / grid.cell_size - ROUNDING).astype(np.int64) - 1
    limit = np.array([grid.columns, grid.rows]) - 1
    first, last = np.maximum(first, 0), np.minimum(last, limit)
    wide, deep = np.maximum(last - first + 1, 0).T
    box = np.repeat(np.arange(len(boxes)), wide * deep)
    nth = np.arange(len(box)) - np.repeat(np.cumsum(wide * deep) - wide * deep, wide * deep)
    column = first[box, 0] + nth % wide[box]
    north = first[box, 1] + nth // wide[box]
    side = grid.cell_size
    across = np.minimum(edge[box, 2], (column + 1) * side) - np.maximum(edge[box, 0], column * side)
    along = np.minimum(edge[box, 3], (north + 1) * side) - np.maximum(edge[box, 1], north * side)
    return box, (grid.rows - 1 - north) * grid.columns + column, np.maximum(across * along, 0)


def _stacked(
    field: StepField, box: Integers, compartment: Integers, area: Floats
) -> tuple[Integers, Integers, Floats]:
    """Pair every box with all the pillars of the compartments it covers."""
    occupied = field.compartments.occupied
    place = np.minimum(np.searchsorted(occupied, compartment), len(occupied) - 1)
    held = np.where(occupied[place] == compartment, np.diff(field.first)[place], 0)
    repeated = np.repeat(np.arange(len(box)), held)
    nth = np.arange(len(repeated)) - np.repeat(np.cumsum(held) - held, held)
    return box[repeated], field.first[place[repeated]] + nth, area[repeated]
