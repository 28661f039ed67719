"""Moves made by hand, applied after the automatic layering: they are places in the world, not indices.

A pillar follows a move when more than half of its compartment lies within the move's rectangles and its
elevation span overlaps theirs; so edits survive another cell size or tolerance. A compartment that several
moves share goes by what each of them covers in the end. What no longer resolves is
reported with its reason and kept in the project, to be tried again at the next run. One move more, one
undone or one redone costs what that move touches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.bits import Before, Bits
from stepfield.changes import Outcome as Outcome
from stepfield.changes import State, change_of, renumbered
from stepfield.layers import UNASSIGNED, Layering
from stepfield.pillars import StepField
from stepfield.places import pillars_in as pillars_in
from stepfield.progress import Progress, silent
from stepfield.project import Move


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


@dataclass(frozen=True)
class Step:
    """A move that was applied, and what is needed to take it back.

    Attributes
    ----------
    move : Move
    outcome : Outcome
    pillars, layers, went : ndarray of shape (n,)
        The pillars it changed, the layers they were in and those they went to, in as few bytes as will do.
    new : str, optional
        Name of the layer that it made.
    numbers : tuple of int
        As in :class:`Change`.
    count : int
    made : dict of int to str
    obstacles : tuple of int
        Of the layering before.
    bits : Before or None
        Of the compartments that moves cover in part.
    """

    move: Move
    outcome: Outcome
    pillars: NDArray[Any]
    layers: NDArray[Any]
    went: NDArray[Any]
    new: str | None
    numbers: tuple[int, ...]
    count: int
    made: dict[int, str]
    obstacles: tuple[int, ...]
    bits: Before | None = None


class Replay:
    """The moves of a project on one automatic layering. Remembers the last ones; for one thread at a time.

    Parameters
    ----------
    field : StepField
    automatic : Layering
    """

    def __init__(self, field: StepField, automatic: Layering) -> None:
        self._automatic = automatic
        self._state = State(field, automatic.layer.copy(), automatic.count, {}, automatic.obstacles)
        self._bits = Bits(field)
        self._steps: list[Step] = []
        self._taken: list[Step] = []  # taken back since the last move that was new, the first one last

    def edited(self, moves: Sequence[Move], progress: Progress = silent) -> Edited:
        """Apply a sequence of moves instead of the last one.

        What both begin with stays; the rest of the last one is taken back. The result is that of applying
        all of them to the automatic layering.
        """
        kept = self._shared_with(moves)
        while len(self._steps) > kept:
            self._taken.append(self._steps.pop())
            self._take_back(self._taken[-1])
        for nth, move in enumerate(moves[kept:], start=kept):
            progress(nth / len(moves), "applying moves")
            self._steps.append(self._again(move) or self._applied(move))
        layer = self._state.layer.copy()
        layer.flags.writeable = False
        state = self._state
        layering = replace(self._automatic, layer=layer, count=state.count, obstacles=state.obstacles)
        return Edited(layering, dict(self._state.made), tuple(step.outcome for step in self._steps))

    @property
    def state(self) -> State:
        """The layering as it is now; the next move changes it."""
        return self._state

    def go_on(self, move: Move) -> Step:
        """Apply one move more."""
        self._taken.clear()
        self._steps.append(step := self._applied(move))
        return step

    def _shared_with(self, moves: Sequence[Move]) -> int:
        """Count the moves at the beginning that are those of the last sequence."""
        pairs = zip(self._steps, moves, strict=False)
        other = (n for n, (step, move) in enumerate(pairs) if step.move is not move and step.move != move)
        return next(other, min(len(self._steps), len(moves)))

    def _again(self, move: Move) -> Step | None:
        """Do a step once more that was the next one to be taken back; None for any other move."""
        step = self._taken.pop() if self._taken else None
        if step is None or step.bits is not None or (step.move is not move and step.move != move):
            self._taken.clear()
            return None
        self._do(step)
        return step

    def _applied(self, move: Move) -> Step:
        state = self._state
        change, bits = self._bits.followed(state, move, change_of(state, move))
        # Thousands of steps are kept: bytes count.
        few = np.min_scalar_type(-state.count - 2)
        step = Step(
            move,
            change.outcome,
            pillars=change.pillars.astype(np.min_scalar_type(len(state.field))),
            layers=state.layer[change.pillars].astype(few),
            went=change.layers.astype(few),
            new=change.made,
            numbers=change.numbers,
            count=state.count,
            made=state.made,
            obstacles=state.obstacles,
            bits=bits,
        )
        self._do(step)
        return step

    def _do(self, step: Step) -> None:
        self._state.layer[step.pillars] = step.went
        _renumber(self._state.layer, step.numbers)
        self._state = _after(self._state, step)

    def _take_back(self, step: Step) -> None:
        layer, vanished = self._state.layer, step.numbers.count(UNASSIGNED)
        _renumber(layer, tuple(np.argsort(step.numbers)[vanished:].tolist()))
        layer[step.pillars] = step.layers
        self._bits.take_back(step.bits)
        self._state = replace(self._state, count=step.count, made=step.made, obstacles=step.obstacles)


def apply_moves(field: StepField, layering: Layering, moves: Sequence[Move]) -> Edited:
    """Apply moves in order.

    Parameters
    ----------
    field : StepField
    layering : Layering
        The automatic one.
    moves : sequence of Move
    """
    return Replay(field, layering).edited(moves)


def _renumber(layer: NDArray[np.int64], numbers: tuple[int, ...]) -> None:
    """Give all pillars the new number of their layer, in place."""
    if numbers:
        layer[:] = np.array([*numbers, UNASSIGNED])[layer]  # -1 finds the last entry


def _after(state: State, step: Step) -> State:
    """Return the state with other layers, the same ``layer`` array in it."""
    made, count, obstacles = state.made, state.count, state.obstacles
    if step.new is not None:
        made, count = made | {count: step.new}, count + 1
    if step.numbers:
        numbers = step.numbers
        made = {renumbered(n, numbers): name for n, name in made.items() if numbers[n] != UNASSIGNED}
        obstacles = tuple(sorted(numbers[n] for n in obstacles if numbers[n] != UNASSIGNED))
    return replace(state, count=count - step.numbers.count(UNASSIGNED), made=made, obstacles=obstacles)
