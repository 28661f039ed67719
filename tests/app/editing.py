"""A document with layers, a selection and an editor, without any view."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pytestqt.qtbot import QtBot

from stepfield.parameters import Parameters
from stepfield.reconstruction import Reconstruction
from stepfield_app.document import Document
from stepfield_app.editor import Editor
from stepfield_app.selection import Selection

#: West, south, east, north and elevation of the scan's planes, metres: a floor with two tables and a shelf.
PLANES = ((0, 0, 6, 4, 10.0), (1, 1, 3, 3, 10.8), (4, 1, 5, 3, 11.6), (1, 1, 2, 3, 12.5))
#: Points of a plane, a square metre.
DENSITY = 1000


def scan_of_planes(folder: Path) -> Path:
    """Write a scan of planes, and return its path."""
    rng = np.random.default_rng(7)
    planes = []
    for west, south, east, north, elevation in PLANES:
        count = DENSITY * (east - west) * (north - south)
        places = rng.uniform((west, south), (east, north), (int(count), 2))
        planes.append(np.column_stack([places, np.full(len(places), elevation)]))
    path = folder / "planes.npy"
    np.save(path, np.vstack(planes))
    return path


class Desk:
    """What is needed to edit, with the sentences that the editor told."""

    def __init__(self, qtbot: QtBot) -> None:
        self._qtbot = qtbot
        self.document = Document()
        self.selection = Selection(self.document)
        self.editor = Editor(self.document, self.selection)
        self.told: list[str] = []
        self.editor.told.connect(self.told.append)

    def open(self, folder: Path) -> None:
        """Open the scan of planes: three layers."""
        parameters = Parameters(cell_size=0.2, layer_tolerance=0.3, alpha=0.5)
        with self._qtbot.waitSignal(self.document.opened):
            self.document.open([scan_of_planes(folder)], parameters)
        self.settle()

    @property
    def result(self) -> Reconstruction:
        """What is shown."""
        assert self.document.answer is not None
        return self.document.answer.result

    @property
    def counts(self) -> list[int]:
        """Pillars of each layer, the lowest first."""
        return [len(layer.pillars) for layer in self.result.layers]

    @property
    def steps(self) -> list[str]:
        """Names of the undo steps."""
        stack = self.document.undo_stack
        return [stack.text(at) for at in range(stack.count())]

    def settle(self) -> None:
        """Wait until nothing is being made."""
        self._qtbot.waitUntil(self._is_settled)

    def select(self, layer: int, count: int) -> None:
        """Select the first pillars of a layer."""
        mask = np.zeros(len(self.result.field), bool)
        mask[np.flatnonzero(self.result.layering.layer == layer)[:count]] = True
        self.selection.set(mask)
        self.settle()

    def undo(self) -> None:
        """Undo a step."""
        self.document.undo_stack.undo()
        self.settle()

    def close(self) -> None:
        """End every worker."""
        self.editor.close()
        self.selection.close()
        self.document.close()

    def _is_settled(self) -> bool:
        document, selection = self.document, self.selection
        is_made = not (document.busy or document.pending or selection.busy)
        return is_made and self.editor.is_idle
