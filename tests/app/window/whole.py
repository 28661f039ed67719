"""The whole window with its real drawing process, on no screen, and scans to work on."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication, QEvent, QSettings
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import UTM, table

from stepfield.parameters import Parameters
from stepfield.scan import read_scan
from stepfield_app.appearance import Appearance
from stepfield_app.main_window import MainWindow
from stepfield_app.settings import Settings

BASE = Parameters(cell_size=0.5, layer_tolerance=0.3, alpha=0.5)


@dataclass
class Folder:
    """Scans of the tests."""

    at: Path
    table: Path = field(init=False)
    utm: Path = field(init=False)
    broken: Path = field(init=False)

    def __post_init__(self) -> None:
        self.table, self.utm = self.at / "table.npy", self.at / "far & away.npy"
        np.save(self.table, table())
        np.save(self.utm, table(UTM))
        self.broken = self.at / "broken.ply"
        self.broken.write_bytes(b"ply\nformat binary_little_endian 1.0\nelement vertex 5\n")


def made(folder: Path, appearance: Appearance) -> MainWindow:
    """Make a window with settings of its own, shown."""
    settings = Settings(QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat))
    window = MainWindow(appearance, settings, size=(1280, 800))
    window.show()
    return window


def discarded(window: MainWindow) -> None:
    window.filing.close_without()
    window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


def open_in(window: MainWindow, qtbot: QtBot, *files: Path) -> MainWindow:
    window.bench.document.file.give_up()  # no question about earlier edits
    with qtbot.waitSignal(window.bench.document.opened):
        window.open_scans(files, BASE)
    qtbot.waitUntil(window.is_settled)
    return window


def sentences(window: MainWindow) -> list[str]:
    return [message.sentence for message in window.message_bar.messages]


def picture(widget: QWidget) -> NDArray[np.uint8]:
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    array = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.width(), 4)
    return array[..., 2::-1].copy()


def endless(monkeypatch: pytest.MonkeyPatch, slow: Path) -> None:
    """Make reading one file go on until it is cancelled."""

    def reading(paths: Any, unit: Any, up: Any, progress: Any) -> Any:
        while slow in paths:
            progress(0.25, f"reading {slow.name}")
            time.sleep(0.001)
        return read_scan(paths, unit, up, progress)

    monkeypatch.setattr("stepfield.pipeline.read_scan", reading)
