"""What comes after the first paint of the window, in pieces, and what happens to who does not wait for it."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QSettings
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from stepfield_app.afterwards import Afterwards
from stepfield_app.appearance import Appearance
from stepfield_app.dropping import DropTarget
from stepfield_app.frame import USUAL_SIZE
from stepfield_app.main_window import MainWindow
from stepfield_app.panels.page import GRID
from stepfield_app.settings import Settings

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks


class Made:
    """Counts what was made."""

    def __init__(self, parent: QObject) -> None:
        self.notes: list[str] = []
        self.fails = False
        self.afterwards = Afterwards(lambda: self.notes.append("loaded"), self._pieces, parent)
        self.afterwards.done.connect(lambda: self.notes.append("done"))

    def _pieces(self) -> Iterator[None]:
        for name in ("first", "second"):
            self.notes.append(name)
            yield
        if self.fails:
            raise ValueError("nobody thought of this")
        self.notes.append("last")


@pytest.fixture
def made(qapp: QApplication) -> Iterator[Made]:
    parent = QObject()
    made = Made(parent)
    yield made
    made.afterwards.stop()


@pytest.fixture
def window(qtbot: QtBot, tmp_path: Path) -> Iterator[MainWindow]:
    application = QApplication.instance()
    assert isinstance(application, QApplication)
    settings = Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))
    window = MainWindow(Appearance(application, "dark"), settings, size=(1280, 800), in_pieces=True)
    yield window
    window.close()
    window.deleteLater()


def test_pieces_are_made_in_order_once_they_are_loaded(qtbot: QtBot, made: Made) -> None:
    with qtbot.waitSignal(made.afterwards.done):
        made.afterwards.begin()
    assert made.notes == ["loaded", "loaded", "first", "second", "last", "done"]


def test_what_is_half_made_is_made_whole_before_it_is_left(qtbot: QtBot, made: Made) -> None:
    """Threads of what is there already could not be ended otherwise."""
    made.afterwards.begin()
    qtbot.waitUntil(lambda: "first" in made.notes)
    made.afterwards.stop()
    assert made.notes[-2:] == ["last", "done"]
    assert made.afterwards.is_done


def test_nothing_is_begun_for_who_has_left(qtbot: QtBot, made: Made) -> None:
    made.afterwards.begin()
    made.afterwards.stop()
    QApplication.processEvents()
    assert made.notes == ["loaded"]


def test_a_piece_that_fails_is_the_last(qtbot: QtBot, made: Made) -> None:
    """What lacks a piece must not pass for whole."""
    made.fails = True
    with pytest.raises(ValueError, match="nobody"):
        made.afterwards.finish()
    made.afterwards.stop()
    assert not made.afterwards.is_done
    assert "done" not in made.notes


def test_the_first_picture_needs_little() -> None:
    """An import that strays into what is painted first costs half a second again."""
    heavy = ("numpy", "pyqtgraph", "stepfield_app.workbench", "stepfield_app.document")
    code = f"import sys, stepfield_app.application; print([n for n in {heavy} if n in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_nothing_moves_when_the_panels_come(qtbot: QtBot, window: MainWindow) -> None:
    """By a few pixels at most: what is asked for at least depends on the fonts of the system."""
    places: list[NDArray[np.int64]] = []

    def note() -> None:
        docks = [dock for dock in window.docks.all if dock.isVisible()]
        places.append(np.array([dock.geometry().getCoords() for dock in docks]))

    window.first_paint.happened.connect(note)
    with qtbot.waitSignal(window.ready):
        window.show()
    QApplication.processEvents()
    note()
    assert np.abs(places[0] - places[1]).max() < GRID


def test_what_is_wished_before_all_is_there_comes_true(
    qtbot: QtBot, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A click in the first half second would be lost, and a scan that is dropped."""
    asked: list[object] = []

    def wish() -> None:
        window.welcome.open_wanted.emit()
        window.findChildren(DropTarget)[0].dropped.emit((Path("/scans/a.laz"),))
        assert not asked

    def listen() -> None:
        monkeypatch.setattr(window.filing, "choose_files", lambda: asked.append("open"))
        monkeypatch.setattr(window.filing, "open", lambda files, _: asked.append(files))

    window.first_paint.happened.connect(wish)
    window.when_ready(listen)
    with qtbot.waitSignal(window.ready):
        window.show()
    assert asked == ["open", (Path("/scans/a.laz"),)]


def test_a_window_that_closes_while_it_is_filled_leaves_nothing(qtbot: QtBot, window: MainWindow) -> None:
    window.first_paint.happened.connect(window.close)
    window.show()
    qtbot.waitUntil(lambda: window.first_paint.has_happened)
    QApplication.processEvents()
    assert not window.isVisible()
    assert not window.is_ready


def test_a_new_window_is_no_larger_than_the_screen(qtbot: QtBot, window: MainWindow) -> None:
    """On a small screen the layers would be out of sight at the very first start."""
    new = MainWindow(window.appearance, window.settings, remembers=False, in_pieces=True)
    room = new.screen().availableSize()
    assert room.width() < USUAL_SIZE.width(), "the screen of this platform was to be small"
    assert new.size() == USUAL_SIZE.boundedTo(room).expandedTo(new.minimumSizeHint())
    assert new.height() < USUAL_SIZE.height()
    new.close()
    new.deleteLater()
