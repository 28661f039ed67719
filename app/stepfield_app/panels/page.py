"""What panels are built of: a page that scrolls, headings, a fold, a mark for what is still being made."""

from __future__ import annotations

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import (
    QFrame,
    QLabel,
    QScrollArea,
    QStackedLayout,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from stepfield_app.controls import named
from stepfield_app.document import Document
from stepfield_app.icons import icon

#: The grid of the window, logical pixels.
GRID = 8
#: Milliseconds a state must last before the mark shows it: what flickers says nothing.
LASTING = 200


class Page(QWidget):
    """Content that scrolls, or a sentence about it while there is none."""

    def __init__(self, content: QWidget, sentence: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._empty = QLabel(sentence, wordWrap=True, alignment=Qt.AlignmentFlag.AlignCenter)
        self._empty.setProperty("role", "muted")
        self._empty.setContentsMargins(2 * GRID, 2 * GRID, 2 * GRID, 2 * GRID)
        self._scroll = QScrollArea(widgetResizable=True)
        self._scroll.setFrameShape(QFrame.Shape.NoFrame)
        self._scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._stack = QStackedLayout(self)
        self._stack.addWidget(self._empty)
        self._stack.addWidget(self._scroll)
        self._scroll.setWidget(content)  # last: all of it is styled anew whenever something takes it in
        self._scroll.viewport().setAutoFillBackground(False)
        content.setAutoFillBackground(False)

    def set_filled(self, is_filled: bool) -> None:
        """Show the content, or the sentence."""
        self._stack.setCurrentWidget(self._scroll if is_filled else self._empty)


def column(*, margin: int = GRID) -> QVBoxLayout:
    """Return a layout for things below each other on the grid."""
    layout = QVBoxLayout()
    layout.setContentsMargins(margin, margin, margin, margin)
    layout.setSpacing(GRID)
    return layout


def heading(text: str) -> QLabel:
    """Return the heading of a group of controls."""
    label = QLabel(text)
    label.setContentsMargins(0, GRID, 0, 0)
    label.setProperty("role", "heading")
    return label


def muted(text: str = "") -> QLabel:
    """Return a label for what only explains."""
    label = QLabel(text, wordWrap=True)
    label.setProperty("role", "muted")
    return label


class Fold(QWidget):
    """A title that folds and unfolds what is below it."""

    def __init__(self, title: str, content: QWidget, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._title = named(QToolButton(), title, f"Show or hide: {title}")
        self._title.setText(title)
        self._title.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self._content = content
        self._title.clicked.connect(lambda: self._unfold(self._content.isHidden()))
        layout = column(margin=0)
        layout.addWidget(self._title)
        layout.addWidget(content)
        self.setLayout(layout)
        self._unfold(False)

    def _unfold(self, is_open: bool) -> None:
        self._title.setIcon(icon("fold" if is_open else "unfold"))
        self._content.setVisible(is_open)


class PendingMark(QLabel):
    """Says that what is on screen is a preview, or not yet of the newest parameters."""

    def __init__(self, document: Document, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._document = document
        self.setProperty("role", "muted")
        self.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.setAccessibleName("State of the result")
        self._lasting = QTimer(self, singleShot=True, interval=LASTING)
        self._lasting.timeout.connect(self._show_state)
        document.pending_changed.connect(lambda pending: self._lasting.start())
        self._show_state()

    def _show_state(self) -> None:
        answer = self._document.answer
        state, explanation = "", "What is on screen belongs to these parameters"
        if answer is not None and self._document.pending:
            if answer.request.quick:
                state, explanation = "● preview", "Made from fewer points; the exact result follows"
            else:
                state, explanation = "● updating", "What is on screen still belongs to earlier parameters"
        self.setText(state)
        self.setToolTip(explanation)
