"""A picture of the window: taken once everything is drawn, and never instead of an error."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from stepfield.errors import Cancelled, ScanError, StepfieldError
from stepfield_app import screenshot
from stepfield_app.screenshot import QUIET_LOOKS, Screenshot


class Window(QWidget):
    """A window that settles when a test says so."""

    def __init__(self) -> None:
        super().__init__()
        self.resize(320, 200)
        self.trouble: StepfieldError | None = None
        self.settles_after, self.looks = 0, 0
        self.unsettled_at: set[int] = set()
        self.is_closed = False

    def is_settled(self) -> bool:
        self.looks += 1
        return self.looks > self.settles_after and self.looks not in self.unsettled_at

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        self.is_closed = True


@pytest.fixture
def window(qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> Window:
    monkeypatch.setattr(screenshot, "LOOK", 1)
    window = Window()
    qtbot.addWidget(window)
    window.show()
    return window


def test_it_waits_until_the_window_has_settled(window: Window, qtbot: QtBot, tmp_path: Path) -> None:
    """If it failed, the picture would show half a scan."""
    window.settles_after = 12
    shot = Screenshot(window, tmp_path / "window.png")
    qtbot.waitUntil(lambda: window.is_closed)
    assert window.looks == 12 + QUIET_LOOKS
    assert shot.failure is None
    with Image.open(tmp_path / "window.png") as taken:
        assert taken.size == (320, 200)


def test_a_moment_of_quiet_is_not_enough(window: Window, qtbot: QtBot, tmp_path: Path) -> None:
    """Between two stages of the work nothing runs for a moment."""
    window.unsettled_at = {1, QUIET_LOOKS, 2 * QUIET_LOOKS - 1}
    Screenshot(window, tmp_path / "window.png")
    qtbot.waitUntil(lambda: window.is_closed)
    assert window.looks == 3 * QUIET_LOOKS - 1


def test_trouble_is_told_and_no_picture_saved(window: Window, qtbot: QtBot, tmp_path: Path) -> None:
    """If it failed, a build would publish a picture of an error message."""
    window.settles_after = 10**6
    shot = Screenshot(window, tmp_path / "window.png")
    window.trouble = ScanError("scan.ply: not a scan")
    qtbot.waitUntil(lambda: window.is_closed)
    assert shot.failure is window.trouble
    assert not (tmp_path / "window.png").exists()


def test_what_never_settles_is_given_up(
    window: Window, qtbot: QtBot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(screenshot, "MOST_LOOKS", 20)
    window.settles_after = 10**6
    shot = Screenshot(window, tmp_path / "window.png")
    qtbot.waitUntil(lambda: window.is_closed)
    assert window.looks == 20
    assert "was not drawn" in str(shot.failure)
    assert not (tmp_path / "window.png").exists()


def test_a_place_that_cannot_be_written_is_one_sentence(window: Window, qtbot: QtBot, tmp_path: Path) -> None:
    shot = Screenshot(window, tmp_path / "absent" / "window.png")
    qtbot.waitUntil(lambda: window.is_closed)
    assert str(shot.failure).endswith("window.png: the picture cannot be written; choose another place")


def test_a_window_closed_too_early_is_no_success(window: Window, qtbot: QtBot, tmp_path: Path) -> None:
    window.settles_after = 10**6
    shot = Screenshot(window, tmp_path / "window.png")
    qtbot.waitUntil(lambda: window.looks > 1)
    window.close()
    assert isinstance(shot.failure, Cancelled)
