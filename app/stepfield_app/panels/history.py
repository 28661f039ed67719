"""The history: every step by name; a click goes back or forward to it."""

from __future__ import annotations

from PySide6.QtGui import QUndoStack
from PySide6.QtWidgets import QUndoView, QVBoxLayout, QWidget


class HistoryPanel(QWidget):
    """Lists the undo steps of a document.

    Parameters
    ----------
    undo_stack : QUndoStack
    parent : QWidget, optional
    """

    def __init__(self, undo_stack: QUndoStack, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.view = QUndoView(undo_stack, self)
        self.view.setEmptyLabel("As opened")
        self.view.setAccessibleName("History")
        self.view.setUniformItemSizes(True)  # or every step would measure all steps before it
        self.view.setToolTip("Steps taken so far: click one to go back or forward to it (Ctrl+Z, Ctrl+Y)")
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.view)
