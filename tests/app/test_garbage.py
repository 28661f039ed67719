"""Where garbage is collected while the window is open."""

from __future__ import annotations

import gc
from threading import Thread, current_thread, main_thread
from weakref import finalize

from PySide6.QtCore import QObject
from pytestqt.qtbot import QtBot

from stepfield_app.garbage import GarbageCollector


class Knot:
    """Refers to itself: only a collection frees it."""

    def __init__(self) -> None:
        self.self = self


def test_what_a_worker_leaves_is_destroyed_on_the_window_s_thread(qtbot: QtBot) -> None:
    """Destroying a Qt object on a worker's thread crashes the program."""
    parent = QObject()
    collector = GarbageCollector(parent)
    threads = []
    finalize(Knot(), lambda: threads.append(current_thread()))
    worker = Thread(target=lambda: [Knot() for _ in range(20_000)])
    worker.start()
    worker.join()
    assert not threads, "the worker collected"
    qtbot.waitUntil(lambda: bool(threads))
    assert threads == [main_thread()]
    collector.stop()
    assert gc.isenabled()
