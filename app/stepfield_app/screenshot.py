"""A picture of the window once everything in it is drawn."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QWidget

from stepfield.errors import Cancelled, StepfieldError

#: Milliseconds between two looks, looks in a row at which nothing may be left to do, and looks at most.
LOOK, QUIET_LOOKS, MOST_LOOKS = 60, 4, 5000


class Screenshot(QObject):
    """Waits until a window has settled, saves a picture of it and closes it.

    Attributes
    ----------
    failure : StepfieldError or None
        Why there is no picture.
    """

    def __init__(self, window: QWidget, path: Path) -> None:
        super().__init__(window)
        self._window, self._path = window, path
        self.failure: StepfieldError | None = Cancelled("the window was closed before the picture was taken")
        self._looks = self._quiet = 0
        self._timer = QTimer(self, interval=LOOK)
        self._timer.timeout.connect(self._look)
        self._timer.start()

    def _look(self) -> None:
        self._looks += 1
        trouble = self._window.trouble  # type: ignore[attr-defined]
        if trouble is not None:
            self._leave(trouble)
            return
        self._quiet = self._quiet + 1 if self._window.is_settled() else 0  # type: ignore[attr-defined]
        if self._quiet >= QUIET_LOOKS:
            self._leave(self._saved())
        elif self._looks >= MOST_LOOKS:
            self._leave(StepfieldError("the picture was not drawn within five minutes; try a smaller scan"))

    def _saved(self) -> StepfieldError | None:
        if self._window.grab().save(str(self._path), "PNG"):
            return None
        return StepfieldError(f"{self._path}: the picture cannot be written; choose another place")

    def _leave(self, failure: StepfieldError | None) -> None:
        self._timer.stop()
        self.failure = failure
        self._window.close()
