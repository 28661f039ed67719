"""Memory that was freed: other threads and what comes next may use it, then the system gets it back."""

from __future__ import annotations

import contextlib
import ctypes
import sys

#: What ``malloc.h`` calls the options, and how much of what is free may stay, bytes.
TRIM_THRESHOLD, MMAP_MAX, ARENA_MAX = -1, -4, -8
KEPT = 256 << 20
#: How many places threads take memory from; the library would have eight for each processor.
ARENAS = 2


def share() -> None:
    """Let a thread use what another one has freed, where the library can do so.

    Else each of a dozen workers comes to hold as much as the largest thing any of them ever needed.
    """
    if sys.platform == "linux":
        with contextlib.suppress(AttributeError, OSError):  # another library than glibc
            ctypes.CDLL(None).mallopt(ARENA_MAX, ARENAS)


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
