"""Who goes first where all want the processors."""

from __future__ import annotations

import os
import sys
import threading

import pytest
from pytestqt.qtbot import QtBot

from stepfield_app.newest import NewestWins
from stepfield_app.render.client import RenderClient

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="threads are as urgent as their process")


def urgency(number: int) -> int:
    return -os.getpriority(os.PRIO_PROCESS, number)


def test_the_window_goes_before_its_workers_and_they_before_the_drawing(qtbot: QtBot) -> None:
    """A hand on a slider would wait for its turn behind what it asks for, and that behind its picture."""
    worker = NewestWins[None, int](lambda *_: urgency(threading.get_native_id()), "urgency")
    with qtbot.waitSignal(worker.answered) as answered:
        worker.ask(None)
    worker.close()
    client = RenderClient()
    client.start()
    qtbot.waitUntil(lambda: client.state == "running", timeout=60_000)
    drawing = urgency(client.process_id)
    client.close()
    assert drawing < answered.args[1] < urgency(os.getpid())
