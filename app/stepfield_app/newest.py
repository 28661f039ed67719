"""One worker that always does the newest thing asked of it.

One request runs and one waits; a newer one takes the place of the one that waits, and the running one is let
finish: its answer is shown while a hand still moves, where starting anew would show nothing until it rests.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from threading import Event, Thread
from typing import Any, Generic, TypeVar

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from stepfield.errors import Cancelled, StepfieldError
from stepfield.progress import Progress
from stepfield_app.spare import give_back
from stepfield_app.urgency import give_way

Asked = TypeVar("Asked")
Answered = TypeVar("Answered")

#: Seconds between two reports of progress.
REPORT_EVERY = 0.1
#: Seconds without work after which freed memory goes back to the system.
QUIET = 1.0


@dataclass(eq=False)
class _Job:
    """A request on its way: flagged when nobody wants its answer any more."""

    request: Any
    cancelled: Event = field(default_factory=Event)


@dataclass(frozen=True)
class _Report:
    """What the worker tells the thread of the window."""

    job: _Job
    progress: tuple[float, str] | None = None
    answer: Any = None
    error: BaseException | None = None


class NewestWins(QObject, Generic[Asked, Answered]):
    """Runs a function on a thread of its own, for the newest request; signals come on the owner's thread.

    Parameters
    ----------
    function : callable
        Makes an answer of a request; calls its second argument between chunks of work.
    name : str
        Of the thread, and of this object among its parent's children.
    parent : QObject, optional
    pace : float
        Seconds from the start of a request to that of the next, at least: more answers than can be shown
        would keep who shows them from everything else.
    threaded : bool
        False runs every request within ``ask``: for tests of what stands around the worker.
    """

    answered = Signal(object, object)  # request, answer
    failed = Signal(object, object)  # request, exception
    progressed = Signal(float, str)
    busy_changed = Signal(bool)
    _reported = Signal(object)

    def __init__(
        self,
        function: Callable[[Asked, Progress], Answered],
        name: str,
        parent: QObject | None = None,
        *,
        pace: float = 0.0,
        threaded: bool = True,
    ) -> None:
        super().__init__(parent)
        self.setObjectName(name)
        self._pace, self._not_before = pace, 0.0
        self._function = function
        self._running: _Job | None = None
        self._waiting: _Job | None = None
        self._closed = self._said_busy = False
        self._jobs: SimpleQueue[_Job | Callable[[], None] | None] = SimpleQueue()
        self._thread = Thread(target=self._work, name=name, daemon=True) if threaded else None
        self._reported.connect(self._receive, Qt.ConnectionType.QueuedConnection)

    @property
    def busy(self) -> bool:
        """Whether anything runs, be it on its way to being cancelled, or waits for its turn."""
        return self._running is not None or self._waiting is not None

    @property
    def running(self) -> Asked | None:
        """The request whose answer is being made, None for one that was cancelled."""
        return None if self._running is None or self._running.cancelled.is_set() else self._running.request

    @property
    def waiting(self) -> Asked | None:
        """The request that waits for its turn."""
        return None if self._waiting is None else self._waiting.request

    def ask(self, request: Asked, *, at_once: bool = False) -> None:
        """Ask for an answer, at once or at the usual pace; a request that still waits is forgotten."""
        if self._closed:
            return
        self._waiting = _Job(request)
        if at_once:
            self._not_before = 0.0
        self._start_when_idle()

    def cancel(self) -> None:
        """Forget what waits and stop what runs at its next call of progress; nothing is said about either."""
        self._waiting, self._not_before = None, 0.0
        if self._running:
            self._running.cancelled.set()
        self._say_whether_busy()

    def forget(self) -> None:
        """Cancel, and let a function that remembers earlier work forget it, on its own thread."""
        self.cancel()
        forget: Callable[[], None] | None = getattr(self._function, "forget", None)
        if forget and self._thread:
            self._hand_over(forget)
        elif forget:
            forget()

    def close(self) -> None:
        """Cancel, and wait until the thread has ended. Nothing can be asked afterwards."""
        self._closed = True
        self.cancel()
        if self._thread and self._thread.ident is not None:
            self._jobs.put(None)
            self._thread.join()

    def _start_when_idle(self) -> None:
        if self._running is None and self._waiting is not None:
            self._start()
        self._say_whether_busy()

    def _start(self) -> None:
        """Hand the waiting job to the worker, unless the last one began a moment ago."""
        early = self._not_before - time.monotonic()
        if self._waiting is not None and early > 0:
            self._running = None
            QTimer.singleShot(round(1000 * early) + 1, self, self._start_when_idle)
            return
        job, self._waiting = self._waiting, None
        self._running = job
        self._not_before = time.monotonic() + self._pace if job else self._not_before
        if job and self._thread:
            self._hand_over(job)
        elif job:
            self._receive(self._done(job, lambda report: self._receive(report)))

    def _hand_over(self, work: _Job | Callable[[], None]) -> None:
        """Give the thread something to do; it starts with the first: a window that is made waits for none."""
        assert self._thread is not None
        if self._thread.ident is None:
            self._thread.start()
        self._jobs.put(work)

    def _receive(self, report: _Report) -> None:
        """Pass on what the worker reported, on the owner's thread."""
        if self._closed or report.job is not self._running:
            return
        if report.progress is None:
            self._start()
        if not report.job.cancelled.is_set():
            self._tell(report)
        self._say_whether_busy()

    def _say_whether_busy(self) -> None:
        if self.busy != self._said_busy:
            self._said_busy = self.busy
            self.busy_changed.emit(self.busy)

    def _tell(self, report: _Report) -> None:
        if report.progress:
            self.progressed.emit(*report.progress)
        elif report.error:
            self.failed.emit(report.job.request, report.error)
        else:
            self.answered.emit(report.job.request, report.answer)

    def _work(self) -> None:
        """Do one job after the other; the body of the thread."""
        give_way()
        while (job := self._next()) is not None:
            if not isinstance(job, _Job):
                job()
                continue
            report = self._done(job, self._reported.emit)
            job = None  # an idle worker must not keep a large answer alive
            self._reported.emit(report)
            del report

    def _next(self) -> _Job | Callable[[], None] | None:
        """Wait for something to do; what the last job needed on the way is a third of all memory."""
        try:
            return self._jobs.get(timeout=QUIET)
        except Empty:
            give_back()
            return self._jobs.get()

    def _done(self, job: _Job, report: Callable[[_Report], None]) -> _Report:
        """Do a job; whatever goes wrong becomes part of the report, so that nothing is lost."""
        try:
            return _Report(job, answer=self._function(job.request, _reporting(job, report)))
        except StepfieldError as error:
            # The sentence says it all; a traceback would keep the arrays of every frame alive.
            return _Report(job, error=error.with_traceback(None))
        except BaseException as error:  # noqa: BLE001 - reported with its traceback, on the other thread
            return _Report(job, error=error)


def _reporting(job: _Job, report: Callable[[_Report], None]) -> Progress:
    """Return the progress callback of a job: stops it when cancelled, speaks at most ten times a second."""
    last = -REPORT_EVERY

    def progress(share: float, what: str) -> None:
        nonlocal last
        if job.cancelled.is_set():
            raise Cancelled
        now = time.monotonic()
        if now - last >= REPORT_EVERY:
            last = now
            report(_Report(job, progress=(share, what)))

    return progress
