"""What an operation of the operator would do to pillars and layers, said before it is done.

A plan holds the moves that do it and what they will come to: applying them to the same layering has exactly
these counts.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace
from itertools import count
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield.changes import Outcome, State, change_of, put
from stepfield.layers import UNASSIGNED
from stepfield.margins import margins
from stepfield.pillars import StepField
from stepfield.places import best_of_runs
from stepfield.plan import Plan as Plan
from stepfield.plan import in_threes
from stepfield.project import AnyLayer, ExistingLayer, LayerStyle, Move, NewLayer
from stepfield.reconstruction import Reconstruction

Mask = NDArray[np.bool_]
Integers = NDArray[np.int64]


def move_to(
    result: Reconstruction,
    chosen: Mask,
    target: int | str,
    *,
    conflict: Literal["swap", "leave"] = "swap",
    locked: Collection[int] = (),
) -> Plan:
    """Plan to put pillars into a layer; of those of one compartment the one with the most points goes.

    Parameters
    ----------
    result : Reconstruction
    chosen : ndarray of shape (P,), bool
    target : int or str
        A layer, -1 for Unassigned, or the name of a new layer.
    conflict : str
        Whether pillars that stand where others go swap with them, or are left where they are.
    locked : collection of int
        Layers that nothing goes into or out of.
    """
    plan, going = _weighed(result, chosen, target, conflict, locked)
    if not plan.moved:
        return plan
    layer = result.layering.layer
    move = Move(
        text=plan.text,
        to=_destination(result, target, going),
        conflict=conflict,
        pillars=np.vstack([result.field.boxes(going), margins(result.field, layer, going)]),
    )
    return replace(plan, moves=(move,))


def forecast(
    result: Reconstruction,
    chosen: Mask,
    target: int | str,
    *,
    conflict: Literal["swap", "leave"] = "swap",
    locked: Collection[int] = (),
) -> Plan:
    """Return :func:`move_to` without its moves: what would come of it, at a fraction of the work."""
    return _weighed(result, chosen, target, conflict, locked)[0]


def _weighed(
    result: Reconstruction,
    chosen: Mask,
    target: int | str,
    conflict: Literal["swap", "leave"],
    locked: Collection[int],
) -> tuple[Plan, Integers]:
    """Count what a move would come to; also say which pillars go."""
    number, name = (
        (len(result.layers), target) if isinstance(target, str) else (target, _name(result, target))
    )
    reason = _why_no_name(result, target) if isinstance(target, str) else _why_locked(result, locked, target)
    if reason:
        return Plan(f"Move pillars to {name}", reason=reason), np.zeros(0, np.int64)
    state, pillars = _state(result), np.flatnonzero(chosen)
    free = pillars[~_is_locked(state, pillars, locked)]
    going = _going(state, free, number)
    change = put(state, going, number, conflict)
    plan = replace(
        _counted(change.outcome),
        text=f"Move {_pillars(change.outcome.moved)} to {name}",
        locked=len(pillars) - len(free),
        stay=int(np.count_nonzero(state.layer[free] != number)) - len(going),
        made=number if isinstance(target, str) else None,
    )
    if not change.outcome.moved:
        plan = replace(plan, made=None, reason=_why_none_goes(plan, len(pillars), name))
    return plan, going


def merge(result: Reconstruction, source: int, target: int, locked: Collection[int] = ()) -> Plan:
    """Plan to put all of a layer into another one; the fuller one of two pillars gets the place."""
    text = f"Merge {_name(result, source)} into {_name(result, target)}"
    if source == target:
        return Plan(text, reason="a layer cannot be merged into itself")
    if reason := _why_no_layer(source, target) or _why_locked(result, locked, source, target):
        return Plan(text, reason=reason)
    layer, to = _reference(result, source), _reference(result, target)
    return _planned(result, Move(text=text, layer=layer, to=to, conflict="fewest"))


def split(
    result: Reconstruction, layer: int, elevation: float, name: str, locked: Collection[int] = ()
) -> Plan:
    """Plan to put the pillars of a layer above an elevation, scan coordinates, metres, into a new layer."""
    text = f"Split {_name(result, layer)} at {elevation:.3f} m"
    reason = _why_no_layer(layer) or _why_locked(result, locked, layer) or _why_no_name(result, name)
    if reason:
        return Plan(text, reason=reason)
    move = Move(text=text, layer=_reference(result, layer), above=elevation, to=NewLayer(new=name))
    plan = _planned(result, move)
    if plan.moved == len(result.layers[layer].pillars):
        return Plan(text, reason=plan.reason or f"all pillars of {_name(result, layer)} lie above")
    return plan


def new_layer(result: Reconstruction, name: str) -> Plan:
    """Plan to make an empty layer."""
    text = f"Add {name}"
    if reason := _why_no_name(result, name):
        return Plan(text, reason=reason)
    return _planned(result, Move(text=text, to=NewLayer(new=name)))


def exchange(result: Reconstruction, layer: int, other: int) -> Plan:
    """Plan to let two layers exchange their numbers."""
    text = f"Exchange {_name(result, layer)} and {_name(result, other)}"
    if layer == other:
        return Plan(text, reason="a layer cannot change places with itself")
    if reason := _why_no_layer(layer, other):
        return Plan(text, reason=reason)
    one, to = _reference(result, layer), _reference(result, other)
    return _planned(result, Move(text=text, layer=one, to=to, conflict="exchange"))


def remove(result: Reconstruction, layer: int, locked: Collection[int] = ()) -> Plan:
    """Plan to take a layer away; its pillars become unassigned."""
    text = f"Remove {_name(result, layer)}"
    if reason := _why_no_layer(layer) or _why_locked(result, locked, layer):
        return Plan(text, reason=reason)
    return _planned(result, Move(text=text, layer=_reference(result, layer), to="unassigned"))


def free_name(result: Reconstruction, styles: Iterable[LayerStyle] = ()) -> str:
    """Return a name for a new layer that no layer has, nor had for moves: Layer 4."""
    taken = _names(result) | {style.name for style in styles if style.name}
    numbered = (f"Layer {number}" for number in count(len(result.layers) + 1))
    return next(name for name in numbered if name not in taken)


def _planned(result: Reconstruction, move: Move) -> Plan:
    """Plan one move of whole layers."""
    change = change_of(_state(result), move)
    if not change.outcome.resolved:
        return Plan(move.text, reason=change.outcome.reason)
    return replace(
        _counted(change.outcome),
        text=move.text,
        moves=(move,),
        numbers=change.numbers,
        made=None if change.made is None else len(result.layers),
    )


def _counted(outcome: Outcome) -> Plan:
    counts = {name: getattr(outcome, name) for name in ("moved", "swapped", "left", "unassigned")}
    return Plan("", **counts)


def _state(result: Reconstruction) -> State:
    layering = result.layering
    return State(result.field, layering.layer, layering.count, result.made, layering.obstacles)


def _going(state: State, pillars: Integers, target: int) -> Integers:
    """Of pillars in ascending order, those that go to a layer: one a compartment."""
    layer = state.layer[pillars]
    if target == UNASSIGNED:
        assigned: Integers = pillars[layer != UNASSIGNED]
        return assigned
    points = _points(state.field, pillars)
    points[layer == target] = np.iinfo(np.int64).max  # what is there has the first claim
    winners = pillars[best_of_runs(state.field.compartment[pillars], points)]
    going: Integers = winners[state.layer[winners] != target]
    return going


def _points(field: StepField, pillars: Integers) -> Integers:
    points: Integers = field.start[pillars + 1] - field.start[pillars]
    return points


def _is_locked(state: State, pillars: Integers, locked: Collection[int]) -> Mask:
    locks = np.zeros(state.count + 1, bool)  # the last one is of Unassigned
    locks[[layer for layer in locked if 0 <= layer < state.count]] = True
    is_locked: Mask = locks[state.layer[pillars]]
    return is_locked


def _destination(
    result: Reconstruction, target: int | str, going: Integers
) -> AnyLayer | Literal["unassigned"]:
    """Say where pillars go; an empty layer is known by the elevation of those that go there."""
    if isinstance(target, str):
        return NewLayer(new=target)
    if target == UNASSIGNED:
        return "unassigned"
    return _reference(result, target, float(result.field.elevation[going].mean()))


def _reference(result: Reconstruction, layer: int, fallback: float = 0.0) -> AnyLayer:
    """Say which layer is meant in words that hold after a re-run; ``fallback``: elevation of an empty one."""
    if layer in result.made:
        return NewLayer(new=result.made[layer])
    elevation = result.layers[layer].elevation
    average = float(elevation.mean()) if len(elevation) else fallback
    lowest = result.field.compartments.lowest
    kind: Literal["obstacles"] | None = "obstacles" if layer in result.layering.obstacles else None
    return ExistingLayer(layer=layer, of=len(result.layers), elevation=lowest + average, kind=kind)


def _name(result: Reconstruction, layer: int) -> str:
    return "Unassigned" if layer == UNASSIGNED else result.layers[layer].name


def _names(result: Reconstruction) -> set[str]:
    return {layer.name for layer in result.layers} | set(result.made.values())


def _pillars(number: int) -> str:
    return f"{number} pillar" if number == 1 else f"{in_threes(number)} pillars"


def _why_no_name(result: Reconstruction, name: str) -> str:
    return f"there is a layer {name} already" if name in _names(result) else ""


def _why_no_layer(*layers: int) -> str:
    return "Unassigned is no layer" if UNASSIGNED in layers else ""


def _why_locked(result: Reconstruction, locked: Collection[int], *layers: int) -> str:
    name = next((_name(result, layer) for layer in layers if layer in locked), None)
    return f"{name} is locked" if name else ""


def _why_none_goes(plan: Plan, chosen: int, name: str) -> str:
    if not chosen:
        return "nothing is selected"
    if plan.left:
        return f"all places in {name} are taken"
    if plan.locked:
        return "the selected pillars are in locked layers"
    return f"the selected pillars are in {name} already"
