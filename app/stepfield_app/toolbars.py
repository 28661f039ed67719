"""What stands in the toolbars and in the bar of menus, and a sketch of both before there are any actions."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow, QMenu, QToolBar

from stepfield_app.icons import ICON_SIZE, icon

MENUS = ("&File", "&Edit", "&View", "&Layers", "&Tools", "&Help")

#: Names of the selecting tools; the first is in use at first.
TOOLS = ("navigate", "click", "rectangle", "lasso", "brush", "surface")
#: Names of the actions of each toolbar; None stands for a line between them.
TOOLBARS: dict[str, tuple[str | None, ...]] = {
    "Main": ("open", "save", "export", None, "undo", "redo", None),
    "Tools": (*TOOLS, None, "crop", "profile line", None),
    "View": ("iso", "top", "front", "side", "fit", "parallel"),
}
#: Icons of actions, where they are not called like the action.
_GLYPHS = {"profile line": "profile"}


def sketch(window: QMainWindow, open_wanted: Callable[[], object]) -> None:
    """Make menus and toolbars that look as they will; of all actions only that which opens a scan acts."""
    for title in MENUS:
        menu(window, title)
    for title, names in TOOLBARS.items():
        bar = toolbar(window, title)
        for name in names:
            bar.addAction(_sketched(bar, name)) if name else bar.addSeparator()
    opening = window.findChildren(QAction, "sketch of open")[0]
    opening.setEnabled(True)
    opening.triggered.connect(open_wanted)


def menu(window: QMainWindow, title: str) -> QMenu:
    """Find a menu in the bar, or add it."""
    bar = window.menuBar()
    found = next((menu for menu in bar.findChildren(QMenu) if menu.title() == title), None)
    return found or bar.addMenu(title)


def toolbar(window: QMainWindow, title: str) -> QToolBar:
    """Find a toolbar, emptied, or add it."""
    found = window.findChildren(QToolBar, f"toolbar {title}")
    if found:
        _empty(found[0])
        return found[0]
    bar = QToolBar(title, window)
    bar.setObjectName(f"toolbar {title}")
    bar.setMovable(False)
    bar.setIconSize(bar.iconSize().scaled(ICON_SIZE, ICON_SIZE, Qt.AspectRatioMode.IgnoreAspectRatio))
    window.addToolBar(bar)
    return bar


def _empty(bar: QToolBar) -> None:
    for action in bar.actions():
        bar.removeAction(action)
        if action.parent() is bar:
            action.deleteLater()


def _sketched(bar: QToolBar, name: str) -> QAction:
    action = QAction(icon(_GLYPHS.get(name, name)), name, bar)
    action.setObjectName(f"sketch of {name}")
    action.setEnabled(False)
    action.setCheckable(name in TOOLS)
    action.setChecked(name == TOOLS[0])
    return action
