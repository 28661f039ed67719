"""Putting a folder into place whole: written beside its target, then moved there in one step.

A crash, a full disk or a killed process leaves the old folder or none, never half of one, and at worst a
hidden temporary folder beside it.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from stepfield.errors import StackError
from stepfield.files import reason

#: Two builds into one folder may meet between looking and moving; the later one tries again this often.
ATTEMPTS = 20


@contextlib.contextmanager
def new_folder(target: Path, may_replace: Callable[[Path], bool] | None) -> Iterator[Path]:
    """Give a temporary folder to fill, and put it at ``target`` when the block ends well.

    Parameters
    ----------
    target : Path
        May be missing or an empty folder.
    may_replace : callable or None
        Whether the folder found at ``target`` may be replaced; None refuses any that is not empty.

    Raises
    ------
    StackError
        When ``target`` may not be replaced or the disk refuses.
    """
    target = Path(os.path.realpath(target))
    _refuse(target, may_replace)
    temporary: Path | None = None
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=f".{target.name[:80]}.", dir=target.parent))
        yield temporary
        _give_usual_rights(temporary)
        _put(temporary, target, may_replace)
    except OSError as error:
        raise StackError(
            f"{target}: cannot write the stack ({reason(error)}); choose another folder"
        ) from None
    finally:
        if temporary is not None:
            shutil.rmtree(temporary, ignore_errors=True)


def _refuse(target: Path, may_replace: Callable[[Path], bool] | None) -> None:
    """Raise StackError unless ``target`` is missing, empty, or may be replaced."""
    if not os.path.lexists(target):
        return
    if not target.is_dir():
        raise StackError(f"{target}: is a file, not a folder; choose another name")
    if not any(target.iterdir()):
        return
    if may_replace is None:
        raise StackError(f"{target}: the folder is not empty; use --overwrite or another name")
    if not may_replace(target):
        raise StackError(
            f"{target}: holds something other than a stack, so it is not replaced; use another name"
        )


def _put(temporary: Path, target: Path, may_replace: Callable[[Path], bool] | None) -> None:
    """Move the finished folder to its place; an old stack steps aside first and is then removed."""
    for _ in range(ATTEMPTS):
        with contextlib.suppress(FileExistsError, OSError):
            os.rename(temporary, target)  # also over an empty folder
            return
        _refuse(target, may_replace)
        aside = Path(tempfile.mkdtemp(prefix=f".{target.name[:80]}.old.", dir=target.parent))
        with contextlib.suppress(FileNotFoundError):
            os.rename(target, aside)
        try:
            os.rename(temporary, target)
            return
        except OSError:
            continue  # another build put its own stack here meanwhile
        finally:
            shutil.rmtree(aside, ignore_errors=True)
    os.rename(temporary, target)


def _give_usual_rights(folder: Path) -> None:
    """Give a folder, made private by mkdtemp, the rights any new one would have."""
    mask = os.umask(0)
    os.umask(mask)
    folder.chmod(0o777 & ~mask)
