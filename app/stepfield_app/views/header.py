"""The strip above a 3-D view: its name, what is drawn, what the colours mean, and a button to enlarge it."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QSizePolicy, QToolButton, QWidget

from stepfield_app.icons import icon

HEIGHT = 28


class ViewHeader(QWidget):
    """Names a view and lets its colours be chosen; a double-click enlarges the view."""

    enlarge_asked = Signal()
    colour_chosen = Signal(str)

    def __init__(self, title: str, shortcut: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFixedHeight(HEIGHT)
        self._title = QLabel(f"<b>{title}</b>")
        self._title.setToolTip(f"Double-click to enlarge ({shortcut})")
        self._detail = QLabel()
        self._detail.setProperty("role", "muted")
        self._detail.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._colours = QComboBox()
        self._colours.setAccessibleName(f"Colours of the view {title}")
        self._colours.setToolTip("What the colours show")
        self._colours.activated.connect(lambda: self.colour_chosen.emit(self._colours.currentData()))
        self._enlarge = QToolButton()
        self._enlarge.setAutoRaise(True)
        self._enlarge.setAccessibleName(f"Enlarge {title}")
        self._enlarge.setToolTip(f"Enlarge or put back ({shortcut})")
        self._enlarge.clicked.connect(self.enlarge_asked)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(8, 0, 4, 0)
        layout.setSpacing(8)
        layout.addWidget(self._title)
        layout.addWidget(self._detail, 1)
        layout.addWidget(self._colours)
        layout.addWidget(self._enlarge)
        self._enlarge.setIcon(icon("full screen"))

    def set_detail(self, text: str) -> None:
        """Say what is drawn; the tip says it where there is no room."""
        self._detail.setText(text)
        self._detail.setToolTip(text)

    def set_colours(self, modes: Sequence[tuple[str, str]], chosen: str) -> None:
        """Offer the modes there are, as pairs of key and name."""
        self._colours.clear()
        for key, name in modes:
            self._colours.addItem(name, key)
        self._colours.setCurrentIndex(max(0, self._colours.findData(chosen)))
        self._colours.setVisible(len(modes) > 1)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Enlarge the view, or put it back."""
        self.enlarge_asked.emit()
