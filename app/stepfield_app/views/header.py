"""The strip above a 3-D view: its name, what is drawn, what the colours mean, and a button to enlarge it."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QMouseEvent, QResizeEvent
from PySide6.QtWidgets import QComboBox, QWidget

from stepfield_app.controls import named, snug
from stepfield_app.views.strip import Strip, tool_button

#: A header is never narrower, and what stands in it beside its name and the colours; pixels.
LEAST_WIDTH, BESIDE = 160, 56
#: Pixels between what stands in it.
NARROW = 4


class ViewHeader(Strip):
    """Names a view and lets its colours be chosen; a double-click enlarges the view."""

    enlarge_asked = Signal()
    colour_chosen = Signal(str)
    way_chosen = Signal(str)

    def __init__(self, title: str, shortcut: str, parent: QWidget | None = None) -> None:
        super().__init__(title, parent)
        self.title.setToolTip(f"Double-click to enlarge ({shortcut})")
        self._colours = named(QComboBox(), f"Colours of the view {title}", "What the colours show")
        self._colours.activated.connect(lambda: self.colour_chosen.emit(self._colours.currentData()))
        self._colours.hide()
        self._ways = named(QComboBox(), f"Surface of the view {title}", "As what the layers are drawn")
        self._ways.activated.connect(lambda: self.way_chosen.emit(self._ways.currentData()))
        self._ways.hide()
        enlarge = tool_button("full screen", f"Enlarge {title}", f"Enlarge or put back ({shortcut})")
        enlarge.clicked.connect(self.enlarge_asked)
        self.add(self._colours, enlarge)
        self._row.insertWidget(self._row.indexOf(self._colours), self._ways)
        self._row.setSpacing(NARROW)  # three views stand side by side, and no name is to be cut
        self.setMinimumWidth(LEAST_WIDTH)

    def set_colours(self, modes: Sequence[tuple[str, str]], chosen: str) -> None:
        """Offer the modes there are, as pairs of key and name."""
        self._colours.clear()
        for key, name in modes:
            self._colours.addItem(name, key)
        self._colours.setCurrentIndex(max(0, self._colours.findData(chosen)))
        snug(self._colours)
        self._offer()

    def set_ways(self, ways: Sequence[tuple[str, str, str]], chosen: str) -> None:
        """Offer ways to draw what is seen, as key, name and explanation."""
        if self._ways.count() != len(ways):
            self._ways.clear()
            for at, (key, name, what) in enumerate(ways):
                self._ways.addItem(name, key)
                self._ways.setItemData(at, what, Qt.ItemDataRole.ToolTipRole)
            snug(self._ways)
        self._ways.setCurrentIndex(max(0, self._ways.findData(chosen)))
        self._offer()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Offer what there is room for beside the name: all of it in an enlarged view."""
        super().resizeEvent(event)
        self._offer()

    def _offer(self) -> None:
        room = self.width() - self.title.sizeHint().width() - BESIDE
        for box in (self._colours, self._ways):
            is_offered = box.count() > 1 and room >= box.width()
            box.setVisible(is_offered)
            room -= box.width() + NARROW if is_offered else 0

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Enlarge the view, or put it back."""
        self.enlarge_asked.emit()
