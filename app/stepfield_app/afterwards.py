"""What comes after the first paint: loaded on a thread, then made in pieces with the event loop between."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from threading import Thread

from PySide6.QtCore import QObject, Qt, QTimer, Signal


class Afterwards(QObject):
    """Loads and makes what the first picture of a window need not wait for.

    Parameters
    ----------
    load : callable
        Imports what ``make`` needs; called on a thread of its own, and again where it failed there.
    make : callable
        Makes a piece each time it is asked for the next one.
    parent : QObject
    """

    done = Signal()
    _loaded = Signal()

    def __init__(
        self, load: Callable[[], object], make: Callable[[], Iterator[None]], parent: QObject
    ) -> None:
        super().__init__(parent)
        self._load, self._make = load, make
        self._thread = Thread(target=self._load_apart, name="afterwards")
        self._pieces: Iterator[None] | None = None
        self._is_wanted = True
        self.is_done = False
        self._loaded.connect(self._go_on, Qt.ConnectionType.QueuedConnection)

    def begin(self) -> None:
        """Load, then make one piece after the other."""
        self._thread.start()

    def finish(self) -> None:
        """Make all that is missing, now."""
        self._wait()
        while not self.is_done:
            self._make_next()

    def stop(self) -> None:
        """Begin nothing any more, but leave nothing half made."""
        self._is_wanted = False
        self._wait()
        while self._pieces is not None and not self.is_done:
            self._make_next()

    def _wait(self) -> None:
        if self._thread.ident is not None:
            self._thread.join()

    def _load_apart(self) -> None:
        with contextlib.suppress(Exception):  # it fails again where somebody is told
            self._load()
        self._loaded.emit()

    def _go_on(self) -> None:
        if self._is_wanted and not self.is_done:
            self._make_next()
            QTimer.singleShot(0, self, self._go_on)

    def _make_next(self) -> None:
        if self._pieces is None:
            self._load()
            self._pieces = self._make()
        try:
            is_last = next(self._pieces, self) is self
        except Exception:
            self._pieces, self._is_wanted = None, False  # the rest would lack what is missing
            raise
        if is_last:
            self.is_done = True
            self.done.emit()
