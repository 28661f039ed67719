"""Cleaning: unit and up axis, crop box, classes, outliers. Nothing is dropped until it is asked for."""

from __future__ import annotations

from typing import Any, get_args

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QComboBox, QFormLayout, QVBoxLayout, QWidget

from stepfield.parameters import Parameters, Unit, Up
from stepfield.project import Project
from stepfield_app.controls import named, shrinkable
from stepfield_app.document import Document
from stepfield_app.facts import ScanFacts
from stepfield_app.panels.classes import ClassesGroup
from stepfield_app.panels.crop import CropGroup
from stepfield_app.panels.hand import WheelGuard
from stepfield_app.panels.outliers import OutliersGroup
from stepfield_app.panels.page import GRID, Page, column, heading, muted
from stepfield_app.wording import advice, counted, grouped

EMPTY = "Crop box, classes and outliers of a scan are chosen here. Open a scan to begin (Ctrl+O)."
UNITS = {"m": "metres", "cm": "centimetres", "mm": "millimetres", "ft": "feet", "us-ft": "US survey feet"}
REASONS = {"crop": "outside the crop box", "classes": "of other classes", "outliers": "outliers"}


class CleaningPanel(QWidget):
    """What of the scan is used, and how its coordinates are read.

    Parameters
    ----------
    document : Document
    parent : QWidget, optional
    """

    crop_tool_requested = Signal(bool)
    preview_requested = Signal(str)  # outliers of a mode to count and show; "off" ends that

    def __init__(self, document: Document, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._document = document
        self._project = document.project
        self._shown: tuple[Any, ...] = ()
        guard = WheelGuard(self)
        self.unit = named(shrinkable(QComboBox()), "Unit", "Unit of the scan's coordinates")
        self.up = named(shrinkable(QComboBox()), "Up axis", "The scan's axis that points up")
        guard.guard(self.unit, self.up)
        self.crop = CropGroup(document, guard)
        self.classes = ClassesGroup(document)
        self.outliers = OutliersGroup(document, guard)
        self.removed, self.advice = muted(), muted()
        self._fill_choices()
        self._page = Page(self._content(), EMPTY)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._page)
        self._connect()
        self._adapt(document.facts)

    def show_outlier_count(self, dropped: int | None, points: int = 0) -> None:
        """Say how many points the previewed filter would drop; None while they are counted."""
        self.outliers.set_count(dropped, points)

    def set_crop_tool(self, is_on: bool) -> None:
        """Show whether the crop box has its handles in the views."""
        self.crop.tool.setChecked(is_on)

    def _fill_choices(self) -> None:
        self.unit.addItem("auto", "auto")
        for unit in get_args(Unit):
            self.unit.addItem(UNITS[unit], unit)
        for up in get_args(Up):
            self.up.addItem(f"{up.replace('-', '−')} is up", up)

    def _content(self) -> QWidget:
        form = QFormLayout()
        form.setHorizontalSpacing(2 * GRID)
        form.setVerticalSpacing(GRID)
        form.addRow("Unit", self.unit)
        form.addRow("Up axis", self.up)
        layout = column()
        layout.addWidget(heading("Coordinates"))
        layout.addLayout(form)
        layout.addWidget(self.advice)
        for title, group in (("Crop", self.crop), ("Classes", self.classes), ("Outliers", self.outliers)):
            layout.addWidget(heading(title))
            layout.addWidget(group)
        layout.addWidget(heading("Points"))
        layout.addWidget(self.removed)
        layout.addStretch(1)
        content = QWidget()
        content.setLayout(layout)
        return content

    def _connect(self) -> None:
        self.unit.activated.connect(
            lambda: self._document.set_parameters(
                f"Unit {self.unit.currentText()}", unit=self.unit.currentData(), crop=None
            )
        )
        self.up.activated.connect(
            lambda: self._document.set_parameters(self.up.currentText(), up=self.up.currentData(), crop=None)
        )
        self.crop.tool_requested.connect(self.crop_tool_requested)
        self.outliers.preview_requested.connect(self.preview_requested)
        self._document.project_changed.connect(self._follow)
        self._document.answer_changed.connect(self._count)
        self._document.facts_changed.connect(self._adapt)

    def _adapt(self, facts: ScanFacts | None) -> None:
        """Offer what another scan holds."""
        self._page.set_filled(facts is not None)
        self.crop.forget()
        if facts is not None:
            self.classes.adapt(facts)
            is_auto = self._document.project.parameters.unit == "auto"
            self.unit.setItemText(0, f"auto: {UNITS[facts.unit]}" if is_auto else "auto")
            self.advice.setText("\n".join(map(advice, facts.scan.warnings)))
            self.advice.setVisible(bool(facts.scan.warnings))
        self._show()

    def _follow(self, project: Project) -> None:
        """Show what has changed; all of a project that has not, for a control may show what was refused."""
        if project is self._project or _cleaning(project.parameters) != self._shown or self._looks:
            self._show()
        self._project = project

    @property
    def _looks(self) -> bool:
        """Whether outliers are looked at: any edit ends that."""
        return self.outliers.preview.isChecked()

    def _show(self) -> None:
        """Show what the document says."""
        self._shown = _cleaning(self._document.project.parameters)
        chosen: Parameters = self._document.project.parameters
        self.unit.setCurrentIndex(self.unit.findData(chosen.unit))
        self.up.setCurrentIndex(self.up.findData(chosen.up))
        for group in (self.crop, self.classes, self.outliers):
            group.show_value()
        self._count()

    def _count(self, _: object = None) -> None:
        """Say how many points are used, and why others are not."""
        answer, facts = self._document.answer, self._document.facts
        if answer is None or facts is None:
            return
        scan = answer.result.scan
        lines = [f"{grouped(len(scan))} of {counted(facts.points, 'point')} used"]
        lines += [f"{grouped(n)} {REASONS.get(why, why)}" for why, n in scan.removed.items() if n]
        self.removed.setText("\n".join(lines))


def _cleaning(chosen: Parameters) -> tuple[Any, ...]:
    """Return what of the parameters is shown here."""
    return chosen.unit, chosen.up, chosen.crop, chosen.classes, chosen.outliers
