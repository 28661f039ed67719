"""Works the editor of a real window: a lasso, a move of what it caught, undo and redo, over and over."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from PySide6.QtCore import QObject
from tests.benchmarks.clock import Clock, Report, Wait, is_past, settled

from stepfield_app.main_window import MainWindow
from stepfield_app.newest import NewestWins
from stepfield_app.scenes.picking import OnMap, Shape

#: Times that everything is done; places of the lasso; the pillars it is to catch; the layer they go to.
TIMES, CORNERS, CAUGHT, TARGET = 5, 400, 100_000, 3
#: Seconds between two deeds: a hand does not move at once.
PAUSE = 1.0


def edit(window: MainWindow, report: Report, clock: Clock) -> Iterator[Wait]:
    """Note how long each deed takes to map and panel, to the 3-D views, and to all of them in full."""
    yield partial(settled, window)
    window.bench.selection.set_reach("layer")
    window.bench.document.set_active_layer(2)
    yield partial(settled, window)
    stack = window.bench.document.undo_stack
    for nth in range(TIMES):
        yield from _timed(window, report, clock, "select", partial(_lasso, window, nth), _is_outlined)
        report["selected"] = window.bench.selection.count
        yield from _timed(window, report, clock, "move", partial(window.bench.editor.move_to, TARGET))
        yield from _timed(window, report, clock, "undo", stack.undo)
        yield from _timed(window, report, clock, "redo", stack.redo)
        stack.undo()
        window.bench.selection.clear()
        yield partial(settled, window)


def _timed(
    window: MainWindow,
    report: Report,
    clock: Clock,
    name: str,
    act: Callable[[], object],
    is_shown: Callable[[MainWindow], bool] | None = None,
) -> Iterator[Wait]:
    """Do something, and note when map and panel show it, when everything does, and the gaps meanwhile."""
    found = report.setdefault(name, {"shown": [], "seen": [], "drawn": [], "gaps": []})
    answered = Answered(window)
    clock.ticks.clear()
    begin = time.perf_counter()
    act()
    yield partial(is_shown, window) if is_shown else answered.is_whole
    yield lambda: True  # it is painted before the next tick
    found["shown"].append(time.perf_counter() - begin)
    answered.end()
    yield lambda: window.bench.feeds.recolour.is_current
    yield lambda: True
    found["seen"].append(time.perf_counter() - begin)
    yield lambda: window.bench.feeds.scene.is_idle and window.bench.client.is_at_rest()
    found["drawn"].append(time.perf_counter() - begin)
    yield partial(settled, window)
    found["gaps"] += np.diff(clock.ticks).tolist()
    yield partial(is_past, time.perf_counter() + PAUSE)


class Answered:
    """Whether both the map and the layers panel have got pictures since it was made."""

    def __init__(self, window: MainWindow) -> None:
        self._missing = {"map", "layers panel"}
        self._connections = [
            window.findChild(NewestWins, part).answered.connect(partial(self._note, part))  # type: ignore[union-attr]
            for part in ("map", "layers panel")
        ]

    def is_whole(self) -> bool:
        """Whether nothing is missing."""
        return not self._missing

    def end(self) -> None:
        """Note no more."""
        for connection in self._connections:
            QObject.disconnect(connection)

    def _note(self, part: str, _: object, __: object) -> None:
        self._missing.discard(part)


def _lasso(window: MainWindow, nth: int = 0) -> None:
    """Draw around about the pillars wanted, in the middle of the map or ``nth`` compartments beside it."""
    answer = window.bench.document.answer
    assert answer is not None
    grid = answer.result.field.compartments.grid
    middle = np.array(
        [grid.west + grid.columns * grid.cell_size / 2, grid.south + grid.rows * grid.cell_size / 2]
    )
    angle = np.linspace(0, 2 * np.pi, CORNERS)
    radius = np.sqrt(CAUGHT * grid.cell_size**2 / np.pi)
    path = middle + nth * grid.cell_size + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    window.bench.selection.pick(OnMap(Shape("lasso", path), window.bench.document.active_layer))


def _is_outlined(window: MainWindow) -> bool:
    return (
        window.bench.selection.count > 0
        and not window.bench.selection.busy
        and window.bench.select_tools.is_idle
    )
