"""What every action and every control of the window needs."""

from __future__ import annotations

import re

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QAction
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QLabel,
    QMenu,
    QPlainTextEdit,
    QScrollBar,
    QTabBar,
    QWidget,
)
from pytestqt.qtbot import QtBot

from stepfield_app.commands import help as help_menu
from stepfield_app.dialogs.shortcuts import ShortcutSheet, shortcuts_of
from stepfield_app.main_window import MainWindow


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
