"""A correction from opening to export, whatever hand does it; ``drive_correction`` has the two hands."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from PySide6.QtWidgets import QApplication
from tests.e2e.driving import Steps, picture, write_report

from stepfield_app.main_window import MainWindow


@dataclass(frozen=True)
class Patch:
    """A part of the plan where a layer holds what belongs to another one; scan coordinates, metres."""

    west: float
    south: float
    east: float
    north: float
    wrong: int
    right: int


#: In room_scan1: half a table top that went to the floor, and the edge of the ceiling that went to the walls.
TABLE_TOP = Patch(0.40, 1.81, 0.90, 2.01, wrong=0, right=1)
CEILING = Patch(0.90, -1.89, 3.30, -1.59, wrong=2, right=3)


class Hand(Protocol):
    """Whatever works the window."""

    def open(self, file: Path) -> Steps:
        """Open a file in the empty window."""

    def select(self, patch: Patch) -> Steps:
        """Select the pillars of the wrong layer over a patch."""

    def move(self, layer: int) -> Steps:
        """Begin to move the selection to a layer."""

    def undo(self) -> None:
        """Take the last step back."""

    def redo(self) -> None:
        """Take it again."""

    def change_cell_size(self) -> Steps:
        """Choose another cell size."""

    def save(self, file: Path) -> Steps:
        """Save the project; to a file, if it has none yet."""

    def recover(self) -> Steps:
        """Accept the edits that are offered."""

    def export(self) -> Steps:
        """Export, and report where the stack is."""

    def leave(self) -> Steps:
        """Close the window."""


def correct(hand: Hand, window: MainWindow, file: Path, folder: Path, report: dict[str, Any]) -> Steps:
    """Put pillars right, save, go on, and wait to be killed."""
    document, project = window.bench.document, folder / "room.stepfield"
    yield "the window to appear", lambda: window.isVisible() and QApplication.activeWindow() is window
    yield from hand.open(file)
    yield "the scan", lambda: document.answer is not None and window.is_settled()
    yield from seen(window, folder, "opened")
    as_opened = layers(window)
    yield from hand.select(TABLE_TOP)
    report["selected"] = selected(window, TABLE_TOP)
    yield from seen(window, folder, "selected")
    yield from moved(hand, window, TABLE_TOP, 1)
    corrected = layers(window)
    report["moved"] = int(np.count_nonzero(corrected != as_opened))
    yield from seen(window, folder, "moved")
    hand.undo()
    yield "undo", lambda: not document.project.moves and window.is_settled()
    report["undone"] = np.array_equal(layers(window), as_opened)
    hand.redo()
    yield "redo", lambda: len(document.project.moves) == 1 and window.is_settled()
    report["redone"] = np.array_equal(layers(window), corrected)
    cell_size = document.answer.result.parameters.cell_size  # type: ignore[union-attr]
    yield from hand.change_cell_size()
    yield "the new cell size", window.is_settled
    report["cell sizes"] = cell_size, document.answer.result.parameters.cell_size  # type: ignore[union-attr]
    yield from hand.save(project)
    yield "the saved project", lambda: not document.file.dirty and window.is_settled()
    yield from hand.select(CEILING)
    report["selected then"] = selected(window, CEILING)
    yield from moved(hand, window, CEILING, 2)
    yield from seen(window, folder, "corrected")
    recovery = window.filing.recovery
    yield "the draft", lambda: recovery is not None and not recovery.busy
    write_report(report, folder / "ready.json")
    yield "being killed", lambda: False


def recover(hand: Hand, window: MainWindow, folder: Path, report: dict[str, Any]) -> Steps:
    """Accept what the killed window has left, save it, and export it."""
    document, bar = window.bench.document, window.message_bar
    yield "the offer", lambda: window.isVisible() and bool(bar.messages)
    report["offers"] = [message.sentence for message in bar.messages]
    yield from seen(window, folder, "offered")
    yield from hand.recover()
    yield "the edits", lambda: document.answer is not None and window.is_settled()
    report["recovered"] = len(document.project.moves)
    report["dirty"] = document.file.dirty
    yield from hand.save(folder / "room.stepfield")
    yield "the saved project", lambda: not document.file.dirty and window.is_settled()
    yield from hand.export()
    report["messages left"] = [message.sentence for message in bar.messages]
    yield from hand.leave()
    yield "the window to close", lambda: not window.isVisible()


def moved(hand: Hand, window: MainWindow, patch: Patch, moves: int) -> Steps:
    """Move the selection; wait for the edit and for the pictures of it."""
    yield from hand.move(patch.right)
    yield "the move", lambda: len(window.bench.document.project.moves) == moves and window.is_settled()


def seen(window: MainWindow, folder: Path, name: str) -> Steps:
    """Save what the window shows; hidden views are laid out for it, and draw anew."""
    picture(window, folder, name)
    yield "the window to settle again", window.is_settled


def layers(window: MainWindow) -> NDArray[np.int64]:
    """Return the layer of every pillar."""
    assert window.bench.document.answer is not None
    return window.bench.document.answer.result.layering.layer.copy()


def selected(window: MainWindow, patch: Patch) -> list[int]:
    """Count what is selected: of the wrong layer, and in all."""
    return [window.bench.selection.by_layer.get(patch.wrong, 0), window.bench.selection.count]
