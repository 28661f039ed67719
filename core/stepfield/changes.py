"""What one move does to a layering: found without doing it, so that it can be said before.

Layers are found by number while there are as many as there were, else by elevation; those that moves made,
by name.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import UNASSIGNED, Layering
from stepfield.pillars import StepField
from stepfield.places import Coverage, covered, occupants
from stepfield.project import AnyLayer, Conflict, ExistingLayer, Move, NewLayer

Integers = NDArray[np.int64]


def _none() -> Integers:
    return np.zeros(0, np.int64)


@dataclass(frozen=True)
class Outcome:
    """What became of one move."""

    moved: int = 0
    swapped: int = 0
    left: int = 0  # found their place taken and stayed where they were
    unassigned: int = 0  # lost their place to a fuller pillar, or their layer
    reason: str = ""  # why nothing could be done; empty when the move resolved

    @property
    def resolved(self) -> bool:
        """Whether the move found its pillars and its layer."""
        return not self.reason


@dataclass(frozen=True, eq=False)
class Claim:
    """What a move claims for a layer: all that its rectangles cover, not only what follows it."""

    coverage: Coverage
    target: int
    following: Integers


@dataclass(frozen=True)
class Change:
    """What a move does to a layering.

    Attributes
    ----------
    outcome : Outcome
    pillars, layers : ndarray of shape (n,), int64
        Pillars, each once, and the layer each of them goes to.
    made : str, optional
        Name of a layer that is made first, with the next number.
    numbers : tuple of int
        What becomes of the numbers of all layers in the end, ``UNASSIGNED`` for one that vanishes; empty
        where they stay.
    claim : Claim, optional
        What a move of pillars found, whatever became of it.
    """

    outcome: Outcome
    pillars: Integers = field(default_factory=_none)
    layers: Integers = field(default_factory=_none)
    made: str | None = None
    numbers: tuple[int, ...] = ()
    claim: Claim | None = None


class Unresolved(Exception):
    """A move found no pillars or no layer; says why."""


@dataclass(frozen=True)
class State:
    """A layering between two moves.

    Attributes
    ----------
    field : StepField
    layer : ndarray of shape (P,), int64
        Layer of each pillar.
    count : int
        Number of layers.
    made : dict of int to str
        Names of the layers that moves made.
    obstacles : tuple of int
        Which layers are obstacles.
    """

    field: StepField
    layer: Integers
    count: int
    made: dict[int, str]
    obstacles: tuple[int, ...] = ()

    def number(self, wanted: AnyLayer) -> int | None:
        """Find a layer; None for one that is not made yet."""
        match wanted:
            case NewLayer(new=name):
                return next((number for number, made in self.made.items() if made == name), None)
            case ExistingLayer(layer=number, of=of) if number < of == self.count:
                if (number in self.obstacles) == (wanted.kind is not None):
                    return number
        return self._nearest(wanted)

    def _nearest(self, wanted: ExistingLayer) -> int:
        """Find the layer of the kind that is nearest in elevation."""
        averages = Layering(self.layer, self.count).averages(self.field.elevation)
        is_other = np.isin(np.arange(self.count), self.obstacles) == (wanted.kind is None)
        averages[is_other] = np.nan
        if np.isnan(averages).all():
            kind = "layer" if wanted.kind is None else "layer of obstacles"
            raise Unresolved(f"there is no {kind} left to move to")
        return int(np.nanargmin(np.abs(averages + self.field.compartments.lowest - wanted.elevation)))

    def members(self, layer: int, above: float | None = None) -> Integers:
        """Indices of the pillars of a layer, or of those of it that lie above an elevation, metres."""
        members = np.flatnonzero(self.layer == layer)
        if above is not None:
            members = members[self.field.elevation[members] > above - self.field.compartments.lowest]
        return members


def change_of(state: State, move: Move) -> Change:
    """Find what a move does, without doing it."""
    try:
        if move.layer is not None:
            return _of_layer(state, move, move.layer)
        return _of_pillars(state, move)
    except Unresolved as why:
        return Change(Outcome(reason=str(why)))


def _of_pillars(state: State, move: Move) -> Change:
    """Move pillars that are found by their places; none at all make an empty layer."""
    if not len(move.pillars) and isinstance(move.to, NewLayer):
        is_known = state.number(move.to) is not None
        return Change(Outcome(), made=None if is_known else move.to.new)
    coverage = covered(state.field, move.boxes())
    pillars = coverage.following(state.field, one_only=move.to != "unassigned")
    if not len(pillars):
        raise Unresolved("no pillar is where the moved ones were")
    target, made = _target(state, move)
    claim = Claim(coverage, target, pillars)
    return replace(put(state, pillars, target, move.conflict), made=made, claim=claim)


def _of_layer(state: State, move: Move, layer: AnyLayer) -> Change:
    """Exchange, merge or remove a layer, or move pillars of it."""
    source = state.number(layer)
    if source is None:
        raise Unresolved("the layer to take the pillars from is not there")
    target, made = _target(state, move)
    if target == source:
        raise Unresolved("the two layers have become one")
    count = state.count + (made is not None)
    if move.conflict == "exchange":
        return replace(_exchange(state, source, target, count), made=made)
    pillars = state.members(source, move.above)
    if move.above is not None and not len(pillars):
        raise Unresolved(f"no pillar of the layer lies above {move.above:.6g} m")
    change = replace(put(state, pillars, target, move.conflict), made=made)
    if move.above is None and (target == UNASSIGNED or move.conflict == "fewest"):
        change = replace(change, numbers=_without(source, count))
    if change.numbers and target == UNASSIGNED:
        change = replace(change, outcome=Outcome(unassigned=len(pillars)))
    return change


def _target(state: State, move: Move) -> tuple[int, str | None]:
    """Find the layer a move goes to, and the name of one that has to be made for it."""
    if move.to == "unassigned":
        return UNASSIGNED, None
    number = state.number(move.to)
    if number is not None:
        return number, None
    return state.count, move.to.new if isinstance(move.to, NewLayer) else None


def _exchange(state: State, one: int, other: int, count: int) -> Change:
    numbers = list(range(count))
    numbers[one], numbers[other] = other, one
    moved, swapped = (int(np.count_nonzero(state.layer == layer)) for layer in (one, other))
    return Change(Outcome(moved=moved, swapped=swapped), numbers=tuple(numbers))


def _without(layer: int, count: int) -> tuple[int, ...]:
    """Return the numbers of ``count`` layers once one of them has vanished."""
    if count == 1:
        raise Unresolved("the last layer has to stay")
    return tuple(UNASSIGNED if n == layer else n - (n > layer) for n in range(count))


def put(state: State, pillars: Integers, target: int, conflict: Conflict) -> Change:
    """Put pillars into a layer, keeping one pillar a compartment a layer.

    Parameters
    ----------
    state : State
    pillars : ndarray of shape (n,), int64
        At most one a compartment unless they become unassigned.
    target : int
    conflict : str
        As in :class:`Move`.
    """
    layer = state.layer
    movers = pillars[layer[pillars] != target]
    if target == UNASSIGNED:
        return Change(Outcome(moved=len(movers)), movers, np.full(len(movers), UNASSIGNED))
    present = occupants(state.field, layer, movers, target)
    taken = present >= 0
    in_the_way = int(np.count_nonzero(taken))
    if conflict == "leave":
        movers = movers[~taken]
        return Change(Outcome(len(movers), left=in_the_way), movers, np.full(len(movers), target))
    wins = np.ones(len(movers), bool)
    others, to = present[taken], layer[movers[taken]]
    if conflict == "fewest":
        wins[taken] = _is_fuller(state.field, movers[taken], others)
        others, to = present[taken & wins], np.full(np.count_nonzero(taken & wins), UNASSIGNED)
        outcome = Outcome(int(np.count_nonzero(wins)), unassigned=in_the_way)
    else:
        outcome = Outcome(len(movers), swapped=in_the_way)
    layers = np.concatenate([np.where(wins, target, UNASSIGNED), to])
    return Change(outcome, np.concatenate([movers, others]), layers)


def _is_fuller(field: StepField, one: Integers, other: Integers) -> NDArray[np.bool_]:
    """Whether a pillar has more points than another of its compartment; ties to the lower one."""
    mine, theirs = (field.start[pillars + 1] - field.start[pillars] for pillars in (one, other))
    fuller: NDArray[np.bool_] = (mine > theirs) | ((mine == theirs) & (one < other))
    return fuller


def renumbered(number: int, numbers: tuple[int, ...]) -> int:
    """Return what becomes of a layer's number, layers there may be at other parameters included."""
    return numbers[number] if number < len(numbers) else number - numbers.count(UNASSIGNED)
