"""When things happen in a window that works itself: ticks of its event loop, and what is painted."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtWidgets import QWidget

from stepfield_app.main_window import MainWindow

Wait = Callable[[], bool]
Report = dict[str, Any]
Task = Callable[[MainWindow, Report, "Clock"], Iterator[Wait]]

#: How often the event loop is asked to tick, seconds.
TICK = 0.005


class Clock(QObject):
    """Ticks every few milliseconds, notes when it really did, and takes the next step when it is time."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self.ticks: list[float] = []
        self.at_tick: list[Callable[[], None]] = []
        self._wait: Wait = lambda: True
        self._todo: Iterator[Wait] = iter(())
        self._timer = QTimer(self, interval=int(TICK * 1000), timerType=Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._tick)

    def start(self, todo: Iterator[Wait]) -> None:
        """Begin."""
        self._todo = todo
        self._timer.start()

    def _tick(self) -> None:
        self.ticks.append(time.perf_counter())
        waiting, self.at_tick = self.at_tick, []
        for call in waiting:
            call()
        try:
            while self._wait():
                self._wait = next(self._todo)
        except StopIteration:
            self._timer.stop()


class Watch(QObject):
    """Calls back when a widget is painted."""

    def __init__(self, widget: QWidget, call: Callable[[], None]) -> None:
        super().__init__(widget)
        self._widget, self._call = widget, call
        widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Look for paint events only."""
        if event.type() == QEvent.Type.Paint:
            self._call()
        return False

    def end(self) -> None:
        """Look no more."""
        self._widget.removeEventFilter(self)


def is_past(moment: float) -> bool:
    """Whether a moment of the performance counter has come."""
    return time.perf_counter() >= moment


def settled(window: MainWindow) -> bool:
    """Whether the scan is open and everything is drawn."""
    return window.is_ready and window.bench.document.answer is not None and window.is_settled()
