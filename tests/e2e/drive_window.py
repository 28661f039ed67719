"""Works the real window with a real mouse; run by ``test_window`` under Xvfb.

    python drive_window.py SCAN FOLDER

Opens SCAN by dropping it on the window, drags the three sliders, orbits, draws a profile, crops, undoes,
kills the drawing process, exports into FOLDER/stack and saves pictures into FOLDER. What was true on the way
goes into FOLDER/report.json.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from PySide6.QtCore import QMimeData, QPoint, Qt, QTimer, QUrl
from PySide6.QtGui import QDrag, QMouseEvent
from PySide6.QtWidgets import QApplication, QLabel, QWidget

from stepfield_app.appearance import Appearance
from stepfield_app.main_window import MainWindow
from stepfield_app.settings import Settings

#: Milliseconds between two looks, and looks before a wait is given up.
LOOK, PATIENCE = 20, 1500


class Source(QLabel):
    """A file that can be dragged out of another window, as from a file manager."""

    def __init__(self, path: Path) -> None:
        super().__init__(path.name)
        self._path = path
        self.setWindowFlag(Qt.WindowType.WindowStaysOnTopHint)
        self.setGeometry(1300, 820, 200, 60)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Begin the drag."""
        data = QMimeData()
        data.setUrls([QUrl.fromLocalFile(str(self._path))])
        drag = QDrag(self)
        drag.setMimeData(data)
        drag.exec(Qt.DropAction.CopyAction)


def xdotool(*words: object) -> None:
    """Move the real mouse and press real keys; starts it and does not wait, as this very thread answers."""
    subprocess.Popen(["xdotool", *map(str, words)], start_new_session=True)


def at(widget: QWidget, x: float, y: float) -> tuple[int, int]:
    """Return the place on the screen of a point of a widget, given as shares of its size."""
    place = widget.mapToGlobal(QPoint(int(x * (widget.width() - 1)), int(y * (widget.height() - 1))))
    return place.x(), place.y()


def dragging(*places: tuple[int, int], button: int = 1) -> list[object]:
    """Words that make xdotool drag from place to place."""
    (x, y), *others = places
    words: list[object] = ["mousemove", x, y, "sleep", 0.1, "mousedown", button]
    for one, other in zip(places, others, strict=False):
        for step in range(1, 13):
            there = [round(a + (b - a) * step / 12) for a, b in zip(one, other, strict=True)]
            words += ["mousemove", *there, "sleep", 0.03]
    return [*words, "mouseup", button]


Wait = tuple[str, Callable[[], bool]]


def steps(window: MainWindow, source: Source, folder: Path, report: dict[str, Any]) -> Iterator[Wait]:
    """Do one thing after the other; each wait is a name and what must come true."""
    document = window.document
    yield "the window to appear", lambda: window.isVisible() and source.isVisible()
    report["welcome"] = window.welcome.isVisible()
    xdotool(*dragging(at(source, 0.5, 0.5), at(window.welcome, 0.6, 0.6)))
    yield "the dropped scan", lambda: document.answer is not None and window.is_settled()
    source.close()
    picture(window, folder, "opened")
    yield from slide_all(window, report)
    yield from look_around(window, folder, report)
    yield from cut_and_crop(window, folder, report)
    yield from lose_the_drawing(window, report)
    yield from export(window, folder, report)
    window.filing.close_without()


def slide_all(window: MainWindow, report: dict[str, Any]) -> Iterator[Wait]:
    """Drag every slider; each drag is one step that undo takes back."""
    document = window.document
    answers: list[Any] = []
    document.answer_changed.connect(answers.append)
    for name in ("tolerance", "alpha", "cell_size"):
        steps_before, answers_before = document.undo_stack.count(), len(answers)
        slider = getattr(window.parameters, name).slider
        share = slider.value() / slider.maximum()
        way = 0.15 if share < 0.6 else -0.15
        xdotool(*dragging(at(slider, share, 0.5), at(slider, share + way, 0.5)))
        yield f"a step of {name}", lambda before=steps_before: document.undo_stack.count() > before  # type: ignore[misc]
        yield f"the result of {name}", lambda: window.is_settled() and not pressed()
        report[name] = {
            "steps": document.undo_stack.count() - steps_before,
            "answers": len(answers) - answers_before,
        }
    document.answer_changed.disconnect(answers.append)


def look_around(window: MainWindow, folder: Path, report: dict[str, Any]) -> Iterator[Wait]:
    """Orbit and zoom; then one large view and back."""
    canvas, viewpoint = window.trio.canvases["cloud"], window.trio.viewpoint
    before = viewpoint.camera
    xdotool(*dragging(at(canvas, 0.5, 0.5), at(canvas, 0.7, 0.4)))
    yield "the orbit", lambda: viewpoint.camera.azimuth != before.azimuth and not pressed()
    xdotool("mousemove", *at(canvas, 0.5, 0.6), "click", 4, "click", 4)
    yield "the zoom", lambda: viewpoint.camera.distance < before.distance and window.is_settled()
    xdotool("key", "ctrl+2")
    yield "one large view", lambda: window.trio.shown == ("pillars",) and window.is_settled()
    picture(window, folder, "large")
    xdotool("key", "ctrl+0")
    yield "three views", lambda: len(window.trio.shown) == 3 and window.is_settled()
    report["orbited"] = viewpoint.camera.azimuth - before.azimuth


def cut_and_crop(window: MainWindow, folder: Path, report: dict[str, Any]) -> Iterator[Wait]:
    """Draw a profile line in the map, then drag the handle of the crop box that is nearest to the viewer."""
    document, plot = window.document, window.map.plot
    plot.set_line(None)
    xdotool("mousemove", *at(plot, 0.5, 0.5), "key", "p")
    yield "the line tool", lambda: plot.is_drawing
    xdotool(*dragging(at(plot, 0.4, 0.3), at(plot, 0.7, 0.7)))
    yield "the profile", lambda: plot.line is not None and window.is_settled() and not pressed()
    report["profile"] = window.profile.section is not None and window.profile.section.total
    xdotool("key", "Escape", "key", "ctrl+alt+0", "key", "c")
    yield "the crop box", lambda: window.trio.canvases["cloud"].grip.tool is not None and window.is_settled()
    canvas = window.trio.canvases["cloud"]
    handle = window.crop_tool.place_of(canvas, (1, 0, 0))
    inside = window.crop_tool.place_of(canvas, (0, 0, 0))
    start = canvas.mapToGlobal(handle.toPoint())
    end = canvas.mapToGlobal((handle + (inside - handle) * 0.5).toPoint())
    points = len(document.answer.result.scan) if document.answer else 0
    xdotool(*dragging((start.x(), start.y()), (end.x(), end.y())))
    yield "the crop", lambda: document.project.parameters.crop is not None and not pressed()
    yield "the cropped result", window.is_settled
    report["cropped"] = points - (len(document.answer.result.scan) if document.answer else 0)
    picture(window, folder, "cropped")
    xdotool("key", "Escape", "key", "ctrl+z")
    yield "undo", lambda: document.project.parameters.crop is None and window.is_settled()
    report["undone"] = (len(document.answer.result.scan) if document.answer else 0) == points


def lose_the_drawing(window: MainWindow, report: dict[str, Any]) -> Iterator[Wait]:
    """Kill the process that draws: it comes back, and the document never notices."""
    before, answer = window.client.process_id, window.document.answer
    os.kill(before, signal.SIGKILL)
    yield (
        "another drawing process",
        lambda: window.client.process_id not in (0, before) and window.is_settled(),
    )
    report["came back"] = window.document.answer is answer


def export(window: MainWindow, folder: Path, report: dict[str, Any]) -> Iterator[Wait]:
    """Export by keyboard through the dialog."""
    window.settings.remember_folder("export", folder)
    xdotool("key", "ctrl+e")
    yield "the dialog", lambda: export_dialog() is not None
    dialog: Any = export_dialog()
    dialog.folder_choice.choose(folder / "stack")
    yield "the preview", lambda: dialog.export_button.isEnabled()
    xdotool("mousemove", *at(dialog.export_button, 0.5, 0.5), "click", 1)
    yield (
        "the stack",
        lambda: (folder / "stack" / "manifest.json").exists() and dialog.show_button.isVisible(),
    )
    dialog.grab().save(str(folder / "dialog.png"))
    report["exported"] = window.document.answer.result.parameters.model_dump(mode="json")  # type: ignore[union-attr]
    dialog.reject()
    yield "the dialog to go", lambda: export_dialog() is None


def export_dialog() -> QWidget | None:
    """Return the export dialog while it is open."""
    active = QApplication.activeModalWidget()
    return active if type(active).__name__ == "ExportDialog" else None


def pressed() -> bool:
    """Whether a mouse button is still down."""
    return QApplication.mouseButtons() != Qt.MouseButton.NoButton


def picture(window: MainWindow, folder: Path, name: str) -> None:
    """Save what the window shows."""
    window.grab().save(str(folder / f"{name}.png"))


class Driver:
    """Takes the next step whenever what the last one waits for has come true."""

    def __init__(self, window: MainWindow, todo: Iterator[Wait], report: dict[str, Any]) -> None:
        self._window, self._todo, self._report = window, todo, report
        self._wait: Wait = ("the start", lambda: True)
        self._looks = 0
        self._timer = QTimer(interval=LOOK)
        self._timer.timeout.connect(self._look)
        self._timer.start()

    def _look(self) -> None:
        self._looks += 1
        try:
            if self._wait[1]():
                self._wait, self._looks = next(self._todo), 0
            elif self._looks > PATIENCE:
                self._stop(f"waited in vain for {self._wait[0]}")
        except StopIteration:
            self._stop(None)
        except Exception as error:  # noqa: BLE001 - told in the report; the window would stay open otherwise
            self._stop(f"{self._wait[0]}: {error!r}")

    def _stop(self, failure: str | None) -> None:
        self._timer.stop()
        self._report["failure"] = failure
        if failure:
            messages = [message.sentence for message in self._window.message_bar.messages]
            self._report["messages"] = messages
            for widget in QApplication.topLevelWidgets():
                widget.close()


def main() -> None:
    """Run it all and write the report."""
    scan, folder = Path(sys.argv[1]), Path(sys.argv[2])
    report: dict[str, Any] = {"failure": "the program ended early"}
    application = QApplication([])
    window = MainWindow(Appearance(application, "dark"), Settings(), size=(1600, 1000))
    source = Source(scan)
    window.show()
    source.show()
    driver = Driver(window, steps(window, source, folder, report), report)
    application.exec()
    del driver
    (folder / "report.json").write_text(json.dumps(report))


if __name__ == "__main__":
    main()
