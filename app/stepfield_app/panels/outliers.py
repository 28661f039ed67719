"""Outliers: which kind to drop, looked at and counted before it is done."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QPushButton, QWidget

from stepfield_app.controls import named, shrinkable
from stepfield_app.document import Document
from stepfield_app.panels.hand import WheelGuard
from stepfield_app.panels.page import column, muted
from stepfield_app.wording import counted, grouped

OFF = "off"
MODES = (
    ("Off", OFF),
    ("Sparse: too few neighbours", "radius"),
    ("Isolated: groups of up to three", "isolated"),
)


class OutliersGroup(QWidget):
    """Choose a kind, preview what it would drop, apply it.

    Parameters
    ----------
    document : Document
    guard : WheelGuard
    """

    preview_requested = Signal(str)  # a mode; "off" ends the preview

    def __init__(self, document: Document, guard: WheelGuard) -> None:
        super().__init__()
        self._document = document
        self.mode = named(shrinkable(QComboBox()), "Outliers", "Which stray points to drop: birds, dust")
        for text, mode in MODES:
            self.mode.addItem(text, mode)
        guard.guard(self.mode)
        self.preview = named(
            QPushButton("Preview"), "Preview outliers", "Show and count what would be dropped"
        )
        self.preview.setCheckable(True)
        self.apply = named(
            QPushButton("Apply"), "Apply the outlier filter", "Drop these points; can be undone"
        )
        self.count = muted()
        self._lay_out()
        self.mode.activated.connect(self._turn_to)
        self.preview.toggled.connect(self._look)
        self.apply.clicked.connect(self._drop)
        self._enable()

    def _lay_out(self) -> None:
        buttons = QHBoxLayout()
        buttons.addWidget(self.preview)
        buttons.addWidget(self.apply)
        buttons.addStretch(1)
        layout = column(margin=0)
        layout.addWidget(self.mode)
        layout.addLayout(buttons)
        layout.addWidget(self.count)
        self.setLayout(layout)

    def show_value(self) -> None:
        """Show what the document says."""
        self.preview.setChecked(False)
        self.mode.setCurrentIndex(self.mode.findData(self._applied()))
        self._enable()

    def set_count(self, dropped: int | None, points: int = 0) -> None:
        """Say how many points the preview would drop; None while they are being counted."""
        if dropped is None:
            self.count.setText("Counting…")
        else:
            share = 100 * dropped / points if points else 0.0
            self.count.setText(f"{counted(dropped, 'point')} of {grouped(points)} would go ({share:.2g} %)")

    def _applied(self) -> str:
        return self._document.project.parameters.outliers

    def _turn_to(self) -> None:
        self.preview.setChecked(False)
        self._enable()

    def _enable(self) -> None:
        is_new = self.mode.currentData() != self._applied()
        self.preview.setEnabled(is_new and self.mode.currentData() != OFF)
        self.apply.setEnabled(is_new)

    def _look(self, is_on: bool) -> None:
        self.count.clear()
        if is_on:
            self.set_count(None)
        self.preview_requested.emit(self.mode.currentData() if is_on else OFF)

    def _drop(self) -> None:
        mode = self.mode.currentData()
        self._document.set_parameters(
            "Keep outliers" if mode == OFF else f"Drop {mode} outliers", outliers=mode
        )
