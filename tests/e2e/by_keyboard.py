"""The window worked by keyboard alone."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import QApplication
from tests.e2e.correction import Patch
from tests.e2e.driving import Steps, dialog, typing, xdotool

from stepfield.grid import Grid
from stepfield_app.main_window import MainWindow
from stepfield_app.tools.cell_cursor import FAR, CellCursor, MapSelectingTool


class Keyboard:
    """Types names of files, walks over the map with arrows, moves with digits, goes to controls by letters.

    Parameters
    ----------
    window : MainWindow
    report : dict
        Takes where the stack is.
    """

    def __init__(self, window: MainWindow, report: dict[str, object]) -> None:
        self._window, self._report = window, report

    # --- Files ----------------------------------------------------------------------------------------------

    def open(self, file: Path) -> Steps:
        """Type the name of the file into the dialog."""
        yield from self._answer_dialog("ctrl+o", file)

    def save(self, file: Path) -> Steps:
        """Save; the dialog comes the first time."""
        if self._window.bench.document.file.stored is None:
            yield from self._answer_dialog("ctrl+s", file)
        else:
            xdotool(*typing("ctrl+s"))
            yield "saving", lambda: not self._window.bench.document.file.dirty

    def recover(self) -> Steps:
        """Press the letter of the offer."""
        xdotool(*typing("alt+r"))
        yield "the offer to be taken", lambda: not self._window.message_bar.messages

    def export(self) -> Steps:
        """Type a folder into the dialog."""
        folder = Path.home() / "typed"
        self._report["stack"] = str(folder)
        xdotool(*typing("ctrl+e"))
        yield "the dialog", lambda: _is_active("ExportDialog")
        exporting = dialog("ExportDialog")
        xdotool(*typing("alt+f", "ctrl+a"), "type", "--delay", 5, folder)
        yield "the folder", lambda: exporting.folder_choice.folder == folder
        yield "the preview", exporting.export_button.isEnabled
        xdotool(*typing("alt+e"))
        yield "the stack", exporting.show_button.isVisible
        xdotool(*typing("Escape"))
        yield "the dialog to go", lambda: dialog("ExportDialog") is None

    def leave(self) -> Steps:
        """Quit."""
        yield "the window to have the keyboard", lambda: QApplication.activeWindow() is self._window
        xdotool(*typing("ctrl+q"))

    # --- Editing --------------------------------------------------------------------------------------------

    def select(self, patch: Patch) -> Steps:
        """Walk to the patch in the map, draw a rectangle over it, and take it."""
        window = self._window
        yield from self._activate(patch.wrong)
        xdotool(*typing("m"))
        yield (
            "the map",
            lambda: window.bench.map.plot.hasFocus() and window.bench.select_tools.tool == "rectangle",
        )
        yield "the map of the layer", lambda: window.bench.map.layer == patch.wrong and window.is_settled()
        xdotool(*typing("Right"))
        yield "the cursor", lambda: self._cursor() is not None
        grid = self._grid()
        (first, top), (last, bottom) = _cells(patch, grid)
        yield from self._walk(first, top, "")
        yield from self._walk(last, bottom, "shift+")
        xdotool(*typing("Return"))
        yield "the selection", lambda: window.bench.selection.count > 0 and window.is_settled()

    def move(self, layer: int) -> Steps:
        """Press the digit of the layer."""
        xdotool(*typing(str(layer + 1)))
        yield from ()

    def undo(self) -> None:
        """Press the key."""
        xdotool(*typing("ctrl+z"))

    def redo(self) -> None:
        """Press the key."""
        xdotool(*typing("ctrl+shift+z"))

    def change_cell_size(self) -> Steps:
        """Go to the box by its letter, and type."""
        box, stack = self._window.bench.parameters.cell_size.box, self._window.bench.document.undo_stack
        before = stack.count()
        xdotool(*typing("alt+c"))
        yield "the box", box.hasFocus
        xdotool(*typing("ctrl+a"), "type", "--delay", 15, "9 cm")
        yield "the text", lambda: box.lineEdit().text() == "9 cm"
        xdotool(*typing("Return", "Tab"))
        yield "another cell size", lambda: stack.count() > before and not box.hasFocus()

    def _activate(self, layer: int) -> Steps:
        """Go up or down through the layers."""
        document = self._window.bench.document
        way = layer - document.active_layer
        if way:
            xdotool(*typing(*(["ctrl+Prior"] * way + ["ctrl+Next"] * -way)))
        yield "the layer", lambda: document.active_layer == layer

    # --- Ways -----------------------------------------------------------------------------------------------

    def _answer_dialog(self, keys: str, file: Path) -> Steps:
        """Open a dialog for files, and type a name into it."""
        xdotool(*typing(keys))
        yield "the dialog", lambda: _is_active("QFileDialog")
        choosing = dialog("QFileDialog")
        xdotool("type", "--delay", 5, file)
        yield "the name", lambda: choosing.selectedFiles() == [str(file)]
        xdotool(*typing("Return"))
        yield "the dialog to go", lambda: dialog("QFileDialog") is None

    def _walk(self, column: int, row: int, keys: str) -> Steps:
        """Take the cursor to a compartment."""
        cursor = self._cursor()
        assert cursor is not None
        right, down = column - cursor.column, row - cursor.row
        steps = _steps(right, "Right", "Left", keys) + _steps(down, "Down", "Up", keys)
        if steps:
            xdotool(*typing(*steps))
        yield f"the cursor to arrive at {column, row} from {cursor}", lambda: self._is_at(column, row)

    def _is_at(self, column: int, row: int) -> bool:
        cursor = self._cursor()
        return cursor is not None and (cursor.column, cursor.row) == (column, row)

    def _cursor(self) -> CellCursor | None:
        tool = self._window.bench.map.plot.grip.tool
        return tool.cursor if isinstance(tool, MapSelectingTool) else None

    def _grid(self) -> Grid:
        assert self._window.bench.document.answer is not None
        return self._window.bench.document.answer.result.field.compartments.grid


def _is_active(name: str) -> bool:
    """Whether a dialog is open and has the keyboard."""
    open_ = dialog(name)
    return open_ is not None and QApplication.activeWindow() is open_


def _cells(patch: Patch, grid: Grid) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return column and row of the first and the last compartment whose middle lies over a patch."""
    first, last = (round((x - grid.west) / grid.cell_size) for x in (patch.west, patch.east))
    upper, lower = (grid.rows - round((y - grid.south) / grid.cell_size) for y in (patch.north, patch.south))
    return (first, upper), (last - 1, max(upper, lower - 1))


def _steps(way: int, forwards: str, backwards: str, keys: str) -> list[str]:
    """Return the keys that go so many compartments: tens with Ctrl, then ones."""
    tens, ones = divmod(abs(way), FAR)
    key = forwards if way > 0 else backwards
    return [f"ctrl+{keys}{key}"] * tens + [f"{keys}{key}"] * ones
