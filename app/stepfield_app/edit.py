"""The one undoable command: it holds the other project, and swaps."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtGui import QUndoCommand

from stepfield.project import Project


class Gesture:
    """From press to release: edits that carry the same gesture are one undo step."""


class Edit(QUndoCommand):
    """Swaps the document's project for another, and back.

    Parameters
    ----------
    text : str
        Name of the step.
    exchange : callable
        Takes the project to put in place and returns the one that was there.
    project : Project
        What the project becomes.
    gesture : object, optional
        Edits in a row with the same one are a single step.
    """

    def __init__(
        self, text: str, exchange: Callable[[Project], Project], project: Project, gesture: object | None
    ) -> None:
        super().__init__(text)
        self._exchange, self._gesture = exchange, gesture
        self._other = self._now = project

    def id(self) -> int:
        """All edits may be merged, if they are of one gesture."""
        return 1

    def redo(self) -> None:
        """Swap."""
        self._now, self._other = self._other, self._exchange(self._other)

    def undo(self) -> None:
        """Swap back."""
        self.redo()

    def mergeWith(self, other: QUndoCommand) -> bool:  # noqa: N802 - Qt's name
        """Take in a later edit of the same gesture; a gesture that ends where it began is no step."""
        if not isinstance(other, Edit) or self._gesture is None or other._gesture is not self._gesture:
            return False
        self._now = other._now
        self.setText(other.text())
        self.setObsolete(self._other == self._now)
        return True
