"""Memory that was freed: kept for what comes next while there is work, given back to the system after it."""

from __future__ import annotations

import contextlib
import ctypes
import sys

#: What ``malloc.h`` calls the options, and how much of what is free may stay, bytes.
TRIM_THRESHOLD, MMAP_MAX = -1, -4
KEPT = 256 << 20


def keep() -> None:
    """Let what is freed be used again, where the library can do so: as much is needed for the next picture.

    The system hands memory out in small pieces and clears each, which takes longer than what is done with it.
    """
    if sys.platform == "linux":
        with contextlib.suppress(AttributeError, OSError):  # another library than glibc
            library = ctypes.CDLL(None)
            library.mallopt(MMAP_MAX, 0)
            library.mallopt(TRIM_THRESHOLD, KEPT)


def give_back() -> None:
    """Return what is free of this process's memory, where the library can do so; takes milliseconds."""
    if sys.platform == "linux":
        with contextlib.suppress(AttributeError, OSError):  # another library than glibc
            ctypes.CDLL(None).malloc_trim(0)
