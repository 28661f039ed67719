"""Rows of the parameters panel: a length with slider, box and auto; a choice; a number of things."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import QObject, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QComboBox, QGridLayout, QLabel, QSpinBox, QToolButton, QWidget

from stepfield.parameters import Parameters
from stepfield_app.controls import named, shrinkable
from stepfield_app.document import Document
from stepfield_app.panels.hand import Hand, WheelGuard
from stepfield_app.panels.lengths import LengthBox, LengthSlider, Range, written

#: Width of a box, so that its text can change without moving anything.
BOX_WIDTH = 88
#: Width of the names, the same in every group of rows.
LABEL_WIDTH = 80


@dataclass(frozen=True)
class Described:
    """A parameter as the panel presents it; with Alt, the letter takes the keyboard there."""

    name: str
    title: str
    help: str
    letter: str = ""


def label_of(described: Described, control: QWidget) -> QLabel:
    """Return the label in front of a control."""
    title, letter = described.title, described.letter
    label = QLabel(title.replace(letter, f"&{letter}", 1) if letter else title)
    label.setToolTip(described.help)
    label.setBuddy(control)
    label.setMinimumWidth(LABEL_WIDTH)
    return label


class LengthRow(QObject):
    """A length: slider, box with unit, and a button that leaves the choice to the scan."""

    def __init__(self, described: Described, document: Document, parent: QObject) -> None:
        super().__init__(parent)
        self._described, self._document = described, document
        self._hand = Hand(document, self)
        title = described.title
        self.slider = named(LengthSlider(), f"{title}, slider", described.help)
        self.box = named(LengthBox(), title, described.help)
        self.auto = named(
            QToolButton(), f"{title}, auto", f"Pick the {title.lower()} from the scan, and follow it"
        )
        self.label = label_of(described, self.box)
        self.auto.setText("auto")
        self.auto.setCheckable(True)
        self.box.setFixedWidth(BOX_WIDTH)
        self._connect()

    def _connect(self) -> None:
        self.slider.sliderPressed.connect(self._hand.press)
        self.slider.sliderReleased.connect(self._hand.release)
        self.slider.chosen.connect(self._choose)
        self.box.chosen.connect(self._choose)
        self.auto.clicked.connect(self._set_auto)

    def place(self, grid: QGridLayout, row: int) -> None:
        """Put the controls into a grid: the slider below, as long as the panel is wide."""
        for place, control in ((0, self.label), (2, self.box), (3, self.auto)):
            grid.addWidget(control, row, place)
        grid.addWidget(self.slider, row + 1, 0, 1, 4)

    def guard(self, guard: WheelGuard) -> None:
        """Keep the wheel from what has no focus."""
        guard.guard(self.slider, self.box)

    def set_range(self, lengths: Range) -> None:
        """Offer the lengths that suit the scan."""
        self.slider.set_lengths(lengths)
        self.box.set_unit(lengths.unit)

    def value_of(self, chosen: Parameters, picked: Parameters | None) -> Any:
        """Return all that it shows of these."""
        value = getattr(chosen, self._described.name)
        return value, value == "auto" and picked and getattr(picked, self._described.name)

    def show_value(self, chosen: Parameters, picked: Parameters | None) -> None:
        """Show what was chosen; for auto, what was picked from the scan."""
        value = getattr(chosen, self._described.name)
        self.auto.setChecked(value == "auto")
        if value == "auto":
            value = getattr(picked, self._described.name) if picked else "auto"
        if value != "auto":
            self.slider.show_length(value)
            self.box.show_length(value)

    def _choose(self, length: float) -> None:
        gesture = self._hand.touch()
        text = f"{self._described.title} {written(length)}"
        self._document.set_parameters(text, gesture, **{self._described.name: length})

    def _set_auto(self, is_auto: bool) -> None:
        self._hand.release()
        value = "auto" if is_auto else self.box.value()
        text = f"{self._described.title} {'auto' if is_auto else written(self.box.value())}"
        self._document.set_parameters(text, **{self._described.name: value})


class ChoiceRow(QObject):
    """One of a few values."""

    def __init__(
        self, described: Described, options: Sequence[tuple[str, Any]], document: Document, parent: QObject
    ) -> None:
        super().__init__(parent)
        self._described, self._document = described, document
        self.box = named(shrinkable(QComboBox()), described.title, described.help)
        self.label = label_of(described, self.box)
        for text, value in options:
            self.box.addItem(text, value)
        self.box.activated.connect(self._choose)

    def place(self, grid: QGridLayout, row: int) -> None:
        """Put the controls into a row of a grid."""
        grid.addWidget(self.label, row, 0)
        grid.addWidget(self.box, row, 1, 1, 3)

    def guard(self, guard: WheelGuard) -> None:
        """Keep the wheel from what has no focus."""
        guard.guard(self.box)

    def value_of(self, chosen: Parameters, picked: Parameters | None) -> Any:
        """Return all that it shows of these."""
        return getattr(chosen, self._described.name)

    def show_value(self, chosen: Parameters, picked: Parameters | None) -> None:
        """Show what was chosen; a value that is not offered is added."""
        value = getattr(chosen, self._described.name)
        at = self.box.findData(value)
        if at < 0:
            self.box.addItem(str(value), value)
            at = self.box.count() - 1
        self.box.setCurrentIndex(at)

    def _choose(self) -> None:
        text = f"{self._described.title} {self.box.currentText()}"
        self._document.set_parameters(text, **{self._described.name: self.box.currentData()})


class CountRow(QObject):
    """A whole number of things."""

    chosen = Signal(int)

    def __init__(self, described: Described, most: int, document: Document, parent: QObject) -> None:
        super().__init__(parent)
        self._described, self._document = described, document
        self._hand = Hand(document, self)
        self.box = named(QSpinBox(), described.title, described.help)
        self.label = label_of(described, self.box)
        self.box.setRange(1, most)
        self.box.setKeyboardTracking(False)
        self.box.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.box.setFixedWidth(BOX_WIDTH)
        self.box.valueChanged.connect(self._choose)

    def place(self, grid: QGridLayout, row: int) -> None:
        """Put the controls into a row of a grid."""
        grid.addWidget(self.label, row, 0)
        grid.addWidget(self.box, row, 2)

    def guard(self, guard: WheelGuard) -> None:
        """Keep the wheel from what has no focus."""
        guard.guard(self.box)

    def value_of(self, chosen: Parameters, picked: Parameters | None) -> Any:
        """Return all that it shows of these."""
        return getattr(chosen, self._described.name)

    def show_value(self, chosen: Parameters, picked: Parameters | None) -> None:
        """Show what was chosen."""
        with QSignalBlocker(self.box):
            self.box.setValue(getattr(chosen, self._described.name))

    def _choose(self, count: int) -> None:
        text = f"{self._described.title} {count}"
        self._document.set_parameters(text, self._hand.touch(), **{self._described.name: count})
