"""The list of edits: what was moved by hand, what became of it, and what no longer fits the scan."""

from __future__ import annotations

from PySide6.QtCore import QModelIndex, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QFrame,
    QHBoxLayout,
    QLabel,
    QListView,
    QStackedLayout,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from stepfield.project import Project
from stepfield_app.controls import named
from stepfield_app.document import Document
from stepfield_app.editor import Editor
from stepfield_app.icons import ICON_SIZE, icon
from stepfield_app.panels.moves_model import Misfits, MovesModel, model_row
from stepfield_app.panels.moves_row import ROW_HEIGHT, MoveDelegate
from stepfield_app.requests import Answer
from stepfield_app.theme import Theme
from stepfield_app.wording import counted, grouped

EMPTY = "Pillars that you move by hand are listed here. Select some and press the digit of a layer."
REMOVE = "Take this edit out from among the others (Del)"


class MovesPanel(QWidget):
    """Lists the edits of the project.

    Parameters
    ----------
    document : Document
    editor : Editor
    parent : QWidget, optional
    """

    #: Places of the edit that is looked at, shape (n, 6), metres, scan coordinates; None for none.
    places_shown = Signal(object)

    def __init__(self, document: Document, editor: Editor, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._document, self._editor = document, editor
        self.model = MovesModel(self)
        self._misfits = Misfits(self.model, self)
        self.view = MovesList()
        self.view.setModel(self._misfits)
        self._delegate = MoveDelegate(self.view)
        self.view.setItemDelegate(self._delegate)
        self.summary = QLabel()
        self.summary.setProperty("role", "muted")
        self.only = _button("warning", "Only edits that no longer fit", "List only edits that no longer fit")
        self.only.setCheckable(True)
        self.select = _button("target", "Select what stands there", "Select the pillars that stand there now")
        self.remove = _button("remove", "Remove the edit", REMOVE)
        self._arrange()
        self._connect()
        self._take_project(document.project)
        self._take_answer(document.answer)

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self._delegate.set_theme(theme)
        self.view.viewport().update()

    @property
    def current(self) -> int:
        """Number of the edit that is looked at, -1 for none."""
        return model_row(self._misfits, self.view.currentIndex())

    def remove_current(self) -> None:
        """Take the edit that is looked at out of the project, undoably."""
        if self.current >= 0:
            self._editor.take_out(self.current)

    def select_current(self) -> None:
        """Select the pillars that stand where those of the edit were."""
        if self.current >= 0:
            self._editor.select_places(self.model.moves[self.current])

    def _arrange(self) -> None:
        head = QHBoxLayout()
        head.setContentsMargins(8, 2, 4, 2)
        head.setSpacing(2)
        head.addWidget(self.summary, 1)
        for button in (self.only, self.select, self.remove):
            head.addWidget(button)
        content = QWidget()
        layout = QVBoxLayout(content)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addLayout(head)
        layout.addWidget(self.view, 1)
        empty = QLabel(EMPTY, wordWrap=True, alignment=Qt.AlignmentFlag.AlignCenter, margin=16)
        empty.setProperty("role", "muted")
        self._stack = QStackedLayout(self)
        self._stack.addWidget(empty)
        self._stack.addWidget(content)

    def _connect(self) -> None:
        self._document.project_changed.connect(self._take_project)
        self._document.answer_changed.connect(self._take_answer)
        self.view.selectionModel().currentChanged.connect(self._look_at)
        self.view.doubleClicked.connect(lambda _: self.select_current())
        self.view.enter_pressed.connect(self.select_current)
        self.view.delete_pressed.connect(self.remove_current)
        self.only.toggled.connect(self._misfits.set_only)
        self.select.clicked.connect(self.select_current)
        self.remove.clicked.connect(self.remove_current)

    def _take_project(self, project: Project) -> None:
        if project.moves is not self.model.moves:
            self.model.set_moves(project.moves)
            self._say()

    def _take_answer(self, answer: Answer | None) -> None:
        if answer is not None:
            self.model.set_outcomes(answer.request.moves, answer.result.outcomes)
        self._say()

    def _say(self) -> None:
        """Count the edits, and offer what can be done."""
        count, misfits = self.model.rowCount(), self.model.misfits
        self._stack.setCurrentIndex(1 if count else 0)
        self.summary.setText(
            counted(count, "edit") + (f", {grouped(misfits)} no longer fit" if misfits else "")
        )
        self.only.setEnabled(bool(misfits) or self.only.isChecked())
        if not misfits and self.only.isChecked():
            self.only.setChecked(False)
        self._offer()

    def _offer(self) -> None:
        at = self.current
        self.select.setEnabled(at >= 0 and len(self.model.moves[at].pillars) > 0)
        self.remove.setEnabled(at >= 0)

    def _look_at(self, current: QModelIndex) -> None:
        at = model_row(self._misfits, current)
        self._offer()
        self.places_shown.emit(self.model.moves[at].boxes() if at >= 0 else None)


class MovesList(QListView):
    """The list itself; Enter and Del act on the edit under the keyboard."""

    enter_pressed = Signal()
    delete_pressed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName("Edits, the oldest first")
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setUniformItemSizes(True)
        self.setMouseTracking(True)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)

    def sizeHint(self) -> QSize:  # noqa: N802
        """Return a size that shows four edits."""
        return QSize(300, 4 * ROW_HEIGHT)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Take Enter and Del; the rest moves through the rows."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.enter_pressed.emit()
        elif event.key() == Qt.Key.Key_Delete:
            self.delete_pressed.emit()
        else:
            super().keyPressEvent(event)


def _button(meaning: str, name: str, tip: str) -> QToolButton:
    button = named(QToolButton(), name, tip)
    button.setIcon(icon(meaning))
    button.setIconSize(QSize(ICON_SIZE, ICON_SIZE))
    button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return button
