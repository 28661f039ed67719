"""Memory that was freed goes back to the system: the C library keeps it, and others may need it."""

from __future__ import annotations

import contextlib
import ctypes
import sys


def give_back() -> None:
    """Return what is free of this process's memory, where the library can do so; takes milliseconds."""
    if sys.platform == "linux":
        with contextlib.suppress(AttributeError, OSError):  # another library than glibc
            ctypes.CDLL(None).malloc_trim(0)
