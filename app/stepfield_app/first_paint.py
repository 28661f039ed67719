"""When the window stands on the screen: what takes long begins then, and not while it is painted."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, QTimer, Signal
from PySide6.QtWidgets import QWidget

#: Milliseconds after which a window that is shown, but where nobody sees it, counts as painted.
PATIENCE = 500


class FirstPaint(QObject):
    """Tells once that a window has been painted, with all that is in it.

    Parameters
    ----------
    window : QWidget
        Not shown yet.
    """

    happened = Signal()

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._window = window
        self.has_happened = False
        self._after = QTimer(self, singleShot=True)
        self._after.timeout.connect(self._tell)
        window.installEventFilter(self)

    def then(self, call: Callable[[], object]) -> None:
        """Call once it has happened."""
        if self.has_happened:
            call()
        else:
            self.happened.connect(call)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Wait for the first paint, but not for ever."""
        if event.type() == QEvent.Type.Paint:
            self._after.start(0)  # the event loop goes on when the picture is on the screen
        elif event.type() == QEvent.Type.Show and not self._after.isActive():
            self._after.start(PATIENCE)
        return False

    def _tell(self) -> None:
        if not self._window.isVisible():  # closed, or hidden for now: nothing may begin
            return
        self._window.removeEventFilter(self)
        if self._window.isVisible():  # else it has been closed since: nothing must begin any more
            self.has_happened = True
            self.happened.emit()
