"""The one undoable command. It holds what differs between two projects, not the projects."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from operator import is_
from typing import Any, NamedTuple

from PySide6.QtGui import QUndoCommand

from stepfield.project import Move, Project

#: Names of steps of an earlier window: of all that is no move, and of a move without a text.
RECALLED, UNNAMED = "Edits recovered", "Move pillars"
#: Moves of an earlier window that are steps of their own, the last ones: a list takes a millisecond for each.
MOST_STEPS = 200


class Gesture:
    """From press to release: edits that carry the same gesture are one undo step."""


class Value(NamedTuple):
    """A field of a project that differs."""

    name: str
    before: Any
    after: Any


@dataclass(frozen=True, slots=True)
class Change:
    """What differs between two projects.

    A project of ten thousand moves has ten thousand steps behind it: each holds the moves it adds or takes.

    Attributes
    ----------
    values : tuple of Value
        Whatever differs besides the moves.
    start : int
        Place of the first move that differs.
    removed, added : tuple of Move
        What stood there before, and what stands there afterwards.
    """

    values: tuple[Value, ...]
    start: int
    removed: tuple[Move, ...]
    added: tuple[Move, ...]

    @classmethod
    def between(cls, before: Project, after: Project) -> Change:
        """Return what leads from one project to another."""
        values = tuple(
            Value(name, old, new)
            for name in Project.model_fields
            if name != "moves" and (old := getattr(before, name)) != (new := getattr(after, name))
        )
        old_moves, new_moves = before.moves, after.moves
        start = _alike(old_moves, new_moves)
        behind = _alike(old_moves[start:][::-1], new_moves[start:][::-1])
        old, new = slice(start, len(old_moves) - behind), slice(start, len(new_moves) - behind)
        return cls(values, start, old_moves[old], new_moves[new])

    @property
    def is_none(self) -> bool:
        """Whether it leads nowhere."""
        return not self.values and self.removed == self.added

    def applied(self, project: Project) -> Project:
        """Go from before to after."""
        values = {value.name: value.after for value in self.values}
        return project.model_copy(update=values | self._moves(project, self.removed, self.added))

    def reverted(self, project: Project) -> Project:
        """Go from after to before."""
        values = {value.name: value.before for value in self.values}
        return project.model_copy(update=values | self._moves(project, self.added, self.removed))

    def _moves(
        self, project: Project, old: Sequence[Move], new: tuple[Move, ...]
    ) -> dict[str, tuple[Move, ...]]:
        if not old and not new:
            return {}
        moves = project.moves
        return {"moves": (*moves[: self.start], *new, *moves[self.start + len(old) :])}


class Edit(QUndoCommand):
    """Takes the document's project a step further, and back.

    Parameters
    ----------
    text : str
        Name of the step.
    change : Change
        From the present project to the next.
    present : callable
        Returns the document's project.
    place : callable
        Puts another one in its place.
    gesture : object, optional
        Edits in a row with the same one are a single step.
    is_done : bool
        Whether the present project is the next one already: a step of an earlier window.
    """

    def __init__(
        self,
        text: str,
        change: Change,
        present: Callable[[], Project],
        place: Callable[[Project], None],
        gesture: object | None = None,
        is_done: bool = False,
    ) -> None:
        super().__init__(text)
        self._is_done = is_done
        self._change, self._present, self._place, self._gesture = change, present, place, gesture

    def id(self) -> int:
        """All edits may be merged, if they are of one gesture."""
        return 1

    def redo(self) -> None:
        """Do it."""
        if self._is_done:
            self._is_done = False
            return
        self._place(self._change.applied(self._present()))

    def undo(self) -> None:
        """Take it back."""
        self._place(self._change.reverted(self._present()))

    def mergeWith(self, other: QUndoCommand) -> bool:  # noqa: N802 - Qt's name
        """Take in a later edit of the same gesture; a gesture that ends where it began is no step."""
        if not isinstance(other, Edit) or self._gesture is None or other._gesture is not self._gesture:
            return False
        after = self._present()
        before = self._change.reverted(other._change.reverted(after))
        self._change = Change.between(before, after)
        self.setText(other.text())
        self.setObsolete(self._change.is_none)
        return True


def recalled(project: Project, saved: Project | None) -> Iterator[tuple[str, Change]]:
    """Return steps that lead to a project that an earlier window has left: a name and what changes in each.

    The last moves are steps as they were; what else differs from the saved project is one, before them.

    Parameters
    ----------
    project : Project
    saved : Project, optional
        What was saved; without it, all moves and layers are new.
    """
    before, moves = saved or project.model_copy(update={"moves": (), "layers": ()}), project.moves
    kept = _equal(before.moves, moves)
    first = max(kept, len(moves) - MOST_STEPS)
    here = {"scans": project.scans, "view": project.view, "moves": (*moves[:kept], *before.moves[kept:])}
    rest = Change.between(before.model_copy(update=here), project.model_copy(update={"moves": moves[:first]}))
    if not rest.is_none:
        yield RECALLED, rest
    for at in range(first, len(moves)):
        yield moves[at].text or UNNAMED, Change((), at, (), (moves[at],))


def _equal(one: Sequence[Move], other: Sequence[Move]) -> int:
    """Count the moves at the beginning that are equal."""
    differs = (at for at, pair in enumerate(zip(one, other, strict=False)) if pair[0] != pair[1])
    return next(differs, min(len(one), len(other)))


def _alike(one: Sequence[Move], other: Sequence[Move]) -> int:
    """Count the moves at the beginning that are the very same ones; a million boxes are not compared."""
    same = list(map(is_, one, other))
    return same.index(False) if False in same else len(same)
