"""Garbage is collected on the thread of the window only: Qt's objects may not be destroyed on another."""

from __future__ import annotations

import gc

from PySide6.QtCore import QObject, QTimer

#: Milliseconds between two looks.
LOOK = 500


class GarbageCollector(QObject):
    """Takes the place of Python's automatic collection, which runs on whichever thread allocates last.

    What there is already, modules above all, is left out: looking through it would take longer than a blink.
    """

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        gc.disable()
        gc.freeze()
        self._timer = QTimer(self, interval=LOOK)
        self._timer.timeout.connect(self._look)
        self._timer.start()

    def pause(self) -> None:
        """Collect nothing for a while: what is being made is there to stay."""
        self._timer.stop()

    def go_on(self) -> None:
        """Leave out what there is by now, and go on."""
        gc.freeze()
        self._timer.start()

    def stop(self) -> None:
        """Give the work back to Python."""
        gc.unfreeze()
        gc.enable()

    def _look(self) -> None:
        """Collect each generation whose turn it is, by Python's own thresholds."""
        for generation in (2, 1, 0):
            threshold = gc.get_threshold()[generation]
            if threshold and gc.get_count()[generation] > threshold:
                gc.collect(generation)
                return
