"""Tests of the window: no screen, no settings of the user's, nothing left behind."""

from __future__ import annotations

import gc
import os
from collections.abc import Iterator
from pathlib import Path
from threading import enumerate as running_threads

import pytest

os.environ["QT_QPA_PLATFORM"] = os.environ.get("STEPFIELD_TEST_PLATFORM", "offscreen")

from PySide6.QtCore import QCoreApplication, QEvent, QSettings
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from tests.app.editing import Desk

#: Milliseconds after which what must come true never will: a second is much, but not on a busy machine.
PATIENCE = 60_000
# pytest-qt gives up after five seconds, too few where the machine has other things to do; it has no setting.
for _wait in (QtBot.waitExposed, QtBot.waitSignal, QtBot.waitUntil):
    _wait.__kwdefaults__ = (_wait.__kwdefaults__ or {}) | {"timeout": PATIENCE}


@pytest.fixture(scope="package", autouse=True)
def garbage_stays_on_this_thread() -> Iterator[None]:
    """Collect what tests leave on this thread alone, as the program does: a worker's would crash Qt."""
    gc.collect()
    gc.freeze()  # what was loaded so far need not be looked at after every module
    gc.disable()
    yield
    gc.collect()
    gc.unfreeze()
    gc.enable()


@pytest.fixture(scope="module", autouse=True)
def garbage_of_a_module(garbage_stays_on_this_thread: None) -> Iterator[None]:
    """Clear up behind every module."""
    yield
    gc.collect()


@pytest.fixture(autouse=True)
def garbage_of_a_test(garbage_of_a_module: None) -> Iterator[None]:
    """Clear up behind every test; one of them may have let Python collect by itself again."""
    gc.disable()
    yield
    gc.disable()
    gc.collect(1)


@pytest.fixture(autouse=True)
def own_settings(tmp_path: Path) -> None:
    """Keep the tests away from the user's settings."""
    QSettings.setDefaultFormat(QSettings.Format.IniFormat)
    QSettings.setPath(QSettings.Format.IniFormat, QSettings.Scope.UserScope, str(tmp_path / "settings"))


@pytest.fixture(scope="package", autouse=True)
def own_state(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Keep the tests away from edits that the user's windows have left, and those from the tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield Path(os.environ["XDG_STATE_HOME"])


@pytest.fixture(autouse=True)
def nothing_left_behind(request: pytest.FixtureRequest) -> Iterator[None]:
    """Fail a test that leaves a top-level widget or a thread."""
    before = set(running_threads())
    yield
    if not QApplication.instance():
        return
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    left = [widget for widget in QApplication.topLevelWidgets() if widget.isVisible()]
    assert not left, f"widgets left open: {left}"
    threads = [thread for thread in running_threads() if thread not in before and not thread.daemon]
    assert not threads, f"threads left running: {threads}"


@pytest.fixture
def desk(qtbot: QtBot, tmp_path: Path) -> Iterator[Desk]:
    """A document with layers, a selection and an editor."""
    desk = Desk(qtbot)
    desk.open(tmp_path)
    yield desk
    desk.close()
