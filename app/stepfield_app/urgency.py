"""Who goes first where all want the processors: the window, then what it shows next, then the drawing of it.

A step of a hand and a paint take the window a few milliseconds. They would take ten times as long if it
had to wait for its turn like everybody else, at every call of Qt's that gives it away.
"""

from __future__ import annotations

import contextlib
import os
import sys
import threading

#: How much less urgent than the window its workers and the drawing process are, on the scale of ``nice``.
#: What the workers make is waited for, and they hold the interpreter: the drawing must not hold them up.
WORKERS, DRAWING = 3, 10


def give_way() -> None:
    """Make the present thread, and those it starts, as urgent as workers are; where threads can differ."""
    if sys.platform == "linux":
        with contextlib.suppress(OSError):  # a sandbox may forbid it
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), WORKERS)


def give_way_altogether() -> None:
    """Make the present process as urgent as drawing is."""
    if hasattr(os, "nice"):
        os.nice(DRAWING)
