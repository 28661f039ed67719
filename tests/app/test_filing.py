"""The window and its files: titles, questions before anything is lost, and everything as it was left."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QCoreApplication, QEvent, QSettings, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QPushButton
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import UTM, table

from stepfield.parameters import Parameters
from stepfield.project import Project
from stepfield_app.appearance import Appearance
from stepfield_app.commands import filing
from stepfield_app.dialogs.missing import MissingScans
from stepfield_app.dialogs.question import Question
from stepfield_app.main_window import MainWindow
from stepfield_app.render.scene import PILLARS
from stepfield_app.settings import Settings
from stepfield_app.views.line import ProfileLine
from stepfield_app.views.remembered import Remembered

BASE = Parameters(cell_size=0.5, layer_tolerance=0.3, alpha=0.5)


@pytest.fixture(scope="module")
def appearance(qapp: QApplication) -> Appearance:
    return Appearance(qapp, "dark")


@pytest.fixture(scope="module")
def shared(appearance: Appearance, tmp_path_factory: pytest.TempPathFactory) -> Iterator[MainWindow]:
    """One window for all tests, with settings of its own."""
    settings = QSettings(str(tmp_path_factory.mktemp("s") / "settings.ini"), QSettings.Format.IniFormat)
    window = MainWindow(appearance, Settings(settings), size=(1280, 800))
    yield window
    window.filing.close_without()
    window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


@pytest.fixture
def window(shared: MainWindow, qtbot: QtBot) -> Iterator[MainWindow]:
    shared.show()
    yield shared
    for dialog in (*shared.findChildren(Question), *shared.findChildren(MissingScans)):
        dialog.reject()
    shared.bench.document.close_scan()
    qtbot.waitUntil(shared.is_settled)
    shared.message_bar.dismiss_all()
    shared.hide()


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    np.save(tmp_path / "table.npy", table(UTM))
    return tmp_path / "table.npy"


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the operator saves whenever asked."""
    path = tmp_path / "room.stepfield"
    monkeypatch.setattr(filing, "ask_for_place", lambda parent, start: path)
    return path


@pytest.fixture
def opened(window: MainWindow, qtbot: QtBot, scan: Path) -> MainWindow:
    return open_in(window, qtbot, scan)


@pytest.fixture
def edited(opened: MainWindow, qtbot: QtBot) -> MainWindow:
    opened.bench.document.set_parameters("Alpha", alpha=0.7)
    qtbot.waitUntil(opened.is_settled)
    return opened


def open_in(window: MainWindow, qtbot: QtBot, file: Path) -> MainWindow:
    with qtbot.waitSignal(window.bench.document.opened):
        window.open_scans([file], BASE)
    qtbot.waitUntil(window.is_settled)
    return window


def question(window: MainWindow) -> Question:
    (asked,) = window.findChildren(Question)
    return asked


def answer(window: MainWindow, text: str, qtbot: QtBot) -> None:
    asked = question(window)
    asked.choose(text)
    qtbot.waitUntil(lambda: not window.findChildren(Question))


def sentences(window: MainWindow) -> list[str]:
    return [message.sentence for message in window.message_bar.messages]


# --- Saving -------------------------------------------------------------------------------------------------


def test_saving_by_keys_names_and_unmarks_the_window(
    edited: MainWindow, qtbot: QtBot, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert (edited.windowTitle(), edited.isWindowModified()) == ("table.npy[*] – Stepfield", True)
    QTest.keyClick(edited, Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: not edited.bench.document.file.dirty)
    assert (edited.windowTitle(), edited.isWindowModified()) == ("room.stepfield – Stepfield", False)
    assert edited.settings.recent[0] == (file,)
    other = file.with_name("other.stepfield")
    monkeypatch.setattr(filing, "ask_for_place", lambda parent, start: other)
    both = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
    QTest.keyClick(edited, Qt.Key.Key_S, both)
    qtbot.waitUntil(lambda: edited.windowTitle() == "other.stepfield – Stepfield")
    assert Project.read(other).parameters == Project.read(file).parameters


def test_a_save_dialog_that_is_left_saves_nothing(
    edited: MainWindow, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(filing, "ask_for_place", lambda parent, start: None)
    edited.commands["save"].trigger()
    assert edited.filing.is_idle
    assert edited.bench.document.file.dirty
    assert not file.exists()


def test_a_project_opens_as_it_was_left(opened: MainWindow, qtbot: QtBot, scan: Path, file: Path) -> None:
    """If it failed, every morning would begin with finding the place again."""
    document, trio = opened.bench.document, opened.bench.trio
    trio.arrange((PILLARS,))
    trio.viewpoint.look(trio.viewpoint.camera.orbited(40, 20).zoomed(2.0))
    camera, line = trio.viewpoint.camera, ProfileLine((UTM[0], UTM[1]), (UTM[0] + 3, UTM[1] + 2), 0.5)
    opened.bench.map.set_line(line)
    opened.bench.map.set_mode("gray")
    document.set_active_layer(1)
    opened.filing.save()
    qtbot.waitUntil(opened.is_settled)
    open_in(opened, qtbot, scan)
    trio.arrange(("cloud", "pillars", "reconstruction"))
    opened.bench.map.set_mode("hillshade")
    assert document.active_layer == 0
    open_in(opened, qtbot, file)
    assert trio.shown == (PILLARS,)
    assert trio.viewpoint.camera.centre == pytest.approx(camera.centre, abs=1e-6)
    assert trio.viewpoint.camera.distance == camera.distance
    assert (opened.bench.map.line, opened.bench.map.mode, opened.bench.map.layer) == (line, "gray", 1)
    assert document.active_layer == 1
    assert not document.file.dirty
    trio.arrange(("cloud", "pillars", "reconstruction"))


@pytest.mark.parametrize(
    "view",
    [
        {"camera": {"centre": [1, 2], "azimuth": 0}, "shown": "cloud", "layer": "two", "map": 3, "line": []},
        {
            "camera": {"centre": [0, 0, 0], "azimuth": 0, "elevation": 0, "distance": float("nan")},
            "layer": 99,
        },
        {"shown": ["nothing"], "map": "upside down", "layer": -7, "line": {"start": [0, 0], "end": [0, 0]}},
        {"of a newer version": {"a": 1}},
    ],
)
def test_a_damaged_view_does_not_keep_a_project_from_opening(
    opened: MainWindow, qtbot: QtBot, file: Path, view: dict[str, object]
) -> None:
    document = opened.bench.document
    document.project.model_copy(update={"view": {}}).save(file)
    remembered = Remembered.read(view)
    assert remembered.camera is None
    project = document.project.model_copy(update={"view": view})
    with qtbot.waitSignal(document.opened):
        document.open_project(project)
    assert opened.bench.trio.shown
    assert -1 <= document.active_layer < 2


# --- Before anything is lost --------------------------------------------------------------------------------


def test_closing_asks_and_cancel_stays(edited: MainWindow, qtbot: QtBot) -> None:
    edited.close()
    assert edited.isVisible()
    assert "table.npy has edits" in question(edited).text()
    edited.close()
    answer(edited, "Cancel", qtbot)
    assert edited.isVisible()
    assert edited.bench.document.file.dirty


def test_another_scan_is_opened_once_the_edits_are_saved(
    edited: MainWindow, qtbot: QtBot, scan: Path, file: Path
) -> None:
    edited.open_scans([scan], BASE)
    with qtbot.waitSignal(edited.bench.document.opened):
        answer(edited, "&Save", qtbot)
    assert Project.read(file).parameters.alpha == 0.7
    assert edited.bench.document.project.parameters.alpha == 0.5
    assert edited.bench.document.file.stored is None


def test_edits_that_nobody_wants_go_only_when_the_next_scan_is_there(
    edited: MainWindow, qtbot: QtBot, scan: Path
) -> None:
    edited.open_scans([scan.with_name("absent.npy")])
    answer(edited, "&Don't save", qtbot)
    qtbot.waitUntil(lambda: bool(sentences(edited)))
    assert edited.bench.document.file.dirty, "the scan could not be opened: the edits are still there to save"
    edited.open_scans([scan], BASE)
    with qtbot.waitSignal(edited.bench.document.opened):
        answer(edited, "&Don't save", qtbot)


def test_a_save_that_fails_opens_nothing(
    edited: MainWindow, qtbot: QtBot, scan: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    nowhere = scan.parent / "absent" / "a.stepfield"
    monkeypatch.setattr(filing, "ask_for_place", lambda parent, start: nowhere)
    edited.open_scans([scan], BASE)
    answer(edited, "&Save", qtbot)
    qtbot.waitUntil(lambda: any("cannot write" in sentence for sentence in sentences(edited)))
    qtbot.waitUntil(edited.is_settled)
    assert edited.bench.document.project.parameters.alpha == 0.7


def test_closing_the_scan_asks_too(edited: MainWindow, qtbot: QtBot) -> None:
    edited.commands["close"].trigger()
    answer(edited, "Cancel", qtbot)
    assert edited.bench.document.answer is not None
    edited.commands["close"].trigger()
    answer(edited, "&Don't save", qtbot)
    assert edited.bench.document.answer is None
    assert edited.windowTitle() == "Stepfield"


def test_a_window_closes_after_what_it_was_saving(
    appearance: Appearance, qtbot: QtBot, scan: Path, file: Path, tmp_path: Path
) -> None:
    settings = QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat)
    window = MainWindow(appearance, Settings(settings), size=(1280, 800))
    window.show()
    open_in(window, qtbot, scan)
    window.bench.document.set_parameters("Alpha", alpha=0.7)
    window.close()
    assert window.isVisible()
    answer(window, "&Save", qtbot)
    qtbot.waitUntil(lambda: not window.isVisible())
    assert Project.read(file).parameters.alpha == 0.7
    window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


# --- What others did ----------------------------------------------------------------------------------------


def test_the_work_of_another_window_is_asked_about(edited: MainWindow, qtbot: QtBot, file: Path) -> None:
    edited.filing.save()
    qtbot.waitUntil(edited.is_settled)
    theirs = Project.read(file).model_copy(update={"parameters": Parameters(bits=8)})
    theirs.save(file)
    qtbot.waitUntil(lambda: bool(sentences(edited)))
    assert sentences(edited)[0].startswith("room.stepfield was changed by another window")
    edited.bench.document.set_parameters("Alpha", alpha=0.9)
    edited.filing.save()
    qtbot.waitUntil(lambda: bool(edited.findChildren(Question)))
    answer(edited, "Cancel", qtbot)
    assert Project.read(file) == theirs
    edited.filing.save()
    qtbot.waitUntil(lambda: bool(edited.findChildren(Question)))
    answer(edited, "&Overwrite", qtbot)
    qtbot.waitUntil(lambda: not edited.bench.document.file.dirty)
    assert Project.read(file).parameters.alpha == 0.9


def test_a_missing_scan_is_asked_for_in_a_dialog(
    opened: MainWindow, qtbot: QtBot, scan: Path, file: Path, tmp_path: Path
) -> None:
    opened.filing.save()
    qtbot.waitUntil(opened.is_settled)
    there = tmp_path / "moved" / "table.npy"
    there.parent.mkdir()
    shutil.move(scan, there)
    opened.open_scans([file])
    qtbot.waitUntil(lambda: bool(opened.findChildren(MissingScans)))
    (dialog,) = opened.findChildren(MissingScans)
    assert not dialog.open_button.isEnabled()
    assert any(str(scan) in label.text() for label in dialog.findChildren(QLabel))
    assert all(button.toolTip() for button in dialog.findChildren(QPushButton))
    dialog.place(scan, there)
    with qtbot.waitSignal(opened.bench.document.opened):
        dialog.open_button.click()
    assert opened.bench.document.scans == (there,)
    assert opened.isWindowModified()


def test_a_scan_that_is_another_is_warned_of(
    opened: MainWindow, qtbot: QtBot, scan: Path, file: Path
) -> None:
    opened.filing.save()
    qtbot.waitUntil(opened.is_settled)
    np.save(scan, table(UTM) * [1, 1, 1.01])
    open_in(opened, qtbot, file)
    qtbot.waitUntil(lambda: bool(sentences(opened)))
    assert sentences(opened)[0].startswith("table.npy is not the file the project was made from")
