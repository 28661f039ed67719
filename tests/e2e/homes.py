"""A home of its own for every window that a test opens: no settings, caches or drafts of anybody's."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import psutil

#: What the driver's own platform settings would hide from the real window.
HIDDEN = {"QT_QPA_PLATFORM", "WAYLAND_DISPLAY"}
#: Folders of the user's that are looked for elsewhere than in the home when these are set.
FOLDERS = {"XDG_CONFIG_HOME": "config", "XDG_CACHE_HOME": "cache", "XDG_STATE_HOME": "state"}


def environment(folder: Path, display: str | None) -> dict[str, str]:
    """Environment with settings, caches and drafts of its own."""
    own = {name: value for name, value in os.environ.items() if name not in HIDDEN | {"DISPLAY"}}
    own |= {"HOME": str(folder)} | {name: str(folder / place) for name, place in FOLDERS.items()}
    return own | ({"DISPLAY": display, "QT_QPA_PLATFORM": "xcb"} if display else {})


def left_running(folder: Path) -> list[str]:
    """Processes that still run with this test's home."""
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.environ().get("HOME") == str(folder):
                found.append(" ".join(process.cmdline()))
    return found
