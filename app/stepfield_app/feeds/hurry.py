"""Whether what is shown will be replaced in a moment: then views show what they can without taking long."""

from __future__ import annotations

from PySide6.QtCore import QObject, QTimer, Signal

from stepfield_app.document import Document

#: Milliseconds that an exact result may take after the hand has stopped before its preview is drawn in full.
PATIENCE = 1500


class Hurry(QObject):
    """True while a hand holds a control, and for a while after it while only a preview is there.

    What is drawn of a preview in full would take the processors from the exact result.
    """

    changed = Signal(bool)

    def __init__(self, document: Document, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._hurries = document, False
        self._patience = QTimer(self, singleShot=True, interval=PATIENCE)
        self._patience.timeout.connect(self._look)
        document.held_changed.connect(self._hold)
        document.answer_changed.connect(lambda _: self._look())

    def __bool__(self) -> bool:
        return self._hurries

    def _hold(self, is_held: bool) -> None:
        if is_held:
            self._patience.stop()
        else:
            self._patience.start()
        self._look()

    def _look(self) -> None:
        answer = self._document.answer
        is_preview = answer is not None and answer.request.quick
        hurries = self._document.held or (is_preview and self._patience.isActive())
        if hurries != self._hurries:
            self._hurries = hurries
            self.changed.emit(hurries)
