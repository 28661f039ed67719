"""Works the real window with a real mouse; run by ``test_window`` under Xvfb.

    python -m tests.e2e.drive_window FOLDER SCAN OTHER...

Opens SCAN by dropping it on the window, drags the three sliders, orbits, draws a profile, crops, undoes,
kills the drawing process, exports into FOLDER/SCAN's name and saves pictures into FOLDER. Then goes on to the
others: dropped or opened, tuned, turned, cut, cropped and exported as they are then. What was true on the way
goes into FOLDER/report.json, a part a scan.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from PySide6.QtWidgets import QTabBar, QWidget
from tests.e2e.driving import (
    Source,
    Steps,
    at,
    clicking,
    dialog,
    dragging,
    on_screen,
    picture,
    pressed,
    run,
    xdotool,
)

from stepfield_app.main_window import MainWindow


def steps(window: MainWindow, scans: Sequence[Path], folder: Path, report: dict[str, Any]) -> Steps:
    """Do one thing after the other; each wait is a name and what must come true."""
    first, *others = scans
    yield "the window to appear", window.isVisible
    report["welcome"] = window.welcome.isVisible()
    yield from whole_tour(window, first, folder, report.setdefault(first.name, {}))
    for number, scan in enumerate(others):
        yield from short_tour(window, scan, folder, report.setdefault(scan.name, {}), dropped=number % 2 == 0)
    window.filing.close_without()


def whole_tour(window: MainWindow, scan: Path, folder: Path, report: dict[str, Any]) -> Steps:
    """Everything there is to do, and what may go wrong."""
    yield from drop(window, scan, window.welcome)
    picture(window, folder, "opened")
    yield from slide_all(window, report)
    yield from orbit(window, report)
    yield from look_closely(window, folder)
    yield from cut(window, report)
    yield from crop(window, report)
    picture(window, folder, "cropped")
    yield from undo_the_crop(window, report)
    yield from lose_the_drawing(window, report)
    yield from export(window, folder / scan.stem, report)


def short_tour(
    window: MainWindow, scan: Path, folder: Path, report: dict[str, Any], *, dropped: bool
) -> Steps:
    """What a scan needs to become a stack, in a window that shows another one with unsaved edits."""
    if dropped:
        yield from drop(window, scan, window.bench.trio)
    else:
        window.open_scans([scan])
        yield from leave_the_last(window, scan)
    picture(window, folder, scan.stem)
    yield from slide_all(window, report)
    yield from orbit(window, report)
    yield from cut(window, report)
    yield from crop(window, report)
    yield from export(window, folder / scan.stem, report)


def drop(window: MainWindow, scan: Path, target: QWidget) -> Steps:
    """Drag a file from another window onto this one."""
    source = Source(scan)
    source.show()
    yield "the file to drag", source.isVisible
    xdotool(*dragging(at(source, 0.5, 0.5), at(target, 0.6, 0.6)))
    yield from leave_the_last(window, scan)
    source.close()


def leave_the_last(window: MainWindow, scan: Path) -> Steps:
    """Give up the edits of the scan before, if there is one, and wait for this one."""
    document = window.bench.document
    if document.answer is not None:
        yield "the question about edits", lambda: dialog("Question") is not None
        question = dialog("Question")
        button = next(each for each in question.buttons() if "Don't" in each.text())
        xdotool(*clicking(at(button, 0.5, 0.5)))
    yield f"{scan.name}", lambda: document.scans == (scan.absolute(),) and window.is_settled()


def slide_all(window: MainWindow, report: dict[str, Any]) -> Steps:
    """Drag every slider; each drag is one step that undo takes back."""
    document = window.bench.document
    yield from bring_forward(window, "Parameters")
    answers: list[Any] = []
    document.answer_changed.connect(answers.append)
    for name in ("tolerance", "alpha", "cell_size"):
        steps_before, answers_before = document.undo_stack.count(), len(answers)
        slider = getattr(window.bench.parameters, name).slider
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


def bring_forward(window: MainWindow, title: str) -> Steps:
    """Click on the tab of a panel, unless it is in front."""
    dock = next(dock for dock in window.docks.all if dock.windowTitle() == title)
    if dock.visibleRegion().isEmpty():
        bars = (bar for bar in window.findChildren(QTabBar) if bar.isVisible())
        bar, tab = next((bar, tab) for bar in bars for tab in range(bar.count()) if bar.tabText(tab) == title)
        middle = bar.tabRect(tab).center()
        xdotool(*clicking(on_screen(bar, middle.x(), middle.y())))
        yield f"the panel {title}", lambda: not dock.visibleRegion().isEmpty()


def orbit(window: MainWindow, report: dict[str, Any]) -> Steps:
    """Turn the three views by dragging one of them."""
    canvas, viewpoint = window.bench.trio.canvases["cloud"], window.bench.trio.viewpoint
    before = viewpoint.camera
    xdotool(*dragging(at(canvas, 0.5, 0.5), at(canvas, 0.7, 0.4)))
    yield "the orbit", lambda: viewpoint.camera.azimuth != before.azimuth and not pressed()
    report["orbited"] = viewpoint.camera.azimuth - before.azimuth


def look_closely(window: MainWindow, folder: Path) -> Steps:
    """Zoom in; then one large view and back."""
    canvas, viewpoint = window.bench.trio.canvases["cloud"], window.bench.trio.viewpoint
    before = viewpoint.camera
    xdotool("mousemove", *at(canvas, 0.5, 0.6), "click", 4, "click", 4)
    yield "the zoom", lambda: viewpoint.camera.distance < before.distance and window.is_settled()
    xdotool("key", "ctrl+2")
    yield "one large view", lambda: window.bench.trio.shown == ("pillars",) and window.is_settled()
    picture(window, folder, "large")
    xdotool("key", "ctrl+0")
    yield "three views", lambda: len(window.bench.trio.shown) == 3 and window.is_settled()


def cut(window: MainWindow, report: dict[str, Any]) -> Steps:
    """Draw a profile line in the map."""
    plot = window.bench.map.plot
    plot.set_line(None)
    xdotool("mousemove", *at(plot, 0.5, 0.5), "key", "p")
    yield "the line tool", lambda: plot.is_drawing
    xdotool(*dragging(at(plot, 0.4, 0.3), at(plot, 0.7, 0.7)))
    yield "the profile", lambda: plot.line is not None and window.is_settled() and not pressed()
    report["profile"] = window.bench.profile.section is not None and window.bench.profile.section.total
    xdotool("key", "Escape")
    yield "the end of the line tool", lambda: not plot.is_drawing


def crop(window: MainWindow, report: dict[str, Any]) -> Steps:
    """Drag the handle of the crop box that is nearest to the viewer."""
    document = window.bench.document
    xdotool("key", "ctrl+alt+0", "key", "c")
    yield (
        "the crop box",
        lambda: window.bench.trio.canvases["cloud"].grip.tool is not None and window.is_settled(),
    )
    canvas = window.bench.trio.canvases["cloud"]
    handle = window.bench.crop_tool.place_of(canvas, (1, 0, 0))
    inside = window.bench.crop_tool.place_of(canvas, (0, 0, 0))
    start = canvas.mapToGlobal(handle.toPoint())
    end = canvas.mapToGlobal((handle + (inside - handle) * 0.5).toPoint())
    points = len(document.answer.result.scan) if document.answer else 0
    xdotool(*dragging((start.x(), start.y()), (end.x(), end.y())))
    yield "the crop", lambda: document.project.parameters.crop is not None and not pressed()
    yield "the cropped result", window.is_settled
    report["cropped"] = points - (len(document.answer.result.scan) if document.answer else 0)
    xdotool("key", "Escape")
    yield "the crop box to go", lambda: window.bench.trio.canvases["cloud"].grip.tool is None


def undo_the_crop(window: MainWindow, report: dict[str, Any]) -> Steps:
    """Have the cropped points back."""
    document = window.bench.document
    cropped = len(document.answer.result.scan) if document.answer else 0
    xdotool("key", "ctrl+z")
    yield "undo", lambda: document.project.parameters.crop is None and window.is_settled()
    points = len(document.answer.result.scan) if document.answer else 0
    report["undone"] = points == cropped + report["cropped"]


def lose_the_drawing(window: MainWindow, report: dict[str, Any]) -> Steps:
    """Kill the process that draws: it comes back, and the document never notices."""
    before, answer = window.bench.client.process_id, window.bench.document.answer
    os.kill(before, signal.SIGKILL)
    yield (
        "another drawing process",
        lambda: window.bench.client.process_id not in (0, before) and window.is_settled(),
    )
    report["came back"] = window.bench.document.answer is answer


def export(window: MainWindow, stack: Path, report: dict[str, Any]) -> Steps:
    """Export by keyboard through the dialog."""
    window.settings.remember_folder("export", stack.parent)
    xdotool("key", "ctrl+e")
    yield "the dialog", lambda: dialog("ExportDialog") is not None
    exporting = dialog("ExportDialog")
    exporting.folder_choice.choose(stack)
    yield "the preview", lambda: exporting.export_button.isEnabled()
    xdotool("mousemove", *at(exporting.export_button, 0.5, 0.5), "click", 1)
    yield (
        "the stack",
        lambda: (stack / "manifest.json").exists() and exporting.show_button.isVisible(),
    )
    picture(exporting, stack.parent, "dialog")
    report["exported"] = window.bench.document.answer.result.parameters.model_dump(mode="json")  # type: ignore[union-attr]
    exporting.reject()
    yield "the dialog to go", lambda: dialog("ExportDialog") is None


def main() -> None:
    """Run it all and write the report."""
    folder, *scans = map(Path, sys.argv[1:])
    run(lambda window, report: steps(window, scans, folder, report), folder / "report.json")


if __name__ == "__main__":
    main()
