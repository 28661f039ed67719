"""Tuning in the window: a hand drags a slider for some seconds over a large scan.

What counts: how often the picture follows, how old it is when it comes, and whether the window ever stands
still. The event loop is asked to tick every 5 ms; what is measured is the time between two ticks.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.benchmarks.conftest import POINTS, Table

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PySide6.QtCore import QCoreApplication, QEventLoop, Qt, QTimer
from PySide6.QtWidgets import QApplication

from stepfield.parameters import Parameters
from stepfield_app.document import Document
from stepfield_app.requests import Answer

#: How long and how often the hand moves.
DRAG_SECONDS, MOVES_A_SECOND = 5.0, 60
TICK = 0.005


@dataclass
class Drag:
    """What was seen while the hand moved.

    Attributes
    ----------
    latencies : list of float
        Seconds from a move of the hand to the picture that belongs to it.
    gaps : list of float
        Seconds between ticks of the event loop.
    exact_after : float
        Seconds from the release to the exact result.
    """

    latencies: list[float] = field(default_factory=list)
    gaps: list[float] = field(default_factory=list)
    exact_after: float = 0.0


class Clock:
    """Notes when the event loop gets to tick."""

    def __init__(self) -> None:
        self.ticks: list[float] = []
        self._timer = QTimer(interval=int(TICK * 1000), timerType=Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(lambda: self.ticks.append(time.perf_counter()))
        self._timer.start()

    def gaps(self) -> list[float]:
        """Stop, and return the times between ticks."""
        self._timer.stop()
        return np.diff(self.ticks).tolist()


def run_until(condition: Callable[[], bool], limit: float = 60.0) -> None:
    """Let events happen until a condition holds."""
    end = time.perf_counter() + limit
    while not condition() and time.perf_counter() < end:
        QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)


def is_past(moment: float) -> bool:
    """Whether a moment of the performance counter has come."""
    return time.perf_counter() >= moment


def drag(document: Document, name: str, values: Sequence[Any]) -> Drag:
    """Drag a parameter through values, 60 a second, and wait for the exact result."""
    seen = Drag()
    asked: dict[Any, float] = {}
    clock = Clock()
    gesture = document.begin_gesture()

    def note(answer: Answer) -> None:
        moved = asked.get(getattr(answer.request.parameters, name))
        if moved is not None:
            seen.latencies.append(time.perf_counter() - moved)

    document.answer_changed.connect(note)
    start = time.perf_counter()
    for i, value in enumerate(values):
        due = start + i / MOVES_A_SECOND
        run_until(partial(is_past, due))
        asked[value] = time.perf_counter()
        document.set_parameters(f"{name} {value}", gesture, **{name: value})
    document.answer_changed.disconnect(note)
    document.end_gesture(gesture)
    released = time.perf_counter()
    run_until(lambda: not document.pending)
    seen.exact_after = time.perf_counter() - released
    run_until(lambda: not document.busy)
    seen.gaps = clock.gaps()
    return seen


@pytest.fixture(scope="module")
def document(storeys: NDArray[np.float32], folder: Path) -> Iterator[Document]:
    application = QApplication.instance() or QApplication([])
    path = folder / "tuned.npy"
    np.save(path, storeys)
    document = Document()
    document.open([path], Parameters(cell_size=0.25, layer_tolerance=0.3, alpha=0.5))
    run_until(lambda: document.answer is not None and not document.busy)
    yield document
    document.close()
    path.unlink()
    del application


MOVES = int(DRAG_SECONDS * MOVES_A_SECOND)
DRAGS: dict[str, Sequence[Any]] = {
    "alpha": np.linspace(0.1, 1.0, MOVES).tolist(),
    "layer_tolerance": np.linspace(0.2, 0.8, MOVES).tolist(),
    "cell_size": np.linspace(0.2, 0.6, MOVES).tolist(),
    "crop": [(-1.0, -1.0, -1.0, 101.0, 101.0, top) for top in np.linspace(3.5, 1.5, MOVES).tolist()],
}


@pytest.mark.parametrize("name", list(DRAGS))
def test_a_drag(document: Document, table: Table, name: str) -> None:
    seen = drag(document, name, DRAGS[name])
    document.undo_stack.undo()
    run_until(lambda: not document.busy)
    assert seen.latencies, "the picture did not follow the hand at all"
    what = f"{name} dragged, {POINTS / 1e6:g} M points"
    shown = DRAG_SECONDS / len(seen.latencies)
    table.add(f"{what}: between results", shown, "between moves", 1 / MOVES_A_SECOND)
    table.add("  latency, 95 of 100", float(np.quantile(seen.latencies, 0.95)), "a blink", 0.15, "<= 1")
    table.add("  gap of the event loop, 99 of 100", float(np.quantile(seen.gaps, 0.99)), "asked for", TICK)
    table.add("  gap of the event loop, longest", max(seen.gaps), "a blink", 0.15, "<= 1")
    table.add("  release to exact result", seen.exact_after, "a second", 1.0, "<= 1")
