"""The history: every step by name; a click goes back or forward to it."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QUndoView, QVBoxLayout, QWidget

from stepfield_app.document import Document
from stepfield_app.requests import Answer

#: The first row: of a scan that is open, and of none.
BEGINNING, NOTHING = "As opened", "Nothing is open"


class HistoryPanel(QWidget):
    """Lists the undo steps of a document.

    Parameters
    ----------
    document : Document
    parent : QWidget, optional
    """

    def __init__(self, document: Document, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.view = QUndoView(document.undo_stack, self)
        self.view.setAccessibleName("History")
        self.view.setUniformItemSizes(True)  # or every step would measure all steps before it
        self.view.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.view.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.view.setToolTip("Steps taken so far: click one to go back or forward to it (Ctrl+Z, Ctrl+Y)")
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.view)
        document.answer_changed.connect(self._name_beginning)
        self._name_beginning(document.answer)

    def _name_beginning(self, answer: Answer | None) -> None:
        """Say where the steps begin; nowhere while nothing is open."""
        label = BEGINNING if answer is not None else NOTHING
        if self.view.emptyLabel() != label:  # or the list would be laid out with every answer
            self.view.setEmptyLabel(label)
