"""The LAS classes of a scan by checkbox, each with its number of points."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QCheckBox, QGridLayout, QLabel, QWidget

from stepfield_app.controls import named
from stepfield_app.document import Document
from stepfield_app.facts import ScanFacts
from stepfield_app.panels.page import GRID, column, muted
from stepfield_app.scenes.classes import class_name
from stepfield_app.wording import grouped

RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter


class ClassesGroup(QWidget):
    """One checkbox a class; all of them checked is no filter.

    Parameters
    ----------
    document : Document
    """

    def __init__(self, document: Document) -> None:
        super().__init__()
        self._document = document
        self.checks: dict[int, QCheckBox] = {}
        self._none = muted("This scan has no classes.")
        self._table: QWidget | None = None
        self._layout = column(margin=0)
        self._layout.addWidget(self._none)
        self.setLayout(self._layout)

    def adapt(self, facts: ScanFacts) -> None:
        """Offer the classes of another scan."""
        if self._table is not None:
            self._table.deleteLater()
        self._table = QWidget()
        grid = QGridLayout(self._table)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setVerticalSpacing(GRID // 2)
        grid.setColumnStretch(0, 1)
        self.checks = {code: self._check(code) for code in facts.classes}
        for row, (code, points) in enumerate(facts.classes.items()):
            grid.addWidget(self.checks[code], row, 0)
            grid.addWidget(QLabel(grouped(points), alignment=RIGHT), row, 1)
        self._layout.addWidget(self._table)
        self._none.setVisible(not self.checks)

    def _check(self, code: int) -> QCheckBox:
        text = f"{code}  {class_name(code)}"
        check = named(QCheckBox(text), text, f"Keep the points of class {code}")
        check.clicked.connect(lambda: self._choose(code))
        return check

    def show_value(self) -> None:
        """Show what the document says."""
        kept = self._document.project.parameters.classes
        for code, check in self.checks.items():
            check.setChecked(kept is None or code in kept)

    def _choose(self, code: int) -> None:
        kept = [each for each, check in self.checks.items() if check.isChecked()]
        if not kept:  # without any class there is no scan
            self.show_value()
            return
        verb = "Keep" if code in kept else "Drop"
        all_kept = len(kept) == len(self.checks)
        self._document.set_parameters(
            f"{verb} class {code} {class_name(code)}", classes=None if all_kept else tuple(kept)
        )
