"""The moment by which pictures of a result go before figures and searches: all want the same processors."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QElapsedTimer, QObject, QTimer, Signal

#: Milliseconds that work waits for the views at most: a view that never comes to rest must not stop it.
PATIENCE = 4000
#: Milliseconds after which one looks again whether the views are drawn.
AGAIN = 40


class Courtesy(QObject):
    """Says when a moment has passed and the views are drawn.

    Parameters
    ----------
    moment : int
        Milliseconds that pass in any case.
    is_drawn : callable
        Whether the views show the newest result in full.
    parent : QObject
    """

    passed = Signal()

    def __init__(self, moment: int, is_drawn: Callable[[], bool], parent: QObject) -> None:
        super().__init__(parent)
        self._moment, self._is_drawn = moment, is_drawn
        self._since = QElapsedTimer()
        self._timer = QTimer(self, singleShot=True)
        self._timer.timeout.connect(self._look)

    @property
    def is_active(self) -> bool:
        """Whether the moment has yet to pass."""
        return self._timer.isActive()

    def start(self) -> None:
        """Begin, or begin anew."""
        self._since.start()
        self._timer.start(self._moment)

    def stop(self) -> None:
        """Say nothing."""
        self._timer.stop()

    def _look(self) -> None:
        if self._is_drawn() or self._since.hasExpired(self._moment + PATIENCE):
            self.passed.emit()
        else:
            self._timer.start(AGAIN)


def at_once() -> bool:
    """Stand for views that nobody has to wait for."""
    return True
