"""One move taken out from among others: those after it go on speaking of the layers they spoke of.

A merge, a removal, an exchange and a new layer give layers other numbers. Once such a move is gone, what
comes after it would find others by the same numbers. So the moves are followed twice, with it and without it;
each layer is known in both, and every later move is made to call it by the number it has without.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from stepfield.changes import Outcome, Unresolved
from stepfield.layers import UNASSIGNED, Layering
from stepfield.moves import Replay
from stepfield.pillars import StepField
from stepfield.progress import Progress, silent
from stepfield.project import ExistingLayer, LayerStyle, Move, Project


@dataclass(frozen=True)
class TakenOut:
    """What is left without a move, or why it has to stay.

    Attributes
    ----------
    moves : tuple of Move
        The others.
    reason : str
        Why it has to stay, one sentence without a full stop; empty where it need not.
    numbers : tuple of int
        What becomes of the layers' numbers, -1 for one that is there no more.
    count : int
        How many layers there are then.
    """

    moves: tuple[Move, ...] = ()
    reason: str = ""
    numbers: tuple[int, ...] = ()
    count: int = 0

    def applied(self, project: Project) -> Project:
        """Return the project without the move; styles follow their layers."""
        kept = [
            style.model_copy(update={"index": number})
            for style in project.layers
            if (number := self._number(style)) != UNASSIGNED
        ]
        layers = tuple(sorted(kept, key=lambda style: style.index))
        is_same = layers == project.layers
        update = {"moves": self.moves, "layers": project.layers if is_same else layers}
        return project.model_copy(update=update)

    def _number(self, style: LayerStyle) -> int:
        """Return the new number of a layer, of one there may be at other parameters too."""
        known = len(self.numbers)
        return self.numbers[style.index] if style.index < known else style.index + self.count - known


@dataclass(eq=False)
class _Course:
    """Layers by what they are while moves are applied: by their automatic number, or the name of new ones."""

    replay: Replay
    layers: list[int | str] = field(default_factory=list)

    @classmethod
    def of(cls, field: StepField, automatic: Layering) -> _Course:
        """Begin."""
        return cls(Replay(field, automatic), list(range(automatic.count)))

    def go_on(self, move: Move) -> Outcome:
        """Apply a move."""
        step = self.replay.go_on(move)
        if step.new is not None:
            self.layers.append(step.new)
        if step.numbers:
            pairs = zip(step.numbers, self.layers, strict=True)
            self.layers = [layer for number, layer in sorted(pairs) if number != UNASSIGNED]
        return step.outcome

    def meant(self, wanted: ExistingLayer) -> int | str | None:
        """Return which layer a move speaks of now."""
        try:
            number = self.replay.state.number(wanted)
        except Unresolved:
            return None
        return None if number is None else self.layers[number]


def take_out(
    field: StepField, automatic: Layering, moves: Sequence[Move], at: int, progress: Progress = silent
) -> TakenOut:
    """Take a move out from among others.

    Parameters
    ----------
    field : StepField
    automatic : Layering
        Before the moves.
    moves : sequence of Move
    at : int
        Which one.
    progress : Progress, optional

    Returns
    -------
    TakenOut
        With a reason where a later move would find its layer no more.
    """
    with_it, without = _Course.of(field, automatic), _Course.of(field, automatic)
    kept: list[Move] = []
    for nth, move in enumerate(moves):
        progress(nth / len(moves), "taking an edit out")
        if nth == at:
            with_it.go_on(move)
            continue
        same = _said_again(move, with_it, without) if nth > at else move
        kept.append(same)
        before, after = with_it.go_on(move), without.go_on(same)
        if before.resolved and not after.resolved:
            return TakenOut(reason=f"“{move.text}” would no longer fit: {after.reason}")
    there = {layer: number for number, layer in enumerate(without.layers)}
    numbers = tuple(there.get(layer, UNASSIGNED) for layer in with_it.layers)
    return TakenOut(tuple(kept), numbers=numbers, count=len(without.layers))


def _said_again(move: Move, with_it: _Course, without: _Course) -> Move:
    """Return a move that speaks of the same layers by the numbers they have without the one taken out."""
    counts = len(with_it.layers), len(without.layers)
    update = {}
    for part in ("to", "layer"):
        wanted = getattr(move, part)
        if not isinstance(wanted, ExistingLayer) or wanted.of not in counts:
            continue  # a layer by its elevation, which stays
        meant = with_it.meant(wanted)
        if meant in without.layers:
            number = without.layers.index(meant)
            update[part] = wanted.model_copy(update={"layer": number, "of": counts[1]})
    is_same = all(getattr(move, part) == wanted for part, wanted in update.items())
    return move if is_same else move.model_copy(update=update)
