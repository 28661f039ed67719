"""Leaving: whatever the window is at, nothing of it is left."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import table
from tests.app.window.whole import Folder, discarded, endless, made, open_in

from stepfield_app.appearance import Appearance
from stepfield_app.dialogs.export import ExportDialog
from stepfield_app.main_window import MainWindow
from stepfield_app.newest import NewestWins


def start_loading(window: MainWindow, folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    np.save(folder.at / "slow.npy", table())
    endless(monkeypatch, folder.at / "slow.npy")
    window.open_scans([folder.at / "slow.npy"])


def start_tuning(window: MainWindow, folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    gesture = window.bench.document.begin_gesture()
    for cell in np.linspace(0.1, 0.6, 20):
        window.bench.document.set_parameters("Cell", gesture, cell_size=float(cell))


def start_drawing(window: MainWindow, folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    for step in range(10):
        window.bench.trio.viewpoint.look(window.bench.trio.viewpoint.camera.orbited(step, 0))
    window.bench.feeds.scene.ask()
    window.bench.feeds.plot._cut()


def start_exporting(window: MainWindow, folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    def endless_export(wanted: Any, progress: Any) -> Any:
        while True:
            progress(0.5, "writing")
            time.sleep(0.001)

    monkeypatch.setattr("stepfield_app.dialogs.export.export", endless_export)
    dialog = ExportDialog(window.bench.document, window.settings, window.appearance.theme, window)
    dialog.folder_choice._name.setText(str(folder.at / "stack"))
    dialog.open()
    dialog.start()
    assert dialog._writer.busy


def nothing_to_wait_for(window: MainWindow, folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    """Close at once."""


@pytest.mark.parametrize(
    "start", [start_loading, start_tuning, start_drawing, start_exporting, nothing_to_wait_for]
)
def test_closing_a_busy_window_leaves_nothing(
    own: MainWindow,
    folder: Folder,
    qtbot: QtBot,
    monkeypatch: pytest.MonkeyPatch,
    start: Callable[[MainWindow, Folder, pytest.MonkeyPatch], None],
) -> None:
    if start is not nothing_to_wait_for:
        open_in(own, qtbot, folder.table)
    start(own, folder, monkeypatch)
    process, folders = own.bench.client.process_id, own.bench.client._store.folders
    workers = [worker._thread for worker in own.findChildren(NewestWins)]
    assert len(workers) >= 7
    if start is not nothing_to_wait_for:  # a thread starts with its first work
        assert sum(thread is not None and thread.is_alive() for thread in workers) >= 4
    own.filing.close_without()
    assert not [widget for widget in QApplication.topLevelWidgets() if widget.isVisible()]
    assert not process or not psutil.pid_exists(process)
    assert not any(folder.exists() for folder in folders)
    left = [thread.name for thread in workers if thread is not None and thread.is_alive()]
    assert not left, f"threads left: {left}"


def test_a_window_closed_before_it_drew_leaves_nothing(
    qtbot: QtBot, tmp_path: Path, appearance: Appearance
) -> None:
    window = made(tmp_path, appearance)
    qtbot.waitUntil(lambda: window.bench.client.process_id != 0)
    number, folders = window.bench.client.process_id, window.bench.client._store.folders
    discarded(window)
    assert not psutil.pid_exists(number)
    assert not any(folder.exists() for folder in folders)
