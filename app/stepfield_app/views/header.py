"""The strip above a 3-D view: its name, what is drawn, what the colours mean, and a button to enlarge it."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtGui import QMouseEvent, QResizeEvent
from PySide6.QtWidgets import QComboBox, QWidget

from stepfield_app.controls import named, snug
from stepfield_app.views.strip import Strip, tool_button

#: A header is never narrower, and what stands in it beside its name and the colours; pixels.
LEAST_WIDTH, BESIDE = 160, 56


class ViewHeader(Strip):
    """Names a view and lets its colours be chosen; a double-click enlarges the view."""

    enlarge_asked = Signal()
    colour_chosen = Signal(str)

    def __init__(self, title: str, shortcut: str, parent: QWidget | None = None) -> None:
        super().__init__(title, parent)
        self.title.setToolTip(f"Double-click to enlarge ({shortcut})")
        self._colours = named(QComboBox(), f"Colours of the view {title}", "What the colours show")
        self._colours.activated.connect(lambda: self.colour_chosen.emit(self._colours.currentData()))
        self._colours.hide()
        enlarge = tool_button("full screen", f"Enlarge {title}", f"Enlarge or put back ({shortcut})")
        enlarge.clicked.connect(self.enlarge_asked)
        self.add(self._colours, enlarge)
        self.setMinimumWidth(LEAST_WIDTH)

    def set_colours(self, modes: Sequence[tuple[str, str]], chosen: str) -> None:
        """Offer the modes there are, as pairs of key and name."""
        self._colours.clear()
        for key, name in modes:
            self._colours.addItem(name, key)
        self._colours.setCurrentIndex(max(0, self._colours.findData(chosen)))
        snug(self._colours)
        self._offer()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Offer the colours only where there is room beside the name; there is in an enlarged view."""
        super().resizeEvent(event)
        self._offer()

    def _offer(self) -> None:
        needed = self.title.sizeHint().width() + self._colours.width() + BESIDE
        self._colours.setVisible(self._colours.count() > 1 and self.width() >= needed)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Enlarge the view, or put it back."""
        self.enlarge_asked.emit()
