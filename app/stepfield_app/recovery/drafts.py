"""Drafts on the disk: one for each window, locked as long as that window lives.

A draft is a project file whose scans are named by their full paths; its ``view`` says which project file it
belongs to. Its lock is a file of its own: the draft is replaced whole at every writing, a lock is not.
"""

from __future__ import annotations

import contextlib
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Any

from stepfield.errors import ProjectError
from stepfield.files import FileLock, reason, remove_leftovers, write_atomically
from stepfield.project import Project
from stepfield_app.filed import Stored, Work
from stepfield_app.saving.write import content_of

SUFFIX, LOCK = ".stepfield", ".lock"
#: Where a draft's ``view`` says which file it belongs to.
ORIGIN = "draft of"
#: Tries to get a lock of one's own: another window may just be looking whether it is left over.
TRIES = 3


@dataclass(frozen=True, eq=False)
class Slot:
    """A place for one draft; the lock is None where the file system has no locks."""

    path: Path
    lock: FileLock | None

    @classmethod
    def new(cls, folder: Path) -> Slot:
        """Make a place that no other window will touch.

        Raises
        ------
        ProjectError
            When nothing can be kept there.
        """
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            for _ in range(TRIES):
                path = folder / f"{uuid.uuid4().hex}{SUFFIX}"
                if lock := FileLock.taken(path.with_suffix(LOCK)):
                    return cls(path, lock)
        except OSError as error:
            raise ProjectError(f"{folder}: edits cannot be kept there ({reason(error)})") from None
        return cls(path, None)

    def write(self, project: Project, stored: Stored | None, view: dict[str, Any]) -> None:
        """Keep a project; the draft before stays until this one is whole."""
        origin = {"path": str(stored.path), "sha256": stored.sha256} if stored else {}
        kept = project.model_copy(update={"view": view | {ORIGIN: origin}})
        write_atomically(self.path, content_of(kept, self.path), ProjectError)

    def clear(self) -> None:
        """Remove the draft."""
        with contextlib.suppress(OSError):
            self.path.unlink()

    def release(self, *, remove: bool) -> None:
        """Let others take the draft, or remove it."""
        if remove:
            self.clear()
        if self.lock is not None:
            self.lock.release(remove=remove)


@dataclass(frozen=True, eq=False)
class Draft:
    """Edits that a window has left without saving them.

    Attributes
    ----------
    slot : Slot
        Where they lie; nobody else can take them meanwhile.
    work : Work
    kept_at : datetime
    """

    slot: Slot
    work: Work
    kept_at: datetime

    @property
    def name(self) -> str:
        """The file they belong to: the project, or the scan if there was none."""
        stored, scans = self.work.stored, self.work.project.scans
        return stored.path.name if stored else Path(scans[0].path).name if scans else "a scan"

    def sentence(self, now: datetime) -> str:
        """Ask whether they are wanted."""
        at = self.kept_at
        when = f"{at:%H:%M}" if at.date() == now.date() else f"{at:%H:%M} on {at.day} {at:%B %Y}"
        return f"Recover the unsaved edits of {self.name} from {when}?"


def leftovers(folder: Path, damaged: Callable[[ProjectError], None]) -> Iterator[Draft]:
    """Find the drafts of windows that live no more, the newest first, and lock them.

    Parameters
    ----------
    folder : Path
    damaged : callable
        Told of a draft that cannot be read; it is set aside under another name.
    """
    with contextlib.suppress(OSError):
        remove_leftovers(folder, ".")
    for lock_path in folder.glob(f"*{LOCK}"):
        path = lock_path.with_suffix(SUFFIX)
        if not path.exists() and (lock := FileLock.taken(lock_path)):
            Slot(path, lock).release(remove=not path.exists())
    for path in sorted(folder.glob(f"*{SUFFIX}"), key=_time, reverse=True):
        lock = FileLock.taken(path.with_suffix(LOCK))
        draft = lock and _read(Slot(path, lock), damaged)
        if draft:
            yield draft


def _read(slot: Slot, damaged: Callable[[ProjectError], None]) -> Draft | None:
    try:
        work = _with_saved(_work_of(slot.path))
    except ProjectError as error:
        slot.release(remove=False)
        if "newer Stepfield" not in str(error):
            _set_aside(slot.path)
            damaged(error)
        return None
    if _is_saved(work):
        slot.release(remove=True)
        return None
    return Draft(slot, work, datetime.fromtimestamp(_time(slot.path)))


def _work_of(path: Path) -> Work:
    """Read a draft, whose view tells where it belongs."""
    project = Project.read(path)
    origin = project.view.get(ORIGIN)
    stored = None
    if isinstance(origin, dict) and isinstance(origin.get("path"), str):
        stored = Stored(Path(origin["path"]), str(origin.get("sha256")))
    view = {key: value for key, value in project.view.items() if key != ORIGIN}
    return Work(project.model_copy(update={"view": view}), stored, draft=path)


def _with_saved(work: Work) -> Work:
    """Add what the project file holds, as far as it can be read."""
    if work.stored is None:
        return work
    try:
        return replace(work, saved=Project.read(work.stored.path))
    except ProjectError:
        return work


def _is_saved(work: Work) -> bool:
    """Whether the project file holds the same: the window ended between saving and clearing up."""
    if work.stored is None or work.saved is None:
        return False
    saved, drafted = work.saved, work.project
    scans = tuple(str(path) for path in saved.scan_paths(work.stored.path))
    return (
        scans == tuple(scan.path for scan in drafted.scans)
        and (saved.parameters, saved.layers, saved.moves)
        == (drafted.parameters, drafted.layers, drafted.moves)
    )  # fmt: skip


def _set_aside(path: Path) -> None:
    with contextlib.suppress(OSError):
        path.replace(path.with_suffix(".damaged"))


def _time(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
