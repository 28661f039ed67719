"""The whole window with its real drawing process, on no screen: opening, working, trouble, leaving."""

from __future__ import annotations

import os
import re
import signal
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication, QEvent, QMimeData, QPoint, QPointF, QSettings, Qt, QTimer, QUrl
from PySide6.QtGui import QAction, QDragEnterEvent, QDropEvent, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLabel,
    QMenu,
    QPlainTextEdit,
    QScrollBar,
    QTabBar,
    QWidget,
)
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import UTM, table

from stepfield.errors import StepfieldError
from stepfield.parameters import Parameters
from stepfield.project import Project, ScanFile
from stepfield.scan import read_scan
from stepfield_app.appearance import Appearance
from stepfield_app.commands import help as help_menu
from stepfield_app.dialogs.export import ExportDialog
from stepfield_app.dialogs.shortcuts import ShortcutSheet, shortcuts_of
from stepfield_app.main_window import MainWindow
from stepfield_app.newest import NewestWins
from stepfield_app.render.scene import CLOUD, PILLARS, VIEWS
from stepfield_app.settings import Settings
from stepfield_app.theme import DARK
from stepfield_app.views.view3d import SENTENCES

LIMIT = 30_000
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


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    return Folder(tmp_path_factory.mktemp("scans"))


@pytest.fixture(scope="module")
def appearance(qapp: QApplication) -> Appearance:
    """One for all windows: it dresses the application."""
    return Appearance(qapp, "dark")


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
    shared.document.close_scan()
    shared.message_bar.dismiss_all()
    yield shared
    for dialog in shared.findChildren(ExportDialog):
        dialog.done(0)
    shared.appearance.choose("dark")
    shared.resize(1280, 800)
    shared.document.close_scan()
    qtbot.waitUntil(shared.is_settled, timeout=LIMIT)
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


def open_in(window: MainWindow, qtbot: QtBot, *files: Path) -> MainWindow:
    window.document.file.give_up()  # no question about earlier edits
    with qtbot.waitSignal(window.document.opened, timeout=LIMIT):
        window.open_scans(files, BASE)
    qtbot.waitUntil(window.is_settled, timeout=LIMIT)
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


# --- Opening ------------------------------------------------------------------------------------------------


def test_an_empty_window_offers_what_to_do(window: MainWindow) -> None:
    assert window.welcome.isVisible()
    assert not window.trio.isVisible()
    assert window.windowTitle() == "Stepfield"
    needing = ("close", "export", "iso", "fit", "crop", "profile line", "only cloud", "parallel")
    assert not any(window.actions_[name].isEnabled() for name in needing)
    assert all(window.actions_[name].isEnabled() for name in ("open", "demo", "quit", "keys", "about"))
    assert not any(window.actions_[name].isEnabled() for name in ("undo", "redo"))


def test_an_opened_scan_is_everywhere(opened: MainWindow, folder: Folder) -> None:
    assert opened.trio.isVisible()
    assert opened.windowTitle() == "table.npy – Stepfield"
    for view in VIEWS:
        frame, canvas = opened.client.frame(view), opened.trio.canvases[view]
        assert frame is not None
        assert not frame.moving
        assert frame.covered > 500, f"the view {view} shows nothing"
        assert frame.pixels.shape[:2] == canvas.pixels[::-1]
    assert opened.profile.section is not None, "a first profile shows what the panel is for"
    assert len(opened.layers.model.visible_layers) >= 2
    assert opened.actions_["export"].isEnabled()
    assert opened.settings.recent[0] == (folder.table,)
    assert not sentences(opened)


def test_what_is_under_the_cursor_is_what_lies_there(opened: MainWindow, qtbot: QtBot) -> None:
    """If it failed, the readout and the rotation centre would be beside the thing that is pointed at."""
    opened.trio.look_from("top")
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)
    canvas = opened.trio.canvases[PILLARS]
    for expected in ((3.6, 3.1, 1.0), (1.1, 1.2, 0.0)):
        place = canvas.place_at(canvas.pixel_of(expected))
        assert place is not None
        assert place == pytest.approx(expected, abs=0.06)


def test_several_files_are_one_scan(window: MainWindow, folder: Folder, qtbot: QtBot) -> None:
    other = folder.at / "second.npy"
    np.save(other, table((10.0, 0.0, 0.0)))
    open_in(window, qtbot, folder.table, other)
    assert window.windowTitle() == "table.npy and 1 more – Stepfield"
    assert window.document.facts is not None
    assert window.document.facts.points == 2 * len(table())
    assert window.settings.recent[0] == (folder.table, other)


def test_another_scan_takes_the_place_of_the_first(opened: MainWindow, folder: Folder, qtbot: QtBot) -> None:
    opened.document.set_parameters("Alpha", alpha=0.7)
    open_in(opened, qtbot, folder.utm)
    assert opened.windowTitle() == "far & away.npy – Stepfield"
    assert opened.document.undo_stack.count() == 0
    assert opened.scene_feed.origin == pytest.approx(UTM)
    assert opened.profile.section is not None
    assert opened.profile.section.start[0] == pytest.approx(UTM[0])
    assert len(opened.profile.section.distance) > 10
    assert not sentences(opened)


def test_a_project_opens_with_its_parameters(window: MainWindow, folder: Folder, qtbot: QtBot) -> None:
    file = folder.at / "work.stepfield"
    Project(scans=(ScanFile(path="table.npy"),), parameters=BASE).save(file)
    with qtbot.waitSignal(window.document.opened, timeout=LIMIT):
        window.open_scans([file])
    assert window.document.scans == (folder.table,)
    assert window.document.project.parameters == BASE


@pytest.mark.parametrize("name", ["broken.ply", "absent.laz", "broken.stepfield"])
def test_what_cannot_be_opened_leaves_everything_as_it_was(
    opened: MainWindow, folder: Folder, qtbot: QtBot, name: str
) -> None:
    (folder.at / "broken.stepfield").write_text("{}")
    answer, title, camera = (
        opened.document.answer,
        opened.windowTitle(),
        opened.trio.viewpoint.camera.orbited(5, 5),
    )
    opened.trio.viewpoint.look(camera)
    opened.open_scans([folder.at / name])
    qtbot.waitUntil(lambda: bool(sentences(opened)), timeout=LIMIT)
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)
    assert len(sentences(opened)) == 1
    assert name in sentences(opened)[0]
    assert "Traceback" not in sentences(opened)[0]
    assert isinstance(opened.trouble, StepfieldError)
    assert opened.document.answer is answer
    assert (opened.windowTitle(), opened.trio.viewpoint.camera) == (title, camera)
    assert opened.trio.isVisible()
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
        focused = button if has_focus else window.trio.canvases[CLOUD] if is_open else window.welcome
        focused.setFocus()
        QTest.keyClick(focused, Qt.Key.Key_Escape)
        assert not sentences(window), "Esc did nothing" + " in the message" * has_focus


def test_a_load_can_be_cancelled(
    opened: MainWindow, folder: Folder, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = folder.at / "slow.npy"
    np.save(slow, table())
    endless(monkeypatch, slow)
    answer, files = opened.document.answer, stored(opened)
    opened.open_scans([slow])
    qtbot.waitUntil(lambda: said_by_status(opened, "reading slow.npy"), timeout=LIMIT)
    stop = next(button for button in opened.status.findChildren(QAbstractButton) if button.isVisible())
    assert not opened.is_settled()
    stop.click()
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)
    assert opened.document.answer is answer
    assert opened.document.scans == (folder.table,)
    assert opened.windowTitle() == "table.npy – Stepfield"
    assert not sentences(opened)
    assert not said_by_status(opened, "reading")
    assert stored(opened) == files
    assert slow not in opened.settings.recent[0]


def stored(window: MainWindow) -> int:
    """Files that the window shares with the drawing process."""
    return sum(len(list(folder.iterdir())) for folder in window.client._store.folders)


def said_by_status(window: MainWindow, text: str) -> bool:
    return any(text in label.text() for label in window.status.findChildren(QLabel) if label.isVisible())


def test_recent_files_are_offered_and_open(opened: MainWindow, folder: Folder, qtbot: QtBot) -> None:
    open_in(opened, qtbot, folder.utm)
    opened.document.close_scan()
    recent = next(menu for menu in opened.findChildren(QMenu) if menu.title() == "Open &recent")
    recent.aboutToShow.emit()
    texts = [action.text() for action in recent.actions() if action.text()]
    assert texts[:2] == ["far && away.npy", "table.npy"]
    with qtbot.waitSignal(opened.document.opened, timeout=LIMIT):
        next(action for action in recent.actions() if action.text() == "table.npy").trigger()
    assert opened.document.scans == (folder.table,)
    forget = recent.actions()[-1]
    forget.trigger()
    recent.aboutToShow.emit()
    assert [action.text() for action in recent.actions()] == ["Nothing yet"]
    opened.document.close_scan()
    assert not [
        button
        for button in opened.welcome.findChildren(QAbstractButton)
        if "again" in button.accessibleName() and button.isVisible()
    ]


def test_a_closed_scan_leaves_an_empty_window(opened: MainWindow, qtbot: QtBot) -> None:
    opened.actions_["crop"].setChecked(True)
    opened.actions_["close"].trigger()
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)
    assert opened.welcome.isVisible()
    assert opened.windowTitle() == "Stepfield"
    assert opened.map.line is None
    assert opened.profile.section is None
    assert opened.layers.model.rowCount() == 0
    assert opened.document.undo_stack.count() == 0
    assert opened.map.plot._empty_text
    assert opened.histogram._empty_text
    assert not any(opened.actions_[name].isChecked() for name in ("crop", "profile line"))
    assert not opened.actions_["export"].isEnabled()
    figures = [label.text() for label in opened.status.findChildren(QLabel) if label.isVisible()]
    assert not any(figures), f"the status bar still says {figures}"


def test_what_was_under_way_does_not_fill_an_empty_window(opened: MainWindow, qtbot: QtBot) -> None:
    """A picture that arrives after its scan was closed must not be shown."""
    opened.plot_feed._draw(0, "gray")
    opened.plot_feed._cut()
    opened.document.close_scan()
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)
    assert opened.map.plot._empty_text
    assert opened.profile.section is None


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
        "parameters": window.parameters,
        "a number": window.parameters.findChildren(QAbstractSpinBox)[0],
        "layers": window.layers,
        "list of layers": window.layers.view.viewport(),
        "map": window.map.plot.viewport(),
        "profile": window.profile.plot.viewport(),
        "histogram": window.histogram.viewport(),
        "status bar": window.status,
    }
    if is_open:
        return found | {view: window.trio.canvases[view] for view in VIEWS}
    return found | {"welcome page": window.welcome}


@pytest.mark.parametrize("is_open", [False, True])
def test_a_scan_can_be_dropped_anywhere(
    window: MainWindow, folder: Folder, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, is_open: bool
) -> None:
    if is_open:
        open_in(window, qtbot, folder.table)
    taken: list[Any] = []
    monkeypatch.setattr(window.document, "open", lambda files, parameters: taken.append(files))
    for name, widget in places(window, is_open).items():
        taken.clear()
        assert drop(widget, folder.utm, folder.at / "notes.md"), f"{name} refuses a scan"
        assert taken == [(folder.utm,)], f"{name} swallows a scan"
        assert not drop(widget, folder.at / "notes.md"), f"{name} takes what cannot be opened"


# --- Trouble ------------------------------------------------------------------------------------------------


def test_a_dead_drawing_process_comes_back_and_nothing_else_notices(opened: MainWindow, qtbot: QtBot) -> None:
    opened.document.set_parameters("Alpha", alpha=0.7)
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)
    canvas, camera = opened.trio.canvases[CLOUD], opened.trio.viewpoint.camera
    before = opened.client.frame(CLOUD)
    project, answer, steps = (
        opened.document.project,
        opened.document.answer,
        opened.document.undo_stack.count(),
    )
    troubles: list[str] = []
    opened.client.state_changed.connect(lambda state: troubles.append(canvas._trouble))
    os.kill(opened.client.process_id, signal.SIGKILL)
    qtbot.waitUntil(lambda: SENTENCES["stopped"] in troubles, timeout=LIMIT)
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)
    after = opened.client.frame(CLOUD)
    assert before is not None
    assert after is not None
    assert after is not before
    assert after.camera == before.camera == camera
    assert np.array_equal(after.pixels, before.pixels)
    assert not canvas._trouble
    assert (opened.document.project, opened.document.answer) == (project, answer)
    assert opened.document.undo_stack.count() == steps
    assert not sentences(opened)


def test_an_unexpected_failure_is_told_with_details(opened: MainWindow) -> None:
    opened.tell(ZeroDivisionError("of a worker"))
    (message,) = opened.message_bar.messages
    assert "ZeroDivisionError: of a worker" in message.details
    assert "ZeroDivisionError" not in message.sentence
    assert opened.document.answer is not None


def test_sixty_sizes_end_settled(opened: MainWindow, qtbot: QtBot) -> None:
    """If it failed, a dragged edge would leave views stretched, or the drawing process behind."""
    rng = np.random.default_rng(1)
    number = opened.client.process_id
    for width, height in zip(rng.integers(900, 1600, 60), rng.integers(600, 1000, 60), strict=True):
        opened.resize(int(width), int(height))
        QApplication.processEvents()
    opened.resize(1111, 777)
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)
    for view in VIEWS:
        frame = opened.client.frame(view)
        assert frame is not None
        assert frame.pixels.shape[:2] == opened.trio.canvases[view].pixels[::-1]
    assert opened.client.process_id == number, "the drawing process has died on the way"


# --- Working ------------------------------------------------------------------------------------------------


def test_steps_are_named_in_the_menu(opened: MainWindow, qtbot: QtBot) -> None:
    undo, redo = opened.actions_["undo"], opened.actions_["redo"]
    assert (undo.text(), undo.isEnabled()) == ("&Undo", False)
    opened.document.set_style("Rename to A & B", 0, name="A & B")
    assert (undo.text(), undo.isEnabled()) == ("&Undo Rename to A && B", True)
    undo.trigger()
    assert (redo.text(), redo.isEnabled(), undo.isEnabled()) == ("&Redo Rename to A && B", True, False)
    redo.trigger()
    assert opened.document.style(0).name == "A & B"
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)


def test_the_theme_changes_everywhere_at_once(opened: MainWindow, qtbot: QtBot) -> None:
    dark = picture(opened)
    opened.actions_["theme light"].setChecked(True)
    assert opened.settings.theme == "light"
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)
    light = picture(opened)
    grounds = {getattr(DARK, name) for name in ("window", "panel", "field")}
    colours = {tuple(int(ground[at : at + 2], 16) for at in (1, 3, 5)) for ground in grounds}
    left = sum(int((light == colour).all(axis=2).sum()) for colour in colours)
    assert left < 0.002 * light[..., 0].size, "something still wears the dark theme"
    for name, part in (*((view, opened.trio.canvases[view]) for view in VIEWS), ("map", opened.map)):
        corner = picture(part)[-4, 4] if name != "map" else picture(part)[3, 3]
        assert corner.min() > 150, f"{name} is still dark"
    opened.actions_["theme dark"].setChecked(True)
    qtbot.waitUntil(opened.is_settled, timeout=LIMIT)
    assert (picture(opened) == dark).all(axis=2).mean() > 0.98, "back in dark something stayed light"


def test_a_theme_of_the_command_line_is_not_remembered(
    qtbot: QtBot, qapp: QApplication, tmp_path: Path
) -> None:
    """If it failed, one picture in light would turn the operator's window light for good."""
    settings = Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))
    appearance = Appearance(qapp, "light")
    window = MainWindow(appearance, settings, size=(800, 600), remembers=False)
    assert window.actions_["theme light"].isChecked()
    assert settings.theme == "system"
    discarded(window)
    appearance.choose("dark")


def test_escape_leaves_the_tool(opened: MainWindow) -> None:
    crop = opened.actions_["crop"]
    crop.trigger()
    assert opened.cleaning.crop.tool.isChecked()
    assert opened.trio.canvases[CLOUD].grip.tool is opened.crop_tool
    QTest.keyClick(opened, Qt.Key.Key_Escape)
    assert not crop.isChecked()
    assert opened.trio.canvases[CLOUD].grip.tool is None
    opened.actions_["profile line"].trigger()
    assert opened.map.plot.is_drawing
    QTest.keyClick(opened, Qt.Key.Key_Escape)
    assert not opened.map.plot.is_drawing


def test_views_are_reached_by_keys(opened: MainWindow) -> None:
    camera = opened.trio.viewpoint.camera
    for key, views in ((Qt.Key.Key_2, (PILLARS,)), (Qt.Key.Key_0, VIEWS)):
        QTest.keyClick(opened, key, Qt.KeyboardModifier.ControlModifier)
        assert opened.trio.shown == views
    opened.trio.viewpoint.look(camera.zoomed(5))
    QTest.keyClick(opened, Qt.Key.Key_F)
    assert opened.trio.viewpoint.camera.distance > camera.distance / 2


def test_f_in_a_plot_fits_the_plot(opened: MainWindow) -> None:
    """The tip of the plot promises it; the window's own F must not take it away."""
    camera = opened.trio.viewpoint.camera.zoomed(5)
    opened.trio.viewpoint.look(camera)
    opened.map.plot.setFocus()
    opened.map.plot.pane.step(1, 0)
    assert opened.map.plot.is_touched
    QTest.keyClick(opened.map.plot, Qt.Key.Key_F)
    assert not opened.map.plot.is_touched
    assert opened.trio.viewpoint.camera == camera


# --- What every control needs -------------------------------------------------------------------------------


def of_the_window(window: MainWindow) -> list[QAction]:
    own = [action for action in window.findChildren(QAction) if action.text() and not action.isSeparator()]
    return [action for action in own if action.objectName() and not action.menu()]


def test_every_action_has_a_text_and_a_tip(opened: MainWindow) -> None:
    for action in of_the_window(opened):
        if action.objectName().startswith(("_q_", "qt_")):
            continue
        assert action.text().strip("& …"), action.objectName()
        assert action.toolTip().strip(), action.objectName()
        assert "&" not in action.toolTip().replace("&&", ""), action.objectName()


def test_no_two_actions_share_a_key(opened: MainWindow) -> None:
    """Qt then runs neither of them."""
    owners: dict[str, set[str]] = {}
    for action in opened.findChildren(QAction):
        for keys in action.shortcuts():
            if action.isEnabled() and keys.toString():
                owners.setdefault(keys.toString(), set()).add(action.objectName() or action.text())
    assert len(owners) > 15
    shared = {keys: names for keys, names in owners.items() if len(names) > 1}
    assert not shared


def test_no_two_entries_of_a_menu_share_a_letter(opened: MainWindow) -> None:
    """Alt and the letter would then only move between them."""
    menus = [menu for menu in opened.findChildren(QMenu) if menu.title()]
    for actions in [opened.menuBar().actions(), *(menu.actions() for menu in menus)]:
        letters = [
            found.group(1).lower()
            for a in actions
            if (found := re.search(r"&([^&\s])", a.text().replace("&&", "")))
        ]
        assert len(set(letters)) == len(letters), [action.text() for action in actions]


def test_every_control_has_a_name_and_a_tip(opened: MainWindow) -> None:
    """If it failed, somebody who cannot see the icon would hear *button*."""
    silent, unexplained = [], []
    for widget in opened.findChildren(QWidget):
        if widget.focusPolicy() == Qt.FocusPolicy.NoFocus and not isinstance(widget, QAbstractButton):
            continue
        if is_inside_another(widget):
            continue
        label = f"{type(widget).__name__} in {type(widget.parent()).__name__}: {spoken(widget)!r}"
        if not spoken(widget):
            silent.append(label)
        if isinstance(widget, CONTROLS) and not widget.toolTip():
            unexplained.append(label)
    assert not silent, f"no name: {silent}"
    assert not unexplained, f"no tip: {unexplained}"


CONTROLS = (QAbstractButton, QComboBox, QAbstractSpinBox, QAbstractSlider)


def spoken(widget: QWidget) -> str:
    text = widget.text() if isinstance(widget, QAbstractButton) else ""
    return widget.accessibleName() or text


def is_inside_another(widget: QWidget) -> bool:
    """Whether a widget is a part of Qt's own that is reached through its parent, or made by Qt itself."""
    if isinstance(widget, QScrollBar | QTabBar | QMenu) or widget.objectName().startswith("qt_"):
        return True
    parents: list[QWidget] = []
    parent = widget.parentWidget()
    while parent is not None:
        parents.append(parent)
        parent = parent.parentWidget()
    made_by_qt = type(widget).__module__.startswith("PySide6") and type(widget).__name__ in (
        "QWidget",
        "QFrame",
    )
    parts = (QAbstractSpinBox, QComboBox, QAbstractItemView, QPlainTextEdit, QTabBar)
    of_qt = type(widget).__name__ in ("QScrollArea", "QMenuBar", "QToolBar", "QDockWidget", "QStackedWidget")
    return made_by_qt or of_qt or any(isinstance(each, parts) for each in parents)


def test_the_sheet_lists_every_key(opened: MainWindow, qtbot: QtBot) -> None:
    listed = {name for entries in shortcuts_of(opened).values() for name, _ in entries}
    for action in of_the_window(opened):
        if action.shortcuts():
            name = action.data()  # what the menu says of it may name a step, or a layer
            assert name in listed, f"the sheet hides {name}"
    seen: list[str] = []

    def look() -> None:
        sheet = opened.findChildren(ShortcutSheet)[0]
        seen.extend(label.text() for label in sheet.findChildren(QLabel))
        sheet.reject()

    QTimer.singleShot(0, look)
    QTest.keyClick(opened, Qt.Key.Key_F1)
    assert {"F1", "Esc", "F"} <= set(seen)
    assert {name for entries in help_menu.GESTURES.values() for name, _ in entries} <= set(seen)


# --- Leaving ------------------------------------------------------------------------------------------------


def start_loading(window: MainWindow, folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    np.save(folder.at / "slow.npy", table())
    endless(monkeypatch, folder.at / "slow.npy")
    window.open_scans([folder.at / "slow.npy"])


def start_tuning(window: MainWindow, folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    gesture = window.document.begin_gesture()
    for cell in np.linspace(0.1, 0.6, 20):
        window.document.set_parameters("Cell", gesture, cell_size=float(cell))


def start_drawing(window: MainWindow, folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    for step in range(10):
        window.trio.viewpoint.look(window.trio.viewpoint.camera.orbited(step, 0))
    window.scene_feed.ask()
    window.plot_feed._cut()


def start_exporting(window: MainWindow, folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    def endless_export(wanted: Any, progress: Any) -> Any:
        while True:
            progress(0.5, "writing")
            time.sleep(0.001)

    monkeypatch.setattr("stepfield_app.dialogs.export.export", endless_export)
    dialog = ExportDialog(window.document, window.settings, window.appearance.theme, window)
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
    process, folders = own.client.process_id, own.client._store.folders
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
    qtbot.waitUntil(lambda: window.client.process_id != 0)
    number, folders = window.client.process_id, window.client._store.folders
    discarded(window)
    assert not psutil.pid_exists(number)
    assert not any(folder.exists() for folder in folders)
