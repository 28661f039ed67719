"""The worker: the newest request is answered, on the window's thread, and nothing that goes wrong is lost."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from pytestqt.qtbot import QtBot

from stepfield.errors import Cancelled, ScanError
from stepfield.progress import Progress
from stepfield_app.newest import NewestWins


class Gate:
    """A job that goes on only when the test says so."""

    def __init__(self) -> None:
        self.started: list[int] = []
        self.stopped: list[int] = []
        self.open = threading.Event()

    def __call__(self, request: int, progress: Progress) -> int:
        self.started.append(request)
        while not self.open.wait(0.001):
            try:
                progress(0.5, "waiting")
            except Cancelled:
                self.stopped.append(request)
                raise
        return 10 * request


@pytest.fixture
def make(qtbot: QtBot) -> Iterator[Callable[[Any], NewestWins[Any, Any]]]:
    made: list[NewestWins[Any, Any]] = []

    def worker(function: Any, **options: Any) -> NewestWins[Any, Any]:
        made.append(NewestWins(function, "worker", **options))
        return made[-1]

    yield worker
    for each in made:
        each.close()


def test_the_running_one_finishes_and_of_those_that_wait_the_newest_wins(qtbot: QtBot, make: Any) -> None:
    gate, answers = Gate(), []
    worker = make(gate)
    worker.answered.connect(lambda request, answer: answers.append((request, answer)))
    for request in range(8):
        worker.ask(request)
    qtbot.waitUntil(lambda: gate.started == [0])
    gate.open.set()
    qtbot.waitUntil(lambda: len(answers) == 2)
    assert answers == [(0, 0), (7, 70)]


def test_what_is_wanted_at_once_does_not_wait_for_the_pace(qtbot: QtBot, make: Any) -> None:
    """The exact result of a slider would come later than it could once the hand rests."""
    gate = Gate()
    gate.open.set()
    worker = make(gate, pace=1000.0)
    with qtbot.waitSignal(worker.answered):
        worker.ask(1)
    worker.ask(2)
    assert worker.busy
    assert worker.running is None
    with qtbot.waitSignal(worker.answered):
        worker.ask(3, at_once=True)
    assert gate.started == [1, 3]


def test_signals_come_on_the_thread_of_the_window(qtbot: QtBot, make: Any) -> None:
    threads: list[threading.Thread] = []

    def work(request: int, progress: Progress) -> int:
        threads.append(threading.current_thread())
        progress(0.5, "working")
        return request

    worker = make(work)
    for signal in (worker.answered, worker.progressed):
        signal.connect(lambda *_: threads.append(threading.current_thread()))
    with qtbot.waitSignal(worker.answered):
        worker.ask(1)
    assert threads[0] is not threading.main_thread()
    assert threads[1:] == [threading.main_thread()] * 2


def test_a_cancelled_request_stops_and_says_nothing_and_the_next_one_runs(qtbot: QtBot, make: Any) -> None:
    gate, said = Gate(), []
    worker = make(gate)
    worker.answered.connect(lambda request, answer: said.append(request))
    worker.failed.connect(lambda request, error: said.append(error))
    worker.ask(1)
    worker.ask(2)
    qtbot.waitUntil(lambda: gate.started == [1])
    worker.cancel()
    qtbot.waitUntil(lambda: not worker.busy)
    assert (gate.stopped, said) == ([1], [])
    gate.open.set()
    worker.ask(3)
    qtbot.waitUntil(lambda: said == [3])
    assert gate.started == [1, 3]


@pytest.mark.parametrize("error", [ScanError("no scan"), ValueError("a mistake of ours"), MemoryError()])
def test_whatever_goes_wrong_is_reported_and_the_next_request_is_answered(
    qtbot: QtBot, make: Any, error: Exception
) -> None:
    def work(request: int, progress: Progress) -> int:
        if request == 1:
            raise error
        return request

    worker = make(work)
    with qtbot.waitSignal(worker.failed) as failed:
        worker.ask(1)
    assert failed.args == [1, error]
    is_expected = isinstance(error, ScanError)
    assert (error.__traceback__ is None) == is_expected, "mistakes keep their traceback for the report"
    with qtbot.waitSignal(worker.answered):
        worker.ask(2)


def test_progress_is_told_now_and_then_not_at_every_chunk(qtbot: QtBot, make: Any) -> None:
    def work(request: int, progress: Progress) -> int:
        for chunk in range(20_000):
            progress(chunk / 20_000, "counting")
        return request

    told: list[float] = []
    worker = make(work)
    worker.progressed.connect(lambda share, what: told.append(share))
    with qtbot.waitSignal(worker.answered):
        worker.ask(1)
    assert told
    assert told[0] == 0.0
    assert len(told) < 100


def test_busy_is_said_once_at_each_change(qtbot: QtBot, make: Any) -> None:
    said: list[bool] = []
    worker = make(lambda request, progress: request)
    worker.busy_changed.connect(said.append)
    worker.ask(1)
    worker.ask(2)
    qtbot.waitUntil(lambda: said == [True, False])
    assert not worker.busy


def test_closing_stops_the_work_and_ends_the_thread(qtbot: QtBot) -> None:
    gate, said = Gate(), []
    worker: NewestWins[int, int] = NewestWins(gate, "to be closed")
    worker.answered.connect(lambda *_: said.append(1))
    worker.ask(1)
    qtbot.waitUntil(lambda: gate.started == [1])
    worker.close()
    worker.ask(2)
    assert gate.stopped == [1]
    assert "to be closed" not in [thread.name for thread in threading.enumerate()]
    assert not said


def test_without_a_thread_the_answer_is_there_when_ask_returns(qtbot: QtBot) -> None:
    answers: list[int] = []
    worker: NewestWins[int, int] = NewestWins(lambda request, _: request + 1, "none", threaded=False)
    worker.answered.connect(lambda request, answer: answers.append(answer))
    worker.ask(1)
    assert answers == [2]
    assert not worker.busy
