"""The window at work: trouble, themes, sizes, keys."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import numpy as np
from PySide6.QtCore import QSettings, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel
from pytestqt.qtbot import QtBot
from tests.app.window.whole import Folder, discarded, open_in, picture, sentences

from stepfield_app.appearance import Appearance
from stepfield_app.main_window import MainWindow
from stepfield_app.panels.fidelity import FILLED
from stepfield_app.panels.rows import LABEL_WIDTH
from stepfield_app.render.scene import CLOUD, PILLARS, VIEWS
from stepfield_app.settings import Settings
from stepfield_app.theme import DARK
from stepfield_app.views.view3d import SENTENCES

# --- Trouble ------------------------------------------------------------------------------------------------


def test_a_dead_drawing_process_comes_back_and_nothing_else_notices(opened: MainWindow, qtbot: QtBot) -> None:
    opened.bench.document.set_parameters("Alpha", alpha=0.7)
    qtbot.waitUntil(opened.is_settled)
    canvas, camera = opened.bench.trio.canvases[CLOUD], opened.bench.trio.viewpoint.camera
    before = opened.bench.client.frame(CLOUD)
    project, answer, steps = (
        opened.bench.document.project,
        opened.bench.document.answer,
        opened.bench.document.undo_stack.count(),
    )
    troubles: list[str] = []
    opened.bench.client.state_changed.connect(lambda state: troubles.append(canvas._trouble))
    os.kill(opened.bench.client.process_id, signal.SIGKILL)
    qtbot.waitUntil(lambda: SENTENCES["stopped"] in troubles)
    qtbot.waitUntil(opened.is_settled)
    after = opened.bench.client.frame(CLOUD)
    assert before is not None
    assert after is not None
    assert after is not before
    assert after.camera == before.camera == camera
    assert np.array_equal(after.pixels, before.pixels)
    assert not canvas._trouble
    assert (opened.bench.document.project, opened.bench.document.answer) == (project, answer)
    assert opened.bench.document.undo_stack.count() == steps
    assert not sentences(opened)


def test_an_unexpected_failure_is_told_with_details(opened: MainWindow) -> None:
    opened.tell(ZeroDivisionError("of a worker"))
    (message,) = opened.message_bar.messages
    assert "ZeroDivisionError: of a worker" in message.details
    assert "ZeroDivisionError" not in message.sentence
    assert opened.bench.document.answer is not None


def test_sixty_sizes_end_settled(opened: MainWindow, qtbot: QtBot) -> None:
    """If it failed, a dragged edge would leave views stretched, or the drawing process behind."""
    rng = np.random.default_rng(1)
    number = opened.bench.client.process_id
    for width, height in zip(rng.integers(900, 1600, 60), rng.integers(600, 1000, 60), strict=True):
        opened.resize(int(width), int(height))
        QApplication.processEvents()
    opened.resize(1111, 777)
    qtbot.waitUntil(opened.is_settled)
    for view in VIEWS:
        frame = opened.bench.client.frame(view)
        assert frame is not None
        assert frame.pixels.shape[:2] == opened.bench.trio.canvases[view].pixels[::-1]
    assert opened.bench.client.process_id == number, "the drawing process has died on the way"


# --- Working ------------------------------------------------------------------------------------------------


def test_steps_are_named_in_the_menu(opened: MainWindow, qtbot: QtBot) -> None:
    undo, redo = opened.commands["undo"], opened.commands["redo"]
    assert (undo.text(), undo.isEnabled()) == ("&Undo", False)
    opened.bench.document.set_style("Rename to A & B", 0, name="A & B")
    assert (undo.text(), undo.isEnabled()) == ("&Undo Rename to A && B", True)
    undo.trigger()
    assert (redo.text(), redo.isEnabled(), undo.isEnabled()) == ("&Redo Rename to A && B", True, False)
    redo.trigger()
    assert opened.bench.document.style(0).name == "A & B"
    qtbot.waitUntil(opened.is_settled)


def test_the_theme_changes_everywhere_at_once(opened: MainWindow, qtbot: QtBot) -> None:
    dark = picture(opened)
    opened.commands["theme light"].setChecked(True)
    assert opened.settings.theme == "light"
    qtbot.waitUntil(opened.is_settled)
    light = picture(opened)
    grounds = {getattr(DARK, name) for name in ("window", "panel", "field")}
    colours = {tuple(int(ground[at : at + 2], 16) for at in (1, 3, 5)) for ground in grounds}
    left = sum(int((light == colour).all(axis=2).sum()) for colour in colours)
    assert left < 0.002 * light[..., 0].size, "something still wears the dark theme"
    for name, part in (
        *((view, opened.bench.trio.canvases[view]) for view in VIEWS),
        ("map", opened.bench.map),
    ):
        corner = picture(part)[-4, 4] if name != "map" else picture(part)[3, 3]
        assert corner.min() > 150, f"{name} is still dark"
    opened.commands["theme dark"].setChecked(True)
    qtbot.waitUntil(opened.is_settled)
    assert (picture(opened) == dark).all(axis=2).mean() > 0.98, "back in dark something stayed light"


def test_a_theme_of_the_command_line_is_not_remembered(
    qtbot: QtBot, qapp: QApplication, tmp_path: Path
) -> None:
    """If it failed, one picture in light would turn the operator's window light for good."""
    settings = Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))
    appearance = Appearance(qapp, "light")
    window = MainWindow(appearance, settings, size=(800, 600), remembers=False)
    assert window.commands["theme light"].isChecked()
    assert settings.theme == "system"
    discarded(window)
    appearance.choose("dark")


def test_escape_leaves_the_tool(opened: MainWindow) -> None:
    crop = opened.commands["crop"]
    crop.trigger()
    assert opened.bench.cleaning.crop.tool.isChecked()
    assert opened.bench.trio.canvases[CLOUD].grip.tool is opened.bench.crop_tool
    QTest.keyClick(opened, Qt.Key.Key_Escape)
    assert not crop.isChecked()
    assert opened.bench.trio.canvases[CLOUD].grip.tool is None
    opened.commands["profile line"].trigger()
    assert opened.bench.map.plot.is_drawing
    QTest.keyClick(opened, Qt.Key.Key_Escape)
    assert not opened.bench.map.plot.is_drawing


def test_views_are_reached_by_keys(opened: MainWindow) -> None:
    camera = opened.bench.trio.viewpoint.camera
    for key, views in ((Qt.Key.Key_2, (PILLARS,)), (Qt.Key.Key_0, VIEWS)):
        QTest.keyClick(opened, key, Qt.KeyboardModifier.ControlModifier)
        assert opened.bench.trio.shown == views
    opened.bench.trio.viewpoint.look(camera.zoomed(5))
    QTest.keyClick(opened, Qt.Key.Key_F)
    assert opened.bench.trio.viewpoint.camera.distance > camera.distance / 2


def test_f_in_a_plot_fits_the_plot(opened: MainWindow) -> None:
    """The tip of the plot promises it; the window's own F must not take it away."""
    camera = opened.bench.trio.viewpoint.camera.zoomed(5)
    opened.bench.trio.viewpoint.look(camera)
    opened.bench.map.plot.setFocus()
    opened.bench.map.plot.pane.step(1, 0)
    assert opened.bench.map.plot.is_touched
    QTest.keyClick(opened.bench.map.plot, Qt.Key.Key_F)
    assert not opened.bench.map.plot.is_touched
    assert opened.bench.trio.viewpoint.camera == camera


def test_a_small_window_shows_every_figure_and_four_layers(
    qtbot: QtBot, appearance: Appearance, folder: Folder, tmp_path: Path
) -> None:
    """If it failed, the last figures would have to be scrolled to, or layers; or what was filled be cut."""
    settings = Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))
    window = MainWindow(appearance, settings, size=(1280, 720))
    window.show()
    open_in(window, qtbot, folder.table)
    figures, rows = window.bench.fidelity.values, window.bench.layers.view
    for name, value in figures.items():
        if name not in FILLED:
            assert value.visibleRegion().boundingRect() == value.rect(), f"{name} is cut"
    assert rows.viewport().height() >= 4 * rows.sizeHintForRow(0)
    window.bench.document.set_parameters("Fill holes", fill="linear")
    qtbot.waitUntil(window.is_settled)
    for name, value in figures.items():
        assert value.sizeHint().width() <= value.width(), f"{name} is too wide"
    for label in window.bench.parameters.findChildren(QLabel):
        if label.buddy() is not None:  # a name, and the room that is left to it beside the boxes
            assert label.sizeHint().width() <= LABEL_WIDTH, f"{label.text()} is cut"
    discarded(window)
