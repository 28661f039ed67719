"""Makes the demo on a worker, then says where it is."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, Signal

from stepfield.progress import Progress
from stepfield_app.demo import PARAMETERS, make_demo
from stepfield_app.newest import NewestWins


def _make(_: None, progress: Progress) -> Path:
    return make_demo(progress=progress)


class DemoFeed(QObject):
    """The demo, made once and found again later."""

    made = Signal(object, object)  # files, parameters
    progressed = Signal(float, str)
    failed = Signal(object)  # exception

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._worker = NewestWins[None, Path](_make, "demo", self)
        self._worker.answered.connect(lambda _, path: self.made.emit((path,), PARAMETERS))
        self._worker.failed.connect(lambda _, error: self.failed.emit(error))
        self._worker.progressed.connect(self.progressed)

    @property
    def is_busy(self) -> bool:
        """Whether the demo is being made."""
        return self._worker.busy

    def start(self) -> None:
        """Make the demo unless it is there."""
        self._worker.ask(None)

    def cancel(self) -> None:
        """Stop making it."""
        self._worker.cancel()

    def close(self) -> None:
        """End the worker."""
        self._worker.close()
