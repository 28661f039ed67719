"""Reading and writing files so that a failure is one sentence and never half a file."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import secrets
import stat
import sys
import time
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from threading import Thread
from typing import Any

from stepfield.errors import StepfieldError

#: Seconds after which a temporary file is nobody's any more.
STALE = 3600


def reason(error: OSError) -> str:
    """Say what the operating system said, without its numbers and paths."""
    return (error.strerror or str(error)).lower()


def one_line(text: str) -> str:
    """Return text with what a terminal would not print written out: damaged headers are quoted, too."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def storable(text: str) -> str:
    """Return text that may hold bytes of a file name that are no UTF-8, as text that any file takes."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def hidden(name: str, kind: str = "") -> str:
    """Return how hidden temporary names begin beside ``name``: of it, so much that they are not too long."""
    beginning = os.fsencode(name)[:80].decode("utf-8", "ignore")
    return f".{beginning}.{kind}"


class Digest:
    """SHA-256 of a file, taken by a thread of its own while the file's points are put to use.

    It costs more processor time than reading the points does. Leaving the program does not wait for it.
    """

    def __init__(self, path: Path) -> None:
        self._result: Future[str] = Future()
        Thread(target=self._take, args=(path,), name=f"digest of {path.name}", daemon=True).start()

    def hexdigest(self) -> str:
        """Return the digest, waiting for it if need be; raise OSError if the file could not be read."""
        return self._result.result()

    def _take(self, path: Path) -> None:
        try:
            self._result.set_result(sha256_of(path))
        except OSError as error:
            self._result.set_exception(error)


def read_json(path: Path, failure: type[StepfieldError], what: str) -> Any:
    """Parse a JSON file, turning whatever goes wrong into ``failure``."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise failure(f"{path}: cannot read the {what} ({reason(error)})") from None
    except (ValueError, RecursionError):
        raise failure(f"{path}: damaged {what}, it is not JSON; restore a copy") from None


def sha256_of(path: Path) -> str:
    """Return the digest of a file in hexadecimal digits; raise OSError if it cannot be read."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_atomically(
    path: Path, content: bytes, failure: type[StepfieldError], check: Callable[[], None] | None = None
) -> None:
    """Replace ``path`` by ``content`` in one step, so that the old file stays whole until then.

    Rights of an old file are kept, a link is followed, and what killed processes left beside it is removed.

    Parameters
    ----------
    path : Path
    content : bytes
    failure : type of StepfieldError
        Raised in one sentence when the disk refuses.
    check : callable, optional
        Called when only the last step remains; what it raises leaves the old file as it is.
    """
    target = Path(os.path.realpath(path))
    temporary = target.with_name(f"{hidden(target.name, 'write-')}{secrets.token_hex(8)}")
    try:
        _write(temporary, content)
        if target.exists():
            _take_rights(temporary, target)
        if check is not None:
            check()
        os.replace(temporary, target)
    except OSError as error:
        raise failure(f"{path}: cannot write the file ({reason(error)}); choose another place") from None
    finally:
        with contextlib.suppress(OSError):
            os.unlink(temporary)  # not there any more once it is in place
    _finish(target)


def _write(path: Path, content: bytes) -> None:
    """Write a new file, with the rights any new one has, down to the disk."""
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666), "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def _take_rights(temporary: Path, target: Path) -> None:
    """Give a file the rights of the one it replaces; one that may not be written is not replaced either."""
    if not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    os.chmod(temporary, stat.S_IMODE(target.stat().st_mode))


def _finish(target: Path) -> None:
    """Make the new name last through a power cut, and remove what killed writers of it have left."""
    with contextlib.suppress(OSError):
        remove_leftovers(target.parent, hidden(target.name, "write-"))
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def remove_leftovers(folder: Path, beginning: str) -> None:
    """Remove files so old, their names beginning so, that nobody can be writing them."""
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.startswith(beginning) and time.time() - entry.stat().st_mtime > STALE:
                os.unlink(entry.path)


class FileLock:
    """A lock on a file: held until it is released or the process ends, however it ends."""

    def __init__(self, path: Path, descriptor: int) -> None:
        self._path, self._descriptor = path, descriptor

    @classmethod
    def taken(cls, path: Path) -> FileLock | None:
        """Take the lock on a file, which is made if need be; None if another has it or nobody can.

        Raises
        ------
        OSError
            When the file cannot be made.
        """
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        try:
            _lock(descriptor)
            if os.path.samestat(os.fstat(descriptor), path.stat()):
                return cls(path, descriptor)
        except OSError:  # another's, removed meanwhile, or a file system without locks
            pass
        os.close(descriptor)
        return None

    def release(self, *, remove: bool = False) -> None:
        """Let another take it; once nobody needs it, remove the file."""
        if remove:
            with contextlib.suppress(OSError):
                self._path.unlink()
        os.close(self._descriptor)


def _lock(descriptor: int) -> None:
    """Lock an open file, or raise OSError at once."""
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
