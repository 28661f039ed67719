"""The window worked by mouse alone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QPushButton, QToolBar, QWidget
from tests.e2e.correction import Patch
from tests.e2e.driving import (
    Place,
    Source,
    Steps,
    at,
    carrying,
    clicking,
    dialog,
    dragging,
    on_screen,
    pressed,
    xdotool,
)

from stepfield_app.main_window import MainWindow
from stepfield_app.panels.layers_drops import COUNTING
from stepfield_app.panels.layers_model import Role
from stepfield_app.panels.row_layout import RowLayout
from stepfield_app.render.scene import PILLARS

#: Pixels of a compartment at which a hand can draw around some.
FINE = 8.0


class Mouse:
    """Drops files, draws lassos, drags pillars onto rows, clicks buttons; first in 3-D, then in the map.

    Parameters
    ----------
    window : MainWindow
    report : dict
        Takes what the rows say while something is held over them.
    """

    def __init__(self, window: MainWindow, report: dict[str, object]) -> None:
        self._window, self._report = window, report
        self._screen: Callable[[float, float], Place] = self._in_view

    # --- Files ----------------------------------------------------------------------------------------------

    def open(self, file: Path) -> Steps:
        """Drop a project on the window."""
        source = Source(file)
        source.show()
        yield "the file to drag", source.isVisible
        xdotool(*dragging(at(source, 0.5, 0.5), at(self._window.welcome, 0.6, 0.6)))
        yield (
            "the drop",
            lambda: self._window.bench.document.busy or self._window.bench.document.answer is not None,
        )
        source.close()

    def save(self, file: Path) -> Steps:
        """Press the button: the project has its file."""
        self._press("save")
        yield "saving", lambda: not self._window.bench.document.file.dirty

    def recover(self) -> Steps:
        """Press the button of the offer."""
        xdotool(*clicking(at(self._button(self._window.message_bar, "Recover"), 0.5, 0.5)))
        yield "the offer to be taken", lambda: not self._window.message_bar.messages

    def export(self) -> Steps:
        """Press the buttons; the folder is the one that is proposed."""
        self._press("export")
        yield "the dialog", lambda: dialog("ExportDialog") is not None
        exporting = dialog("ExportDialog")
        yield "the preview", exporting.export_button.isEnabled
        self._report["stack"] = str(exporting.folder_choice.folder)
        xdotool(*clicking(at(exporting.export_button, 0.5, 0.5)))
        yield "the stack", exporting.show_button.isVisible
        xdotool(*clicking(at(exporting.close_button, 0.5, 0.5)))
        yield "the dialog to go", lambda: dialog("ExportDialog") is None

    def leave(self) -> Steps:
        """Quit by the menu."""
        bar = self._window.menuBar()
        file = bar.actions()[0]
        xdotool(*clicking(on_screen(bar, *bar.actionGeometry(file).center().toTuple())))
        menu = file.menu()
        assert isinstance(menu, QMenu)
        yield "the menu", menu.isVisible
        quit_ = menu.actionGeometry(self._window.commands["quit"]).center()
        xdotool(*clicking(on_screen(menu, *quit_.toTuple())))

    # --- Editing --------------------------------------------------------------------------------------------

    def select(self, patch: Patch) -> Steps:
        """Draw a lasso: around the first patch in the 3-D view, from above, then in the map."""
        window = self._window
        xdotool(*clicking(self._row(patch.wrong)))
        yield "the layer", lambda: window.bench.document.active_layer == patch.wrong and window.is_settled()
        if not window.bench.document.project.moves:
            yield from self._look_from_above(patch.wrong)
            yield from self._approach(patch)
        else:
            self._screen = self._in_map
            yield from self._approach(patch)
        self._press("lasso")
        yield "the lasso", lambda: window.bench.select_tools.tool == "lasso"
        xdotool(*dragging(*self._around(patch)))
        yield (
            "the selection",
            lambda: window.bench.selection.count > 0 and not pressed() and window.is_settled(),
        )

    def move(self, layer: int) -> Steps:
        """Drag the selection onto the row of the other layer, and let go once that says what would happen."""
        selection, model = self._window.bench.selection, self._window.bench.layers.model
        assert selection.mask is not None
        assert selection.result is not None
        chosen = np.flatnonzero(selection.mask)
        x0, y0, x1, y1, *_ = selection.result.field.boxes(chosen[len(chosen) // 2 :][:1])[0]
        xdotool(*carrying(self._screen((x0 + x1) / 2, (y0 + y1) / 2), self._row(layer)))
        row = model.index(model.row_of(layer))
        yield "the row to say what would happen", lambda: row.data(Role.ROW).notice not in (None, COUNTING)
        said = self._report.setdefault("said", [])
        assert isinstance(said, list)
        said.append(row.data(Role.ROW).notice.text)
        xdotool("mouseup", 1)

    def undo(self) -> None:
        """Press the button."""
        self._press("undo")

    def redo(self) -> None:
        """Press the button."""
        self._press("redo")

    def change_cell_size(self) -> Steps:
        """Drag the slider a little."""
        slider, stack = self._window.bench.parameters.cell_size.slider, self._window.bench.document.undo_stack
        share, before = slider.value() / slider.maximum(), stack.count()
        xdotool(*dragging(at(slider, share, 0.5), at(slider, share + 0.03, 0.5)))
        yield "another cell size", lambda: stack.count() > before and not pressed()

    # --- Where things are -----------------------------------------------------------------------------------

    def _look_from_above(self, layer: int) -> Steps:
        """Make the pillars' view large, look straight down, and show a layer alone."""
        window = self._window
        xdotool(*clicking(at(window.bench.trio.headers[PILLARS], 0.1, 0.5)), "click", 1)
        yield "one large view", lambda: window.bench.trio.shown == (PILLARS,) and window.is_settled()
        viewpoint = window.bench.trio.viewpoint
        self._press("parallel")
        yield "parallel projection", lambda: viewpoint.camera.parallel
        self._press("top")
        yield "the view from above", lambda: viewpoint.camera.elevation > 89
        view, model = window.bench.layers.view, window.bench.layers.model
        room = RowLayout(view.visualRect(model.index(model.row_of(layer))))
        xdotool(*clicking(on_screen(view.viewport(), *room.solo().center().toTuple())))
        yield (
            "the layer alone",
            lambda: window.bench.layers.visible_layers() == (layer,) and window.is_settled(),
        )

    def _approach(self, patch: Patch) -> Steps:
        """Zoom to a patch with the wheel until compartments are large enough."""
        middle = (patch.west + patch.east) / 2, (patch.south + patch.north) / 2
        while (before := self._fineness()) < FINE:
            xdotool("mousemove", *self._screen(*middle), "click", 4)
            yield "the zoom", lambda before=before: self._fineness() > before and self._window.is_settled()  # type: ignore[misc]

    def _fineness(self) -> float:
        """Return how many pixels a compartment is wide."""
        answer = self._window.bench.document.answer
        assert answer is not None
        cell_size = answer.result.parameters.cell_size
        assert isinstance(cell_size, float)
        (x0, _), (x1, _) = self._screen(0, 0), self._screen(100 * cell_size, 0)
        return (x1 - x0) / 100

    def _around(self, patch: Patch) -> list[Place]:
        corners = [
            (patch.west, patch.south),
            (patch.east, patch.south),
            (patch.east, patch.north),
            (patch.west, patch.north),
            (patch.west, patch.south),
        ]
        return [self._screen(*corner) for corner in corners]

    def _in_view(self, x: float, y: float) -> Place:
        """Return where a place of the plan is in the large view."""
        canvas, origin = self._window.bench.trio.canvases[PILLARS], self._window.bench.feeds.scene.origin
        return on_screen(canvas, *canvas.pixel_of((x - origin[0], y - origin[1], 0.0)).toTuple())

    def _in_map(self, x: float, y: float) -> Place:
        plot = self._window.bench.map.plot
        return on_screen(plot.viewport(), *plot.pixel_of(x, y).toTuple())

    def _row(self, layer: int) -> Place:
        view, model = self._window.bench.layers.view, self._window.bench.layers.model
        room = RowLayout(view.visualRect(model.index(model.row_of(layer))))
        place: QPoint = room.name().center()
        return on_screen(view.viewport(), place.x(), place.y())

    def _press(self, name: str) -> None:
        """Click the button of an action."""
        action: QAction = self._window.commands[name]
        bars = self._window.findChildren(QToolBar, options=Qt.FindChildOption.FindDirectChildrenOnly)
        button = next(button for bar in bars if (button := bar.widgetForAction(action)) is not None)
        xdotool(*clicking(at(button, 0.5, 0.5)))

    def _button(self, within: QWidget, text: str) -> QPushButton:
        buttons = within.findChildren(QPushButton)
        return next(button for button in buttons if button.text().replace("&", "") == text)
