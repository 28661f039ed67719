"""Reading and writing files so that a failure is one sentence and never half a file."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import tempfile
from concurrent.futures import Future
from pathlib import Path
from threading import Thread
from typing import Any

from stepfield.errors import StepfieldError


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
            with path.open("rb") as file:
                self._result.set_result(hashlib.file_digest(file, "sha256").hexdigest())
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


def write_atomically(path: Path, content: bytes, failure: type[StepfieldError]) -> None:
    """Replace ``path`` by ``content`` in one step, so that the old file stays whole until then."""
    temporary: str | None = None
    try:
        descriptor, temporary = tempfile.mkstemp(prefix=hidden(path.name), dir=path.parent)
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, path)
    except OSError as error:
        if temporary is not None:
            with contextlib.suppress(OSError):
                os.unlink(temporary)
        raise failure(f"{path}: cannot write the file ({reason(error)}); choose another place") from None


def _umask() -> int:
    """Return the process's file mode mask, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
