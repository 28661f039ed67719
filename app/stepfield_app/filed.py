"""What of a document lies on the disk: the project file as it was last seen, or edits brought back."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from stepfield.project import Project


@dataclass(frozen=True)
class Stored:
    """A project file, and the digest of its content when it was read or written last."""

    path: Path
    sha256: str


@dataclass(frozen=True, eq=False)
class Work:
    """What is opened.

    Attributes
    ----------
    project : Project
        Its scans are named by their full paths.
    stored : Stored, optional
        The file it belongs to.
    saved : Project, optional
        What that file holds, where it is not ``project``.
    draft : Path, optional
        Where the edits were found that an earlier window did not come to save: they are in no project yet.
    """

    project: Project
    stored: Stored | None = None
    saved: Project | None = None
    draft: Path | None = None

    @property
    def on_disk(self) -> Project | None:
        """What nobody has to save."""
        return None if self.draft else self.saved or self.project


class ProjectFile(QObject):
    """Where the open project is stored, and whether there is anything to save."""

    changed = Signal()  # another file, or another content of it
    dirty_changed = Signal(bool)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._project = Project()
        self._dirty = False
        self._work = Work(self._project)
        self._stored: Stored | None = None
        self._saved: Project | None = self._project

    @property
    def work(self) -> Work:
        """What was opened; the very object that was given, so that an answer can say what it belongs to."""
        return self._work

    @property
    def stored(self) -> Stored | None:
        """The file, as it was read or written last."""
        return self._stored

    @property
    def dirty(self) -> bool:
        """Whether there is anything to save."""
        return self._dirty

    def begin(self, work: Work) -> None:
        """Take up what was opened."""
        self._project = work.project
        self._take(work, work.stored, work.on_disk)

    def follow(self, project: Project) -> None:
        """Take note of another step of the project."""
        self._project = project
        if self._judge():
            self.dirty_changed.emit(self._dirty)

    def note(self, project: Project, stored: Stored) -> None:
        """Say what has been written, which may be older than what there is now."""
        self._take(self._work, stored, project)

    def give_up(self) -> None:
        """Say that nobody wants the present edits saved."""
        self._take(self._work, self._stored, self._project)

    def _take(self, work: Work, stored: Stored | None, saved: Project | None) -> None:
        self._work, self._stored, self._saved = work, stored, saved
        is_other = self._judge()  # before anybody looks
        self.changed.emit()
        if is_other:
            self.dirty_changed.emit(self._dirty)

    def _judge(self) -> bool:
        """See whether there is anything to save; tell whether that is news."""
        before, self._dirty = self._dirty, not _same(self._project, self._saved)
        return self._dirty != before


def _same(project: Project, other: Project | None) -> bool:
    """Whether two projects differ in nothing but how they were looked at."""
    names = ("scans", "parameters", "layers", "moves")
    return other is not None and all(getattr(project, name) == getattr(other, name) for name in names)
