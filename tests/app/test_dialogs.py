"""The sheet of keys and the about box say what is so, because nobody writes them by hand."""

from __future__ import annotations

from importlib.metadata import version

import pytest
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QLabel, QLineEdit, QMainWindow, QMenu, QTableWidget
from pytestqt.qtbot import QtBot

import stepfield
from stepfield_app.dialogs.about import AboutDialog, libraries
from stepfield_app.dialogs.shortcuts import ShortcutSheet, shortcuts_of

#: Qt's platform for tests without a screen says so at every window.
pytestmark = pytest.mark.qt_log_ignore("This plugin does not support", extend=True)


@pytest.fixture
def window(qtbot: QtBot) -> QMainWindow:
    """Return a window with menus, a submenu, and an action that is in none."""
    made = QMainWindow()
    qtbot.addWidget(made)
    file = made.menuBar().addMenu("&File")
    add(file, "&Open …", "Ctrl+O")
    add(file, "Close", "")
    add(file.addMenu("Recent"), "Clear && forget", "Ctrl+Shift+R")
    add(made.menuBar().addMenu("&Help"), "Keys", "F1")
    lone = QAction("Next view", made)
    lone.setShortcuts([QKeySequence("Tab"), QKeySequence("N")])
    return made


def add(menu: QMenu, text: str, keys: str) -> None:
    """Add an action."""
    menu.addAction(text).setShortcut(keys)


def test_every_key_is_on_the_sheet_once(window: QMainWindow) -> None:
    """If it failed, the sheet would hide keys, or promise what does not exist."""
    assert shortcuts_of(window) == {
        "File": [("Open", "Ctrl+O"), ("Clear & forget", "Ctrl+Shift+R")],
        "Help": [("Keys", "F1")],
        "Elsewhere": [("Next view", "Tab  or  N")],
    }


def test_the_sheet_can_be_searched(window: QMainWindow) -> None:
    """If it failed, one key among sixty would have to be looked for by eye."""
    sheet = ShortcutSheet(window, {"Mouse": [("Zoom", "wheel")]})
    sheet.show()
    field = sheet.findChild(QLineEdit)
    assert field is not None
    field.setText("WHEEL")
    assert {label.text() for label in sheet.findChildren(QLabel) if label.isVisible()} == {
        "MOUSE",
        "Zoom",
        "wheel",
    }
    field.clear()
    assert "Open" in {label.text() for label in sheet.findChildren(QLabel) if label.isVisible()}
    sheet.close()


def test_about_names_every_library_with_its_licence(qtbot: QtBot) -> None:
    """If it failed, the program would stand on others' work without saying so."""
    found = {name.lower().replace("_", "-"): (number, licence) for name, number, licence in libraries()}
    assert found["numpy"][0] == version("numpy")
    assert "LGPL" in found["pyside6-essentials"][1]
    assert not {"pytest", "ruff", "mypy"} & found.keys(), "only what an operator's install has"
    assert all(licence and "\n" not in licence for _, licence in found.values())
    dialog = AboutDialog()
    qtbot.addWidget(dialog)
    table = dialog.findChild(QTableWidget)
    assert table is not None
    assert table.rowCount() == len(found)
    assert any(stepfield.__version__ in label.text() for label in dialog.findChildren(QLabel))
