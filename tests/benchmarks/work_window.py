"""Works the real window and notes how long everything takes; run by ``test_window``, under Xvfb if possible.

    python work_window.py TASK REPORT FILE...

TASK is one of :data:`TASKS`. What was measured goes into REPORT as JSON, and the window is closed.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, Qt, QTimer
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QWidget

sys.path.insert(0, str(Path(__file__).parents[2]))  # run as a script
from tests.benchmarks.clock import Clock, Report, Task, Wait, Watch, is_past, settled
from tests.benchmarks.edit_task import edit

from stepfield.pipeline import Pipeline
from stepfield_app import application
from stepfield_app.main_window import MainWindow
from stepfield_app.newest import NewestWins
from stepfield_app.panels.parameters import cell_range, height_range
from stepfield_app.render.scene import CLOUD, VIEWS

#: How long and how often the hand moves, seconds.
DRAG_SECONDS, MOVES_A_SECOND = 5.0, 60
#: Size of the views together, as the figures are given for.
VIEW_SIZE = (1600, 1000)
#: Lengths each slider is dragged between, metres.
SLIDERS = {"tolerance": (0.2, 0.8), "alpha": (0.1, 1.0), "cell_size": (0.2, 0.6)}
PARAMETER = {"tolerance": "layer_tolerance", "alpha": "alpha", "cell_size": "cell_size"}


# --- Tasks --------------------------------------------------------------------------------------------------


def tune(window: MainWindow, report: Report, clock: Clock) -> Iterator[Wait]:
    """Drag every slider, then compare the exact result of a cell size with the core's own time."""
    yield partial(settled, window)
    for name in os.environ.get("SLIDERS", " ".join(SLIDERS)).split():
        report[name] = {}
        yield from drag(window, name, report[name], clock)
        window.bench.document.undo_stack.undo()
        yield partial(settled, window)
    report["core"] = core_seconds(window)


def orbit(window: MainWindow, report: Report, clock: Clock) -> Iterator[Wait]:
    """Orbit one large view and three, and let each come to rest."""
    yield partial(settled, window)
    for dock in window.docks.all:
        dock.hide()
    for views in ((CLOUD,), VIEWS):
        window.bench.trio.arrange(views)
        yield partial(is_past, time.perf_counter() + 0.5)
        window.resize(*window_size(window))
        yield partial(is_past, time.perf_counter() + 0.3)
        yield partial(settled, window)
        found: Report = {}
        report[str(len(views))] = found
        yield from turn(window, views, found)
    report["memory"] = memory()


def grow(window: MainWindow, report: Report, clock: Clock) -> Iterator[Wait]:
    """Open and close small scans and move the sliders, over and over."""
    files = tuple(Path(word) for word in sys.argv[3:])
    yield partial(settled, window)
    yield from open_and_close(window, files, 20)
    yield from move_sliders(window, 50)
    report["before"] = held()
    yield from open_and_close(window, files, 200)
    report["opened"] = held()
    yield from move_sliders(window, 500)
    report["after"] = held()


TASKS: dict[str, Task] = {"tune": tune, "orbit": orbit, "grow": grow, "edit": edit}


# --- Dragging -----------------------------------------------------------------------------------------------


def drag(window: MainWindow, name: str, report: Report, clock: Clock) -> Iterator[Wait]:
    """Drag a slider and note when map and layers panel show an answer of what was chosen."""
    document, slider = window.bench.document, getattr(window.bench.parameters, name).slider
    assert document.facts is not None
    lengths = (cell_range if name == "cell_size" else height_range)(document.facts)
    first, last = map(lengths.position, SLIDERS[name])
    positions = np.linspace(first, last, int(DRAG_SECONDS * MOVES_A_SECOND))
    shown = Shown(window, PARAMETER[name], clock)
    clock.ticks.clear()
    slider.setSliderDown(True)
    begin = time.perf_counter()
    for number, position in enumerate(positions):
        yield partial(is_past, begin + number / MOVES_A_SECOND)
        shown.move(partial(slider.setValue, round(position)))
    report["gaps"] = np.diff(clock.ticks).tolist()
    slider.setSliderDown(False)
    released = time.perf_counter()
    yield lambda: not document.pending
    report["exact"] = time.perf_counter() - released
    yield partial(settled, window)
    report["settled"] = time.perf_counter() - released
    report["gaps after"] = np.diff(clock.ticks).tolist()[len(report["gaps"]) :]
    report["latencies"], report["answers"] = shown.end(released), shown.answers


class Shown:
    """Notes when both map and layers panel show an answer of a parameter that was set."""

    def __init__(self, window: MainWindow, parameter: str, clock: Clock) -> None:
        self._window, self._parameter, self._clock = window, parameter, clock
        self._set: dict[float, float] = {}
        self._parts: dict[float, set[str]] = {}
        self._seen: dict[float, float] = {}
        self.answers = 0
        self._connections = [
            window.findChild(NewestWins, part).answered.connect(partial(self._note, part))  # type: ignore[union-attr]
            for part in ("map", "layers panel")
        ]
        self._counting = window.bench.document.answer_changed.connect(self._count)

    def move(self, act: Callable[[], None]) -> None:
        """Set a parameter and note when."""
        now = time.perf_counter()
        act()
        self._set.setdefault(self._value(self._window.bench.document.project.parameters), now)

    def end(self, released: float) -> list[float]:
        """Seconds from the first setting of each parameter that was shown while the hand moved."""
        for connection in (*self._connections, self._counting):
            QObject.disconnect(connection)
        return [seen - self._set[value] for value, seen in self._seen.items() if seen <= released]

    def _value(self, parameters: Any) -> float:
        return float(getattr(parameters, self._parameter))

    def _count(self, _: object) -> None:
        self.answers += 1

    def _see(self, value: float) -> None:
        self._seen.setdefault(value, time.perf_counter())

    def _note(self, part: str, wish: Any, _: object) -> None:
        value = self._value(wish.answer.request.parameters)
        parts = self._parts.setdefault(value, set())
        parts.add(part)
        if len(parts) == 2 and value in self._set:  # it is painted before the next tick
            self._clock.at_tick.append(partial(self._see, value))


def core_seconds(window: MainWindow) -> float:
    """Time the core alone takes for the exact result of another cell size."""
    document, pipeline = window.bench.document, Pipeline()
    parameters = document.project.parameters
    pipeline.run(document.scans, parameters)
    begin = time.perf_counter()
    pipeline.run(document.scans, parameters.model_copy(update={"cell_size": SLIDERS["cell_size"][1]}))
    return time.perf_counter() - begin


# --- Orbiting -----------------------------------------------------------------------------------------------


def window_size(window: MainWindow) -> tuple[int, int]:
    """Size of the window at which the pictures have the size wanted, together."""
    canvases = [window.bench.trio.canvases[view] for view in window.bench.trio.shown]
    across, down = sum(canvas.width() for canvas in canvases), canvases[0].height()
    return window.width() + VIEW_SIZE[0] - across, window.height() + VIEW_SIZE[1] - down


def turn(window: MainWindow, views: Sequence[str], report: Report) -> Iterator[Wait]:
    """Orbit with the mouse, count the pictures painted, and wait for the full ones."""
    canvas = window.bench.trio.canvases[views[0]]
    frames: dict[str, list[Any]] = {view: [] for view in views}

    def note(view: str) -> None:
        frame = window.bench.client.frame(view)
        if frame is not None and not any(frame is known for known in frames[view][-1:]):
            frames[view] = [*frames[view][-1:], frame]
            counted[view].append(frame.points)

    counted: dict[str, list[int]] = {view: [] for view in views}
    watches = [Watch(window.bench.trio.canvases[view], partial(note, view)) for view in views]
    mouse(canvas, QEvent.Type.MouseButtonPress, (100, 500))
    begin = time.perf_counter()
    for number in range(int(DRAG_SECONDS * MOVES_A_SECOND)):
        yield partial(is_past, begin + number / MOVES_A_SECOND)
        mouse(canvas, QEvent.Type.MouseMove, (100 + number, 500))
    moved = {view: list(points) for view, points in counted.items()}
    mouse(canvas, QEvent.Type.MouseButtonRelease, (100 + number, 500))
    released = time.perf_counter()
    yield partial(settled, window)
    report["rest"] = time.perf_counter() - released
    for watch in watches:
        watch.end()
    report["size"] = canvas.pixels
    report["pictures"] = min(len(points) for points in moved.values())
    report["points"] = int(np.median(moved[CLOUD])) if moved[CLOUD] else 0
    full = {view: frame for view in views if (frame := window.bench.client.frame(view)) is not None}
    report["full"] = full[CLOUD].points, full[CLOUD].covered
    report["each"] = {view: (frame.seconds, frame.triangles) for view, frame in full.items()}


def mouse(widget: QWidget, kind: QEvent.Type, place: tuple[int, int]) -> None:
    """Send a widget what the left button and the mouse do."""
    at, button = QPointF(*place), Qt.MouseButton.LeftButton
    held = Qt.MouseButton.NoButton if kind == QEvent.Type.MouseButtonRelease else button
    moved = Qt.MouseButton.NoButton if kind == QEvent.Type.MouseMove else button
    on_screen = QPointF(widget.mapToGlobal(QPoint(*place)))
    event = QMouseEvent(kind, at, on_screen, moved, held, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(widget, event)


# --- Growing ------------------------------------------------------------------------------------------------


def open_and_close(window: MainWindow, files: Sequence[Path], times: int) -> Iterator[Wait]:
    """Open each of the scans in turn, wait until it is drawn, and close it."""
    for number in range(times):
        window.open_scans([files[number % len(files)]])
        yield lambda: not window.bench.document.opening and settled(window)
        window.bench.document.close_scan()
        yield window.is_settled
    window.open_scans(files[:1])
    yield lambda: not window.bench.document.opening and settled(window)


def move_sliders(window: MainWindow, times: int) -> Iterator[Wait]:
    """Move the sliders in turn and wait each time for the result."""
    sliders = [getattr(window.bench.parameters, name).slider for name in SLIDERS]
    for number in range(times):
        sliders[number % 3].setValue(450 + number * 37 % 100)
        yield lambda: not window.bench.document.pending
    yield partial(settled, window)


def processes() -> list[psutil.Process]:
    """Return this process and all it started."""
    own = psutil.Process()
    return [own, *own.children(recursive=True)]


def memory() -> dict[str, float]:
    """Memory of all processes, GB: what they share counted once, and as each of them sees it."""
    found = [process.memory_full_info() for process in processes()]
    return {"pss": sum(one.pss for one in found) / 1e9, "rss": sum(one.rss for one in found) / 1e9}


def held() -> dict[str, float]:
    """Return what the processes hold: memory in MB, handles, threads and files shared between them."""
    own, *others = processes()
    return {
        "memory of the window, MB": own.memory_info().rss / 1e6,
        "memory of the others, MB": sum(process.memory_info().rss for process in others) / 1e6,
        "handles": sum(process.num_fds() for process in processes()),
        "threads": sum(process.num_threads() for process in processes()),
        "shared files": sum(len(list(place.glob("*"))) for place in shared_places()),
    }


def shared_places() -> list[Path]:
    """Return the folders of the window's shared files."""
    return list(Path("/dev/shm").glob(f"stepfield-render-{os.getpid()}-*"))


# --- Running ------------------------------------------------------------------------------------------------


def watched(task: Task, report: Report) -> type[MainWindow]:
    """Return a window that works itself as soon as it is painted."""

    class Watched(MainWindow):
        def __init__(self, *given: Any, **named: Any) -> None:
            super().__init__(*given, **named)
            self._clock: Clock | None = None
            self._first = Watch(self, lambda: QTimer.singleShot(0, self._begin))

        def _begin(self) -> None:
            self._first.end()
            if self._clock is None:
                self._clock = Clock(self)
                self._clock.start(self._work(self._clock))

        def _work(self, clock: Clock) -> Iterator[Wait]:
            yield from task(self, report, clock)
            self.filing.close_without()

    return Watched


def main() -> None:
    """Run a task and write the report."""
    task, file, *scans = sys.argv[1:]
    report: Report = {}
    setattr(application, "MainWindow", watched(TASKS[task], report))  # noqa: B010 - what run() makes
    from stepfield.cli import run

    given = [word for word in os.environ.get("OPTIONS", "").split() if word]
    code = run(["view", *(scans if task != "grow" else scans[:1]), *given])
    Path(file).write_text(json.dumps(report))
    sys.exit(code)


if __name__ == "__main__":
    main()
