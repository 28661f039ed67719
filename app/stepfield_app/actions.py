"""Every command of the window: one table of actions, from which menus, toolbar and sheet of keys are made."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu, QToolBar

from stepfield_app import toolbars
from stepfield_app.icons import icon

Keys = QKeySequence.StandardKey


class Actions:
    """Makes the actions of a window and puts them into its menus.

    An action is enabled while a scan is open unless it says otherwise.
    """

    def __init__(self, window: QMainWindow) -> None:
        self._window = window
        self._of_scan: list[QAction] = []
        self._by_name: dict[str, QAction] = {}

    def __getitem__(self, name: str) -> QAction:
        return self._by_name[name]

    def make(
        self,
        name: str,
        text: str,
        do: Callable[..., object],
        *,
        keys: Keys | str | Sequence[str] | None = None,
        glyph: str | None = None,
        tip: str = "",
        checkable: bool = False,
        needs_scan: bool = True,
    ) -> QAction:
        """Make one action.

        Parameters
        ----------
        name : str
            To find it by.
        text : str
            In the menu.
        do : callable
            Called when triggered; with the new state if ``checkable``.
        keys : optional
            A standard key or texts like ``Ctrl+1``.
        glyph : str, optional
            Icon, see :mod:`stepfield_app.icons`.
        tip : str
            Says more than the text does.
        """
        action = QAction(text, self._window)
        action.setObjectName(name)
        action.setCheckable(checkable)
        if glyph is not None:
            action.setIcon(icon(glyph))
        if isinstance(keys, Keys):
            action.setShortcuts(QKeySequence.keyBindings(keys)[:1])  # the others are on few keyboards
        elif keys is not None:
            texts = [keys] if isinstance(keys, str) else keys
            action.setShortcuts([QKeySequence(text) for text in texts])
        plain = text.replace("&", "").rstrip("…")
        action.setData(plain)
        shortcut = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
        action.setToolTip(f"{tip or plain} ({shortcut})" if shortcut else tip or plain)
        action.setStatusTip(tip)
        if checkable:
            action.toggled.connect(do)
        else:
            action.triggered.connect(lambda: do())
        if needs_scan:
            action.setEnabled(False)
            self._of_scan.append(action)
        self._by_name[name] = action
        return action

    def enable(self, has_scan: bool) -> None:
        """Enable what needs a scan, or not."""
        for action in self._of_scan:
            action.setEnabled(has_scan)

    def menu(self, title: str, names: Sequence[str | None]) -> QMenu:
        """Fill a menu of the bar with actions; None stands for a line between them."""
        menu = toolbars.menu(self._window, title)
        self.fill(menu, names)
        return menu

    def toolbar(self, title: str, names: Sequence[str | None]) -> QToolBar:
        """Fill a toolbar with actions; None stands for a line between them."""
        bar = toolbars.toolbar(self._window, title)
        self.fill(bar, names)
        return bar

    def fill(self, place: QMenu | QToolBar, names: Sequence[str | None]) -> None:
        """Put actions into a menu or a toolbar."""
        for name in names:
            if name is None:
                place.addSeparator()
            else:
                place.addAction(self._by_name[name])

    def exclusive(self, names: Sequence[str]) -> None:
        """Let one of these be chosen at a time."""
        group = QActionGroup(self._window)
        for name in names:
            group.addAction(self._by_name[name])
