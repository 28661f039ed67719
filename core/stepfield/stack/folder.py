"""Putting a folder into place whole: written beside its target, then moved there in one step.

A crash, a full disk or a killed process leaves the old folder or none, never half of one, and at worst a
hidden temporary folder beside it. Such a leftover goes with the next folder that is put in the same place:
its maker holds a lock on it while it lives, so one that is unlocked and has stood for a minute is stale.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from stepfield.errors import StackError
from stepfield.files import hidden, reason

#: Two builds into one folder may meet between looking and moving; the later one tries again this often.
ATTEMPTS = 20
#: Seconds that an unlocked leftover must have stood: its maker may not have come to lock it yet.
STALE = 60


@contextlib.contextmanager
def new_folder(
    target: Path, may_replace: Callable[[Path], bool] | None, what: str = "a stack"
) -> Iterator[Path]:
    """Give a temporary folder to fill, and put it at ``target`` when the block ends well.

    Parameters
    ----------
    target : Path
        May be missing or an empty folder.
    may_replace : callable or None
        Whether the folder found at ``target`` may be replaced; None refuses any that is not empty.
    what : str
        What ``may_replace`` takes, for sentences.

    Raises
    ------
    StackError
        When ``target`` may not be replaced or the disk refuses.
    """
    target = Path(os.path.realpath(target))
    made: list[Path] = []
    try:
        _refuse(target, may_replace, what)
        made += [folder for folder in target.parents if not folder.exists()]
        target.parent.mkdir(parents=True, exist_ok=True)
        with _temporary(target) as temporary:
            yield temporary
            _give_usual_rights(temporary)
            _put(temporary, target, may_replace, what)
        _remove_stale(target)
    except OSError as error:
        raise StackError(
            f"{target}: cannot write {what.replace('a ', 'the ', 1)} ({reason(error)}); choose another folder"
        ) from None
    finally:
        with contextlib.suppress(OSError):
            for folder in made:
                folder.rmdir()  # only what is empty, so nothing once the target is there


@contextlib.contextmanager
def _temporary(target: Path) -> Iterator[Path]:
    """Make a folder beside the target, locked, and remove it unless it has been moved away."""
    folder = Path(tempfile.mkdtemp(prefix=_prefix(target), dir=target.parent))
    try:
        with _locked(folder):
            yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _prefix(target: Path) -> str:
    return hidden(target.name, "stepfield-")


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[bool]:
    """Hold the lock on a folder as long as the process lives; tell whether it could be had."""
    try:
        import fcntl
    except ImportError:  # Windows, where leftovers stay until they are removed by hand
        yield False
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        had = True
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:  # another's, or a file system without locks
            had = False
        yield had
    finally:
        os.close(descriptor)


def _remove_stale(target: Path) -> None:
    """Remove what killed builds into the same place have left."""
    with contextlib.suppress(OSError):
        for folder in list(target.parent.iterdir()):
            if not folder.name.startswith(_prefix(target)) or folder.is_symlink() or not folder.is_dir():
                continue
            with contextlib.suppress(OSError):
                if time.time() - folder.stat().st_mtime > STALE:
                    with _locked(folder) as free:
                        if free:
                            shutil.rmtree(folder, ignore_errors=True)


def _refuse(target: Path, may_replace: Callable[[Path], bool] | None, what: str) -> None:
    """Raise StackError unless ``target`` is missing, empty, or may be replaced."""
    if not os.path.lexists(target):
        return
    if target.is_symlink():
        raise StackError(f"{target}: is a symbolic link that leads in a circle; choose another name")
    if not target.is_dir():
        raise StackError(f"{target}: is a file, not a folder; choose another name")
    if not any(target.iterdir()):
        return
    if may_replace is None:
        raise StackError(f"{target}: the folder is not empty; use --overwrite or another name")
    if not may_replace(target):
        raise StackError(
            f"{target}: holds something other than {what}, so it is not replaced; use another name"
        )


def _put(temporary: Path, target: Path, may_replace: Callable[[Path], bool] | None, what: str) -> None:
    """Move the finished folder to its place; an old stack steps aside first and is then removed."""
    aside = temporary.with_name(f"{temporary.name}-old")
    for _ in range(ATTEMPTS):
        with contextlib.suppress(OSError):
            os.rename(temporary, target)  # also over an empty folder
            return
        _refuse(target, may_replace, what)
        try:
            os.rename(target, aside)
            os.rename(temporary, target)
            return
        except (FileNotFoundError, FileExistsError):
            continue  # another build moved its own stack here, or away, meanwhile
        except OSError:
            if not os.path.lexists(aside):
                raise  # the old one does not budge, as a mount point does not
        finally:
            _dismiss(aside, target)
    os.rename(temporary, target)


def _dismiss(aside: Path, target: Path) -> None:
    """Remove the old stack, or put it back where an interruption has left its place empty."""
    try:
        os.rename(aside, target)  # fails over a stack, which is never empty
    except OSError:
        if os.path.lexists(target):
            shutil.rmtree(aside, ignore_errors=True)


def _give_usual_rights(folder: Path) -> None:
    """Give a folder, made private by mkdtemp, the rights any new one would have."""
    mask = os.umask(0)
    os.umask(mask)
    folder.chmod(0o777 & ~mask)
