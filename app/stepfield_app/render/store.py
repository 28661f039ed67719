"""Arrays and pictures in files that both processes map: memory where the system has room in it."""

from __future__ import annotations

import contextlib
import mmap
import os
import shutil
import tempfile
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

PREFIX = "stepfield-render-"
#: A file system in memory, on Linux; it counts as memory and may be as small as 64 MB in a container.
MEMORY = Path("/dev/shm")
#: Bytes to leave free for others.
SPARE = 64 << 20


class Store:
    """Private folders for files, in memory and on disk, made by the window and named after its process."""

    def __init__(self) -> None:
        _sweep()
        self._numbers = count()
        self._folders = [Path(tempfile.mkdtemp(prefix=f"{PREFIX}{os.getpid()}-", dir=at)) for at in _places()]

    @property
    def folders(self) -> list[Path]:
        """The folders, best first."""
        return list(self._folders)

    def write(self, array: Array) -> dict[str, Any]:
        """Copy an array into a new file and say where it is; slow for large ones, and safe on any thread."""
        array = np.ascontiguousarray(array)
        path = self._path(array.nbytes)
        with path.open("xb", buffering=0) as file:
            rest = array.reshape(-1).view(np.uint8).data
            while rest:
                rest = rest[file.write(rest) :]
        return {"file": str(path), "shape": list(array.shape), "dtype": array.dtype.str}

    def blank(self, length: int) -> tuple[Path, Array]:
        """Make a file of zeros and map it, for the drawing process to write."""
        path = self._path(length)
        with path.open("xb") as file:
            file.truncate(length)
            if hasattr(
                os, "posix_fallocate"
            ):  # a full file system must say so now, not by a fault when written
                os.posix_fallocate(file.fileno(), 0, length)
        return path, mapped_bytes(path, writable=False)

    def remove(self, path: str | Path) -> None:
        """Remove a file; where a mapped one cannot be, it goes with the folder."""
        with contextlib.suppress(OSError):
            os.unlink(path)

    def close(self) -> None:
        """Remove everything."""
        remove(self._folders)

    def _path(self, length: int) -> Path:
        roomy = [at for at in self._folders if shutil.disk_usage(at).free > length + SPARE]
        return (roomy or self._folders[-1:])[0] / str(next(self._numbers))


def remove(folders: list[Path]) -> None:
    """Remove folders of a store and what is in them."""
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)


def mapped_bytes(path: str | Path, writable: bool) -> Array:
    """Map a file as bytes."""
    with open(path, "r+b" if writable else "rb") as file:
        access = mmap.ACCESS_WRITE if writable else mmap.ACCESS_READ
        return np.frombuffer(mmap.mmap(file.fileno(), 0, access=access), np.uint8)


def mapped(where: dict[str, Any]) -> Array:
    """Map an array that :meth:`Store.write` wrote, read-only.

    Raises
    ------
    OSError
        The file is gone.
    """
    shape, dtype = tuple(where["shape"]), np.dtype(where["dtype"])
    if 0 in shape:
        return np.empty(shape, dtype)
    array: Array = mapped_bytes(where["file"], writable=False).view(dtype).reshape(shape)
    return array


def _places() -> list[Path]:
    temporary = Path(tempfile.gettempdir())
    return [MEMORY, temporary] if os.access(MEMORY, os.W_OK) else [temporary]


def _sweep() -> None:
    """Remove what processes left that were killed."""
    for place in _places():
        for folder in place.glob(f"{PREFIX}*"):
            owner = folder.name.removeprefix(PREFIX).split("-")[0]
            if owner.isdigit() and not _alive(int(owner)):
                remove([folder])


def _alive(process: int) -> bool:
    if os.name == "nt":  # there, signal 0 would end it
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
