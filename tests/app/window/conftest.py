"""Windows for tests: one that they share, and one of their own."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from tests.app.window.whole import Folder, discarded, made, open_in

from stepfield_app.appearance import Appearance
from stepfield_app.dialogs.export import ExportDialog
from stepfield_app.main_window import MainWindow


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    return Folder(tmp_path_factory.mktemp("scans"))


@pytest.fixture(scope="module")
def appearance(qapp: QApplication) -> Appearance:
    """One for all windows: it dresses the application."""
    return Appearance(qapp, "dark")


@pytest.fixture(scope="module")
def shared(appearance: Appearance, tmp_path_factory: pytest.TempPathFactory) -> Iterator[MainWindow]:
    """One window for all tests that leave it whole."""
    window = made(tmp_path_factory.mktemp("settings"), appearance)
    window.hide()  # a window on the screen between tests is one left behind
    yield window
    discarded(window)


@pytest.fixture
def window(shared: MainWindow, qtbot: QtBot) -> Iterator[MainWindow]:
    """The shared window, on the screen, with nothing open."""
    shared.show()
    shared.bench.document.close_scan()
    shared.message_bar.dismiss_all()
    yield shared
    for dialog in shared.findChildren(ExportDialog):
        dialog.done(0)
    shared.appearance.choose("dark")
    shared.resize(1280, 800)
    shared.bench.document.close_scan()
    qtbot.waitUntil(shared.is_settled)
    shared.message_bar.dismiss_all()
    shared.hide()


@pytest.fixture
def opened(window: MainWindow, folder: Folder, qtbot: QtBot) -> MainWindow:
    """The shared window with the table in it."""
    return open_in(window, qtbot, folder.table)


@pytest.fixture
def own(qtbot: QtBot, tmp_path: Path, appearance: Appearance) -> Iterator[MainWindow]:
    """A window that a test may ruin."""
    window = made(tmp_path, appearance)
    yield window
    discarded(window)
