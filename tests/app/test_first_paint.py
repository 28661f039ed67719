"""What waits for the window to be on the screen."""

from __future__ import annotations

import pytest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from stepfield_app import first_paint as module
from stepfield_app.first_paint import FirstPaint


class Painted(QWidget):
    """Notes when it is painted."""

    def __init__(self, notes: list[str]) -> None:
        super().__init__()
        self._notes = notes

    def paintEvent(self, event: object) -> None:  # noqa: N802
        self._notes.append("painted")


def test_it_happens_once_after_all_is_painted(qtbot: QtBot) -> None:
    notes: list[str] = []
    window, inner = QWidget(), Painted(notes)
    qtbot.addWidget(window)
    inner.setParent(window)
    first = FirstPaint(window)
    first.happened.connect(lambda: notes.append("happened"))
    with qtbot.waitSignal(first.happened):
        window.show()
    assert notes == ["painted", "happened"]
    window.update()
    qtbot.waitUntil(lambda: notes[-1] == "painted")
    assert notes.count("happened") == 1


def test_it_does_not_happen_to_a_window_that_was_closed_at_once(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What begins then would outlive the window."""
    notes: list[str] = []
    window = QWidget()
    qtbot.addWidget(window)
    monkeypatch.setattr(module, "PATIENCE", 0)
    FirstPaint(window).happened.connect(lambda: notes.append("happened"))
    window.show()
    window.close()
    QApplication.processEvents()
    assert not notes
    window.show()
    qtbot.waitUntil(lambda: bool(notes))
