"""Saves the document on a worker; what it writes is a snapshot, so that work can go on meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from stepfield.progress import Progress
from stepfield_app.document import Document
from stepfield_app.filed import Stored, Work
from stepfield_app.newest import NewestWins
from stepfield_app.saving.write import ChangedByAnother, Save, write


@dataclass(frozen=True, eq=False)
class _Wish:
    """A save, the work it belongs to, and what is to be done after it."""

    save: Save
    work: Work
    then: Callable[[], object] | None


class Saving(QObject):
    """Writes the document's project to its file, or to another one.

    Parameters
    ----------
    document : Document
    look : callable
        Returns how the project is looked at, to be stored in its ``view``.
    parent : QObject, optional
    """

    saved = Signal(object)  # Path
    refused = Signal(object)  # Path of a file that another has changed: nothing was written
    failed = Signal(object)  # exception; nothing was written, the old file is whole
    busy_changed = Signal(bool)

    def __init__(
        self, document: Document, look: Callable[[], dict[str, Any]] = dict, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._document, self._look = document, look
        self._worker = NewestWins[_Wish, Stored](_write, "saving", self)
        self._worker.answered.connect(self._note)
        self._worker.failed.connect(self._fail)
        self._worker.busy_changed.connect(self.busy_changed)

    @property
    def busy(self) -> bool:
        """Whether anything is being written."""
        return self._worker.busy

    def save(
        self,
        path: Path | None = None,
        *,
        over_another: bool = False,
        then: Callable[[], object] | None = None,
    ) -> None:
        """Save the project as it is now.

        Parameters
        ----------
        path : Path, optional
            Another file than the project's own; whatever lies there is replaced.
        over_another : bool
            Whether the project's own file is replaced even if another has changed it.
        then : callable, optional
            Called once it is written, and only then.
        """
        document, stored, answer = self._document, self._document.file.stored, self._document.answer
        if stored is None and path is None:
            raise ValueError("a project that has no file needs a path")
        place = path.absolute() if path else stored.path if stored else Path()
        is_own = stored is not None and place == stored.path and path is None
        expected = stored.sha256 if stored and is_own and not over_another else None
        sources = answer.result.scan.files if answer else ()
        save = Save(document.project, place, expected, sources, self._look())
        self._worker.ask(_Wish(save, document.file.work, then))

    def close(self) -> None:
        """Finish what is being written, and end the worker."""
        self._worker.close()

    def _note(self, wish: _Wish, stored: Stored) -> None:
        if wish.work is self._document.file.work:
            self._document.file.note(wish.save.project, stored)
        self.saved.emit(stored.path)
        if wish.then is not None:
            wish.then()

    def _fail(self, wish: _Wish, error: BaseException) -> None:
        if isinstance(error, ChangedByAnother):
            self.refused.emit(error.path)
        else:
            self.failed.emit(error)


def _write(wish: _Wish, progress: Progress) -> Stored:
    return write(wish.save)
