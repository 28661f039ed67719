"""A plan: what an operation of the operator will come to, and the moves that do it."""

from __future__ import annotations

from dataclasses import dataclass

from stepfield.changes import renumbered
from stepfield.layers import UNASSIGNED
from stepfield.project import LayerStyle, Move, Project


@dataclass(frozen=True)
class Plan:
    """An operation and what will come of it.

    Attributes
    ----------
    text : str
        Name of the undo step.
    moves : tuple of Move
        Empty when nothing can be done, and in a forecast.
    moved, swapped, left, unassigned : int
        As in :class:`~stepfield.moves.Outcome`.
    locked : int
        Chosen pillars that stay because their layer is locked.
    stay : int
        Chosen pillars that stay because another one of their compartment goes, or is there already.
    reason : str
        Why nothing can be done, one sentence without a full stop.
    numbers : tuple of int
        What becomes of the layers' numbers, -1 for one that vanishes; empty where they stay.
    made : int, optional
        Number of the layer that is made.
    """

    text: str
    moves: tuple[Move, ...] = ()
    moved: int = 0
    swapped: int = 0
    left: int = 0
    locked: int = 0
    unassigned: int = 0
    stay: int = 0
    reason: str = ""
    numbers: tuple[int, ...] = ()
    made: int | None = None

    @property
    def sentence(self) -> str:
        """What would happen, as short as can be, or why nothing can: "move 212, swap 14, 3 locked"."""
        parts = (
            (f"move {in_threes(self.moved)}", self.moved),
            (f"swap {in_threes(self.swapped)}", self.swapped),
            (f"leave {in_threes(self.left)}", self.left),
            (f"{in_threes(self.unassigned)} to Unassigned", self.unassigned),
            (f"{in_threes(self.stay)} stay", self.stay),
            (f"{in_threes(self.locked)} locked", self.locked),
        )
        return self.reason or ", ".join(said for said, number in parts if number) or self.text

    def applied(self, project: Project) -> Project:
        """Return the project with the operation done; styles follow their layers."""
        moves = (*project.moves, *self.moves)
        return project.model_copy(update={"moves": moves, "layers": self._followed(project.layers)})

    def _followed(self, styles: tuple[LayerStyle, ...]) -> tuple[LayerStyle, ...]:
        """Renumber styles; one left from when there were more layers is not that of a layer made now."""
        if self.made is None and not self.numbers:
            return styles
        kept = [
            style.model_copy(update={"index": number})
            for style in styles
            if style.index != self.made and (number := renumbered(style.index, self.numbers)) != UNASSIGNED
        ]
        return tuple(sorted(kept, key=lambda style: style.index))


def in_threes(number: int) -> str:
    """Write a whole number with its digits in threes, as the window writes all of them: 12 431."""
    return f"{number:,}".replace(",", "\N{NARROW NO-BREAK SPACE}")
