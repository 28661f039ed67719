"""When to mention that a newer result is under way."""

from __future__ import annotations

from PySide6.QtCore import QObject, QTimer, Signal

#: Milliseconds that pass before it is mentioned: most results arrive sooner.
PATIENCE = 250
#: What a view says then.
UPDATING = "updating…"


class Lateness(QObject):
    """Whether what a view shows has been out of date for so long that the view should say so."""

    changed = Signal()

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._is_late = False
        self._patience = QTimer(self, singleShot=True, interval=PATIENCE)
        self._patience.timeout.connect(lambda: self._be(True))

    def __bool__(self) -> bool:
        return self._is_late

    def set_pending(self, is_pending: bool) -> None:
        """Note whether a newer result is under way."""
        if not is_pending:
            self._patience.stop()
            self._be(False)
        elif not self._is_late and not self._patience.isActive():
            self._patience.start()

    def _be(self, is_late: bool) -> None:
        if is_late != self._is_late:
            self._is_late = is_late
            self.changed.emit()
