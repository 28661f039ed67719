"""Works the real window with a real mouse; run by ``test_window`` under Xvfb.

    python -m tests.e2e.drive_window SCAN FOLDER

Opens SCAN by dropping it on the window, drags the three sliders, orbits, draws a profile, crops, undoes,
kills the drawing process, exports into FOLDER/stack and saves pictures into FOLDER. What was true on the way
goes into FOLDER/report.json.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import Any

from tests.e2e.driving import Source, Steps, at, dialog, dragging, picture, pressed, run, xdotool

from stepfield_app.main_window import MainWindow


def steps(window: MainWindow, scan: Path, folder: Path, report: dict[str, Any]) -> Steps:
    """Do one thing after the other; each wait is a name and what must come true."""
    document, source = window.document, Source(scan)
    source.show()
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


def slide_all(window: MainWindow, report: dict[str, Any]) -> Steps:
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


def look_around(window: MainWindow, folder: Path, report: dict[str, Any]) -> Steps:
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


def cut_and_crop(window: MainWindow, folder: Path, report: dict[str, Any]) -> Steps:
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


def lose_the_drawing(window: MainWindow, report: dict[str, Any]) -> Steps:
    """Kill the process that draws: it comes back, and the document never notices."""
    before, answer = window.client.process_id, window.document.answer
    os.kill(before, signal.SIGKILL)
    yield (
        "another drawing process",
        lambda: window.client.process_id not in (0, before) and window.is_settled(),
    )
    report["came back"] = window.document.answer is answer


def export(window: MainWindow, folder: Path, report: dict[str, Any]) -> Steps:
    """Export by keyboard through the exporting."""
    window.settings.remember_folder("export", folder)
    xdotool("key", "ctrl+e")
    yield "the dialog", lambda: dialog("ExportDialog") is not None
    exporting = dialog("ExportDialog")
    exporting.folder_choice.choose(folder / "stack")
    yield "the preview", lambda: exporting.export_button.isEnabled()
    xdotool("mousemove", *at(exporting.export_button, 0.5, 0.5), "click", 1)
    yield (
        "the stack",
        lambda: (folder / "stack" / "manifest.json").exists() and exporting.show_button.isVisible(),
    )
    exporting.grab().save(str(folder / "dialog.png"))
    report["exported"] = window.document.answer.result.parameters.model_dump(mode="json")  # type: ignore[union-attr]
    exporting.reject()
    yield "the dialog to go", lambda: dialog("ExportDialog") is None


def main() -> None:
    """Run it all and write the report."""
    scan, folder = Path(sys.argv[1]), Path(sys.argv[2])
    run(lambda window, report: steps(window, scan, folder, report), folder / "report.json")


if __name__ == "__main__":
    main()
