"""Opening into the window: everything follows, what fails leaves all as it was; dialog, recent, dropped."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QApplication,
    QLabel,
    QMenu,
    QWidget,
)
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import UTM, table
from tests.app.window.whole import BASE, Folder, endless, open_in, sentences

from stepfield.errors import StepfieldError
from stepfield.project import Project, ScanFile
from stepfield_app.main_window import MainWindow
from stepfield_app.render.scene import CLOUD, PILLARS, VIEWS

# --- Opening ------------------------------------------------------------------------------------------------


def test_an_empty_window_offers_what_to_do(window: MainWindow) -> None:
    assert window.welcome.isVisible()
    assert not window.bench.trio.isVisible()
    assert window.windowTitle() == "Stepfield"
    needing = ("close", "export", "iso", "fit", "crop", "profile line", "only cloud", "parallel")
    assert not any(window.commands[name].isEnabled() for name in needing)
    assert all(window.commands[name].isEnabled() for name in ("open", "demo", "quit", "keys", "about"))
    assert not any(window.commands[name].isEnabled() for name in ("undo", "redo"))


def test_an_opened_scan_is_everywhere(opened: MainWindow, folder: Folder) -> None:
    assert opened.bench.trio.isVisible()
    assert opened.windowTitle() == "table.npy – Stepfield"
    for view in VIEWS:
        frame, canvas = opened.bench.client.frame(view), opened.bench.trio.canvases[view]
        assert frame is not None
        assert not frame.moving
        assert frame.covered > 500, f"the view {view} shows nothing"
        assert frame.pixels.shape[:2] == canvas.pixels[::-1]
    assert opened.bench.profile.section is not None, "a first profile shows what the panel is for"
    assert len(opened.bench.layers.model.visible_layers) >= 2
    assert opened.commands["export"].isEnabled()
    assert opened.settings.recent[0] == (folder.table,)
    assert not sentences(opened)


def test_what_is_under_the_cursor_is_what_lies_there(opened: MainWindow, qtbot: QtBot) -> None:
    """If it failed, the readout and the rotation centre would be beside the thing that is pointed at."""
    opened.bench.trio.look_from("top")
    qtbot.waitUntil(opened.is_settled)
    canvas = opened.bench.trio.canvases[PILLARS]
    for expected in ((3.6, 3.1, 1.0), (1.1, 1.2, 0.0)):
        place = canvas.place_at(canvas.pixel_of(expected))
        assert place is not None
        assert place == pytest.approx(expected, abs=0.06)


def test_several_files_are_one_scan(window: MainWindow, folder: Folder, qtbot: QtBot) -> None:
    other = folder.at / "second.npy"
    np.save(other, table((10.0, 0.0, 0.0)))
    open_in(window, qtbot, folder.table, other)
    assert window.windowTitle() == "table.npy and 1 more – Stepfield"
    assert window.bench.document.facts is not None
    assert window.bench.document.facts.points == 2 * len(table())
    assert window.settings.recent[0] == (folder.table, other)


def test_another_scan_takes_the_place_of_the_first(opened: MainWindow, folder: Folder, qtbot: QtBot) -> None:
    opened.bench.document.set_parameters("Alpha", alpha=0.7)
    open_in(opened, qtbot, folder.utm)
    assert opened.windowTitle() == "far & away.npy – Stepfield"
    assert opened.bench.document.undo_stack.count() == 0
    assert opened.bench.feeds.scene.origin == pytest.approx(UTM)
    assert opened.bench.profile.section is not None
    assert opened.bench.profile.section.start[0] == pytest.approx(UTM[0])
    assert len(opened.bench.profile.section.distance) > 10
    assert not sentences(opened)


def test_a_project_opens_with_its_parameters(window: MainWindow, folder: Folder, qtbot: QtBot) -> None:
    file = folder.at / "work.stepfield"
    Project(scans=(ScanFile(path="table.npy"),), parameters=BASE).save(file)
    with qtbot.waitSignal(window.bench.document.opened):
        window.open_scans([file])
    assert window.bench.document.scans == (folder.table,)
    assert window.bench.document.project.parameters == BASE


@pytest.mark.parametrize("name", ["broken.ply", "absent.laz", "broken.stepfield"])
def test_what_cannot_be_opened_leaves_everything_as_it_was(
    opened: MainWindow, folder: Folder, qtbot: QtBot, name: str
) -> None:
    (folder.at / "broken.stepfield").write_text("{}")
    answer, title, camera = (
        opened.bench.document.answer,
        opened.windowTitle(),
        opened.bench.trio.viewpoint.camera.orbited(5, 5),
    )
    opened.bench.trio.viewpoint.look(camera)
    opened.open_scans([folder.at / name])
    qtbot.waitUntil(lambda: bool(sentences(opened)))
    qtbot.waitUntil(opened.is_settled)
    assert len(sentences(opened)) == 1
    assert name in sentences(opened)[0]
    assert "Traceback" not in sentences(opened)[0]
    assert isinstance(opened.trouble, StepfieldError)
    assert opened.bench.document.answer is answer
    assert (opened.windowTitle(), opened.bench.trio.viewpoint.camera) == (title, camera)
    assert opened.bench.trio.isVisible()
    assert folder.table in opened.settings.recent[0]


@pytest.mark.parametrize("is_open", [False, True])
def test_a_message_goes_when_it_is_dismissed_with_a_key(
    window: MainWindow, folder: Folder, qtbot: QtBot, is_open: bool
) -> None:
    """Escape works with and without a scan, and where the message itself has the keyboard."""
    if is_open:
        open_in(window, qtbot, folder.table)
    window.activateWindow()
    for has_focus in (False, True):
        window.message_bar.tell("error", "Something is wrong.")
        button = window.message_bar.findChildren(QAbstractButton)[-1]
        focused = button if has_focus else window.bench.trio.canvases[CLOUD] if is_open else window.welcome
        focused.setFocus()
        QTest.keyClick(focused, Qt.Key.Key_Escape)
        assert not sentences(window), "Esc did nothing" + " in the message" * has_focus


def test_a_load_can_be_cancelled(
    opened: MainWindow, folder: Folder, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = folder.at / "slow.npy"
    np.save(slow, table())
    endless(monkeypatch, slow)
    answer, files = opened.bench.document.answer, stored(opened)
    opened.open_scans([slow])
    qtbot.waitUntil(lambda: said_by_status(opened, "reading slow.npy"))
    stop = next(button for button in opened.status.findChildren(QAbstractButton) if button.isVisible())
    assert not opened.is_settled()
    stop.click()
    qtbot.waitUntil(opened.is_settled)
    assert opened.bench.document.answer is answer
    assert opened.bench.document.scans == (folder.table,)
    assert opened.windowTitle() == "table.npy – Stepfield"
    assert not sentences(opened)
    assert not said_by_status(opened, "reading")
    assert stored(opened) == files
    assert slow not in opened.settings.recent[0]


def stored(window: MainWindow) -> int:
    """Files that the window shares with the drawing process."""
    return sum(len(list(folder.iterdir())) for folder in window.bench.client._store.folders)


def said_by_status(window: MainWindow, text: str) -> bool:
    return any(text in label.text() for label in window.status.findChildren(QLabel) if label.isVisible())


def test_recent_files_are_offered_and_open(opened: MainWindow, folder: Folder, qtbot: QtBot) -> None:
    open_in(opened, qtbot, folder.utm)
    opened.bench.document.close_scan()
    recent = next(menu for menu in opened.findChildren(QMenu) if menu.title() == "Open &recent")
    recent.aboutToShow.emit()
    texts = [action.text() for action in recent.actions() if action.text()]
    assert texts[:2] == ["far && away.npy", "table.npy"]
    with qtbot.waitSignal(opened.bench.document.opened):
        next(action for action in recent.actions() if action.text() == "table.npy").trigger()
    assert opened.bench.document.scans == (folder.table,)
    forget = recent.actions()[-1]
    forget.trigger()
    recent.aboutToShow.emit()
    assert [action.text() for action in recent.actions()] == ["Nothing yet"]
    opened.bench.document.close_scan()
    assert not [
        button
        for button in opened.welcome.findChildren(QAbstractButton)
        if "again" in button.accessibleName() and button.isVisible()
    ]


def test_a_closed_scan_leaves_an_empty_window(opened: MainWindow, qtbot: QtBot) -> None:
    opened.commands["crop"].setChecked(True)
    opened.commands["close"].trigger()
    qtbot.waitUntil(opened.is_settled)
    assert opened.welcome.isVisible()
    assert opened.windowTitle() == "Stepfield"
    assert opened.bench.map.line is None
    assert opened.bench.profile.section is None
    assert opened.bench.layers.model.rowCount() == 0
    assert opened.bench.document.undo_stack.count() == 0
    assert opened.bench.map.plot._empty_text
    assert opened.bench.histogram._empty_text
    assert not any(opened.commands[name].isChecked() for name in ("crop", "profile line"))
    assert not opened.commands["export"].isEnabled()
    figures = [label.text() for label in opened.status.findChildren(QLabel) if label.isVisible()]
    assert not any(figures), f"the status bar still says {figures}"


def test_what_was_under_way_does_not_fill_an_empty_window(opened: MainWindow, qtbot: QtBot) -> None:
    """A picture that arrives after its scan was closed must not be shown."""
    opened.bench.feeds.plot._draw(0, "gray")
    opened.bench.feeds.plot._cut()
    opened.bench.document.close_scan()
    qtbot.waitUntil(opened.is_settled)
    assert opened.bench.map.plot._empty_text
    assert opened.bench.profile.section is None


# --- Dropping -----------------------------------------------------------------------------------------------


def drop(widget: QWidget, *files: Path) -> bool:
    """Drop files on a widget as the window system does; whether they were taken."""
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(file)) for file in files])
    at, action, left = QPoint(3, 3), Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton
    enter = QDragEnterEvent(at, action, data, left, Qt.KeyboardModifier.NoModifier)
    enter.ignore()
    QApplication.sendEvent(widget, enter)
    if not enter.isAccepted():
        return False
    event = QDropEvent(QPointF(at), action, data, left, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(widget, event)
    return True


def places(window: MainWindow, is_open: bool) -> dict[str, QWidget]:
    found: dict[str, QWidget] = {
        "parameters": window.bench.parameters,
        "a number": window.bench.parameters.findChildren(QAbstractSpinBox)[0],
        "layers": window.bench.layers,
        "list of layers": window.bench.layers.view.viewport(),
        "map": window.bench.map.plot.viewport(),
        "profile": window.bench.profile.plot.viewport(),
        "histogram": window.bench.histogram.viewport(),
        "status bar": window.status,
    }
    if is_open:
        return found | {view: window.bench.trio.canvases[view] for view in VIEWS}
    return found | {"welcome page": window.welcome}


@pytest.mark.parametrize("is_open", [False, True])
def test_a_scan_can_be_dropped_anywhere(
    window: MainWindow, folder: Folder, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, is_open: bool
) -> None:
    if is_open:
        open_in(window, qtbot, folder.table)
    taken: list[Any] = []
    monkeypatch.setattr(window.bench.document, "open", lambda files, parameters: taken.append(files))
    for name, widget in places(window, is_open).items():
        taken.clear()
        assert drop(widget, folder.utm, folder.at / "notes.md"), f"{name} refuses a scan"
        assert taken == [(folder.utm,)], f"{name} swallows a scan"
        assert not drop(widget, folder.at / "notes.md"), f"{name} takes what cannot be opened"
