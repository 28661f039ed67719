"""Keeps what is not saved, a few seconds after every change, and finds what earlier windows have left."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from platformdirs import user_state_path
from PySide6.QtCore import QObject, QTimer, Signal

from stepfield.errors import ProjectError, StepfieldError
from stepfield.progress import Progress
from stepfield.project import Project
from stepfield_app.document import Document
from stepfield_app.filed import Stored, Work
from stepfield_app.newest import NewestWins
from stepfield_app.recovery.drafts import Draft, Slot, leftovers

#: Seconds of quiet after a change before it is kept, and from the first change not kept, at the latest.
QUIET, LATEST = 5.0, 20.0


@dataclass(frozen=True, eq=False)
class _Keep:
    """What is to be kept; no project stands for nothing."""

    slot: Slot
    project: Project | None = None
    stored: Stored | None = None
    view: dict[str, Any] = field(default_factory=dict)
    work: Work | None = None


@dataclass(frozen=True, eq=False)
class _Found:
    """What earlier windows have left."""

    drafts: tuple[Draft, ...]
    damaged: tuple[ProjectError, ...]


class Recovery(QObject):
    """Keeps the edits of one window while they are not saved.

    Parameters
    ----------
    document : Document
    look : callable
        Returns how the project is looked at.
    folder : Path, optional
        Where drafts lie; the user's own place for the state of programs by default.
    parent : QObject, optional
    """

    found = Signal(object)  # Draft: call ``recover``, ``discard`` or ``leave`` with it
    kept = Signal()
    failed = Signal(object)  # exception; once, until it works again

    def __init__(
        self,
        document: Document,
        look: Callable[[], dict[str, Any]] = dict,
        folder: Path | None = None,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._document, self._look = document, look
        self._folder = folder or user_state_path("stepfield", appauthor=False) / "recovery"
        self._slot: Slot | None = None
        self._offered: dict[Path, Draft] = {}
        self._taken: list[Draft] = []
        self._has_failed = False
        self._quiet = QTimer(self, singleShot=True, interval=round(1000 * QUIET))
        self._latest = QTimer(self, singleShot=True, interval=round(1000 * LATEST))
        self._keeper = NewestWins[_Keep, None](_keep, "recovery", self)
        self._finder = NewestWins[Path, _Found](_find, "leftovers", self)
        self._connect()

    def _connect(self) -> None:
        self._quiet.timeout.connect(self.keep)
        self._latest.timeout.connect(self.keep)
        self._keeper.answered.connect(self._note)
        self._keeper.failed.connect(lambda _, error: self._fail(error))
        self._finder.answered.connect(self._offer)
        self._document.project_changed.connect(self._wait)
        self._document.file.dirty_changed.connect(self._wait)
        self._document.opened.connect(self._take_over)

    @property
    def busy(self) -> bool:
        """Whether anything is being kept, or about to be."""
        return self._quiet.isActive() or self._keeper.busy

    def look_for_leftovers(self) -> None:
        """Find what windows that live no more have left; ``found`` tells each."""
        self._finder.ask(self._folder)

    def keep(self) -> None:
        """Keep what is not saved, now; nothing once all is saved."""
        self._quiet.stop()
        self._latest.stop()
        document = self._document
        if document.file.dirty:
            try:
                self._slot = self._slot or Slot.new(self._folder)
            except ProjectError as error:
                self._fail(error)
                return
            file = document.file
            self._keeper.ask(_Keep(self._slot, document.project, file.stored, self._look(), file.work))
        elif self._slot is not None:
            self._keeper.ask(_Keep(self._slot))

    def discard(self, draft: Draft) -> None:
        """Remove a draft for good."""
        if self._offered.pop(draft.slot.path, None):
            draft.slot.release(remove=True)

    def leave(self, draft: Draft) -> None:
        """Leave a draft for the next start."""
        if self._offered.pop(draft.slot.path, None):
            draft.slot.release(remove=False)

    def close(self) -> None:
        """End; edits that are neither saved nor given up are kept for the next start."""
        self._quiet.stop()
        self._latest.stop()
        self._finder.close()
        self._keeper.close()
        for draft in [*self._offered.values()]:
            self.leave(draft)
        is_dirty = self._document.file.dirty
        is_kept = is_dirty and self._kept_at_last()
        self._let_go(remove=is_kept or not is_dirty)
        if self._slot is not None:
            self._slot.release(remove=not is_kept)
            self._slot = None

    def _kept_at_last(self) -> bool:
        try:
            document = self._document
            self._slot = self._slot or Slot.new(self._folder)
            self._slot.write(document.project, document.file.stored, self._look())
        except ProjectError:
            return self._slot is not None and self._slot.path.exists()
        return True

    def _wait(self) -> None:
        """Keep a change soon; forget at once what has been saved."""
        if not self._document.file.dirty:
            self.keep()
            return
        self._quiet.start()
        if not self._latest.isActive():
            self._latest.start()

    def _take_over(self) -> None:
        """Keep a draft that was just opened as one's own; it goes once that is done."""
        path = self._document.file.work.draft
        draft = self._offered.pop(path, None) if path else None
        if draft is not None:
            self._taken.append(draft)
            self.keep()

    def _let_go(self, *, remove: bool) -> None:
        """Part with the drafts that were taken over."""
        while self._taken:
            self._taken.pop().slot.release(remove=remove)

    def _offer(self, folder: Path, found: _Found) -> None:
        for error in found.damaged:
            self.failed.emit(error)
        for draft in reversed(found.drafts):  # a message bar has the last one on top
            self._offered[draft.slot.path] = draft
            self.found.emit(draft)

    def _note(self, wanted: _Keep) -> None:
        self._has_failed = False
        if wanted.project is None or wanted.work is self._document.file.work:
            self._let_go(remove=True)
        self.kept.emit()

    def _fail(self, error: BaseException) -> None:
        """Tell of a failure once, and try again before long."""
        self._latest.start()
        if not self._has_failed:
            self._has_failed = True
            self.failed.emit(_told(error))


def _told(error: BaseException) -> BaseException:
    if not isinstance(error, StepfieldError):
        return error
    cause = str(error).partition("; ")[0]  # what it advises is not for this file
    return ProjectError(f"Edits are not kept for the case of a crash, save them: {cause}")


def _keep(wanted: _Keep, progress: Progress) -> None:
    if wanted.project is None:
        wanted.slot.clear()
    else:
        wanted.slot.write(wanted.project, wanted.stored, wanted.view)


def _find(folder: Path, progress: Progress) -> _Found:
    damaged: list[ProjectError] = []
    return _Found(tuple(leftovers(folder, damaged.append)), tuple(damaged))
