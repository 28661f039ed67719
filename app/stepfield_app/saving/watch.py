"""Looks whether another window or program changes the file of the open project."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QFileSystemWatcher, QObject, QTimer, Signal

from stepfield.files import sha256_of
from stepfield.progress import Progress
from stepfield_app.document import Document
from stepfield_app.filed import Stored
from stepfield_app.newest import NewestWins
from stepfield_app.saving.saving import Saving

#: Milliseconds of quiet before a file that has changed is looked at.
QUIET = 300


class FileWatch(QObject):
    """Tells when the project's file is no longer what this window has read or written.

    Parameters
    ----------
    document : Document
    saving : Saving
        What it writes is no news.
    parent : QObject, optional
    """

    changed = Signal(object)  # Path; once for every content of it
    gone = Signal(object)  # Path

    def __init__(self, document: Document, saving: Saving, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._file, self._saving = document.file, saving
        self._said: Stored | None = None
        self._watcher = QFileSystemWatcher(self)
        self._worker = NewestWins[Path, str](_digest, "file watch", self)
        self._worker.answered.connect(self._compare)
        self._quiet = QTimer(self, singleShot=True, interval=QUIET)
        self._quiet.timeout.connect(self.look)
        for signal in (self._watcher.fileChanged, self._watcher.directoryChanged, saving.busy_changed):
            signal.connect(lambda _: self._quiet.start())
        document.file.changed.connect(self._follow)

    def look(self) -> None:
        """Look at the file now."""
        stored = self._file.stored
        if stored is not None and not self._saving.busy:
            self._worker.ask(stored.path)

    def close(self) -> None:
        """End the worker."""
        self._worker.close()

    def _follow(self) -> None:
        """Watch the file and its folder: a file that is replaced whole is another one to the system."""
        if paths := [*self._watcher.files(), *self._watcher.directories()]:
            self._watcher.removePaths(paths)
        stored = self._file.stored
        self._said = stored
        if stored is not None:
            present = [path for path in (stored.path, stored.path.parent) if path.exists()]
            self._watcher.addPaths([str(path) for path in present])
            self._quiet.start()  # edits brought back may belong to an older content

    def _compare(self, path: Path, sha256: str) -> None:
        found, known = Stored(path, sha256), self._file.stored
        if known is None or known.path != path or self._saving.busy or found in (known, self._said):
            return
        self._said = found
        (self.changed if sha256 else self.gone).emit(path)


def _digest(path: Path, progress: Progress) -> str:
    """Return the digest of a file, empty if there is none."""
    try:
        return sha256_of(path)
    except OSError:
        return ""
