"""Saying where the scans of a project are that are not where they were."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QGridLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from stepfield.formats import FORMATS
from stepfield_app.appearance import icon
from stepfield_app.filed import Work
from stepfield_app.opening import Missing
from stepfield_app.wording import counted

#: Width of the dialog, and room between two scans.
_WIDTH, _GAP = 640, 8


class MissingScans(QDialog):
    """Lists the scans that are missing; the project opens once each has a place.

    Parameters
    ----------
    missing : Missing
    found : callable
        Called with the Work when every scan has a place.
    parent : QWidget
    """

    def __init__(self, missing: Missing, found: Callable[[Work], object], parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle("Where are the scans?")
        self.setMinimumWidth(_WIDTH)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._missing, self._found = missing, found
        self.places = dict(missing.beside())
        self._labels = {path: QLabel() for path in missing.paths}
        self._buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.open_button = self._buttons.addButton("&Open", QDialogButtonBox.ButtonRole.AcceptRole)
        self.open_button.setToolTip("Open the project with the scans from here")
        leave = self._buttons.button(QDialogButtonBox.StandardButton.Cancel)
        leave.setToolTip("Open nothing (Esc)")
        self._buttons.accepted.connect(self.accept)
        self._buttons.rejected.connect(self.reject)
        self.accepted.connect(self._tell)
        self._arrange()
        self._show_places()

    def locate(self, path: Path) -> None:
        """Let the operator choose where one of them is; others of its folder are then found as well."""
        start = self.places.get(path, path).parent
        kinds = " ".join(f"*{suffix}" for suffix in FORMATS)
        name, _ = QFileDialog.getOpenFileName(
            self, f"Where is {path.name}?", str(start if start.is_dir() else Path.home()), f"Scans ({kinds})"
        )
        if name:
            self.place(path, Path(name))

    def place(self, path: Path, there: Path) -> None:
        """Say where one of them is."""
        self.places[path] = there
        for other in self._missing.paths:
            if other not in self.places and (there.parent / other.name).is_file():
                self.places[other] = there.parent / other.name
        self._show_places()

    def _tell(self) -> None:
        self._found(self._missing.found(self.places))

    def _show_places(self) -> None:
        for path, label in self._labels.items():
            there = self.places.get(path)
            label.setText(f"now {there}" if there else f"was {os.path.normpath(path)}")
            label.setProperty("role", "muted" if there else "warning")
            label.style().polish(label)
        self.open_button.setEnabled(len(self.places) == len(self._missing.paths))
        self.open_button.setDefault(True)

    def _arrange(self) -> None:
        stored, missing = self._missing.work.stored, self._missing.paths
        name = stored.path.name if stored else "The project"
        scans = "A scan is" if len(missing) == 1 else f"{counted(len(missing), 'scan')} are"
        sentence = QLabel(f"{scans} not where {name} says. Show where to find what is missing.")
        sentence.setWordWrap(True)
        rows = QGridLayout()
        rows.setHorizontalSpacing(16)
        rows.setVerticalSpacing(2)
        for number, path in enumerate(missing):
            self._add(rows, 3 * number, path)
            rows.setRowMinimumHeight(3 * number + 2, _GAP)
        rows.setColumnStretch(0, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(16, 16, 16, 16)
        layout.setSpacing(16)
        layout.addWidget(sentence)
        layout.addLayout(rows)
        layout.addStretch(1)
        layout.addWidget(self._buttons)

    def _add(self, rows: QGridLayout, row: int, path: Path) -> None:
        locate = QPushButton(icon("search"), "Locate…")
        locate.setToolTip(f"Choose the file that is {path.name}")
        locate.setAccessibleName(f"Locate {path.name}")
        locate.setAutoDefault(False)
        locate.clicked.connect(partial(self.locate, path))
        label = self._labels[path]
        label.setTextFormat(Qt.TextFormat.PlainText)
        label.setWordWrap(True)
        rows.addWidget(QLabel(path.name), row, 0)
        rows.addWidget(label, row + 1, 0)
        rows.addWidget(locate, row, 1, 2, 1, Qt.AlignmentFlag.AlignVCenter)
