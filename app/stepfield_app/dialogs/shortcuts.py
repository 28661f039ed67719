"""The sheet of keys: every action of the window that has one, by menu; written by the window itself."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import (
    QDialog,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMainWindow,
    QMenu,
    QPushButton,
    QScrollArea,
    QStyle,
    QVBoxLayout,
    QWidget,
)

#: Name of an action, and its keys.
Entry = tuple[str, str]
_COLUMNS = 3
#: Height of the sheet, and its margins; its width is what the columns need.
HEIGHT, MARGIN = 640, 16


def shortcuts_of(window: QMainWindow) -> dict[str, list[Entry]]:
    """Return the actions that have keys, by the menu they are in; *Elsewhere* holds those in no menu."""
    found = {_plain(menu.title()): list(_entries(menu.actions())) for menu in _menus(window)}
    listed = {entry for entries in found.values() for entry in entries}
    found["Elsewhere"] = sorted(set(_entries(window.findChildren(QAction))) - listed)
    return {title: entries for title, entries in found.items() if entries}


class ShortcutSheet(QDialog):
    """Keys by menu, in columns, with a field to find one."""

    def __init__(self, window: QMainWindow, gestures: dict[str, list[Entry]] | None = None) -> None:
        """Make the sheet of a window; ``gestures`` are ways of the mouse, by group, which no action knows."""
        super().__init__(window)
        self.setWindowTitle("Keys")
        self._lines: list[tuple[str, QWidget, QWidget]] = []
        self._groups: list[tuple[QWidget, list[str]]] = []
        self._search = QLineEdit()
        self._search.setPlaceholderText("Find an action or a key")
        self._search.setAccessibleName("Find")
        self._search.setToolTip("Show only what holds this text")
        self._search.setClearButtonEnabled(True)
        self._search.textChanged.connect(self._filter)
        sheet = self._fill(shortcuts_of(window) | (gestures or {}))
        beside = 2 * MARGIN + self.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        self.resize(sheet.sizeHint().width() + beside, HEIGHT)

    def _fill(self, groups: dict[str, list[Entry]]) -> QWidget:
        columns = [QVBoxLayout() for _ in range(_COLUMNS)]
        for column, group in zip(_spread(groups), columns, strict=True):
            for title in column:
                group.addWidget(self._group(title, groups[title]))
            group.addStretch()
        sheet = QWidget()
        across = QHBoxLayout(sheet)
        across.setSpacing(24)
        for layout in columns:
            layout.setSpacing(16)
            across.addLayout(layout, 1)
        area = QScrollArea()
        area.setWidget(sheet)
        area.setWidgetResizable(True)
        outer = QVBoxLayout(self)
        outer.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        outer.setSpacing(8)
        outer.addWidget(self._search)
        outer.addWidget(area, 1)
        outer.addLayout(_bottom(self))
        return sheet

    def _group(self, title: str, entries: list[Entry]) -> QWidget:
        group = QWidget()
        layout = QGridLayout(group)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setHorizontalSpacing(16)
        layout.setVerticalSpacing(4)
        heading = QLabel(title.upper())
        heading.setProperty("role", "heading")
        layout.addWidget(heading, 0, 0, 1, 2)
        for row, (name, keys) in enumerate(entries, start=1):
            what, key = QLabel(name), QLabel(keys)
            key.setProperty("role", "key")
            layout.addWidget(what, row, 0)
            layout.addWidget(key, row, 1, Qt.AlignmentFlag.AlignRight)
            self._lines.append((f"{title} {name} {keys}".casefold(), what, key))
        layout.setColumnStretch(0, 1)
        self._groups.append((group, [f"{title} {name} {keys}".casefold() for name, keys in entries]))
        return group

    def _filter(self, text: str) -> None:
        wanted = text.casefold().strip()
        for line, what, key in self._lines:
            what.setVisible(wanted in line)
            key.setVisible(wanted in line)
        for group, lines in self._groups:
            group.setVisible(any(wanted in line for line in lines))


def _menus(window: QMainWindow) -> Iterator[QMenu]:
    for action in window.menuBar().actions():
        menu = action.menu()
        if isinstance(menu, QMenu):
            yield menu


def _all(actions: list[QAction]) -> Iterator[QAction]:
    """Every action, those of submenus in their place."""
    for action in actions:
        yield action
        menu = action.menu()
        if isinstance(menu, QMenu):
            yield from _all(menu.actions())


def _entries(actions: list[QAction]) -> Iterator[Entry]:
    for action in _all(actions):
        keys = [keys.toString(QKeySequence.SequenceFormat.NativeText) for keys in action.shortcuts()]
        name = action.data() or action.text()  # the text of Undo names a step, its data never does
        if name and (shown := [key for key in keys if key]):
            yield _plain(name), "  or  ".join(shown)


def _plain(text: str) -> str:
    """Return the text of an action without its mnemonic and its dots."""
    return text.replace("&&", "\0").replace("&", "").replace("\0", "&").rstrip(" .\N{HORIZONTAL ELLIPSIS}")


def _spread(groups: dict[str, list[Entry]]) -> list[list[str]]:
    """Spread the groups over columns of about one height, the longest first."""
    columns: list[list[str]] = [[] for _ in range(_COLUMNS)]
    heights = [0] * _COLUMNS
    for title in sorted(groups, key=lambda title: -len(groups[title])):
        place = heights.index(min(heights))
        columns[place].append(title)
        heights[place] += len(groups[title]) + 2
    return columns


def _bottom(dialog: QDialog) -> QHBoxLayout:
    close = QPushButton("Close")
    close.setToolTip("Close this sheet (Esc)")
    close.clicked.connect(dialog.reject)
    layout = QHBoxLayout()
    layout.addStretch()
    layout.addWidget(close)
    return layout
