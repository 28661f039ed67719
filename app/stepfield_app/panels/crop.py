"""The crop box by numbers, and the slab of heights that takes floors apart in one drag."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox, QGridLayout, QHBoxLayout, QLabel, QToolButton, QWidget

from stepfield.parameters import Box
from stepfield_app.controls import named
from stepfield_app.document import Document
from stepfield_app.icons import icon
from stepfield_app.panels.hand import Hand, WheelGuard
from stepfield_app.panels.lengths import LengthBox
from stepfield_app.panels.page import GRID, column, muted
from stepfield_app.panels.slab import SlabSlider

#: Least width of a number; it holds the coordinates of a national grid.
NUMBER_WIDTH = 96
AXES = "xyz"


class CropGroup(QWidget):
    """Six numbers, a slab over the heights, a switch, and a button for the handles in the views.

    Parameters
    ----------
    document : Document
    guard : WheelGuard
    """

    tool_requested = Signal(bool)

    def __init__(self, document: Document, guard: WheelGuard) -> None:
        super().__init__()
        self._document = document
        self._remembered: Box | None = None
        self._hand = Hand(document, self)
        self._make_controls()
        guard.guard(self.slab, *self.boxes)
        layout = column(margin=0)
        layout.addLayout(self._switches())
        layout.addLayout(self._numbers())
        layout.addWidget(muted("Heights kept"))
        layout.addWidget(self.slab)
        self.setLayout(layout)

    def _make_controls(self) -> None:
        self.switch = named(QCheckBox("Crop box"), "Crop box", "Keep only what lies inside the box")
        self.tool = named(QToolButton(), "Crop in the views", "Drag the faces of the box in the 3-D views")
        self.tool.setIcon(icon("crop"))
        self.tool.setCheckable(True)
        self.clear = named(QToolButton(), "Clear the crop box", "Clear the box: keep the whole scan")
        self.clear.setIcon(icon("reset"))
        self.boxes = [self._number(i) for i in range(6)]
        self.slab = named(
            SlabSlider(), "Height slab", "Keep only the heights between the ends (Space: other end)"
        )
        self.switch.clicked.connect(self._turn)
        self.tool.toggled.connect(self.tool_requested)
        self.clear.clicked.connect(self._clear)
        self.slab.pressed.connect(self._hand.press)
        self.slab.released.connect(self._hand.release)
        self.slab.chosen.connect(self._cut)

    def _number(self, place: int) -> LengthBox:
        end = "to" if place >= 3 else "from"
        box = LengthBox(least=-1e9, decimals=3)
        named(
            box, f"{AXES[place % 3]} {end}", f"Keep {AXES[place % 3]} {end} here, metres in scan coordinates"
        )
        box.setMinimumWidth(NUMBER_WIDTH)
        box.chosen.connect(lambda metres: self._replace({place: metres}, "Crop", self._hand.touch()))
        return box

    def _switches(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.addWidget(self.switch, 1)
        row.addWidget(self.tool)
        row.addWidget(self.clear)
        return row

    def _numbers(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(GRID)
        grid.setVerticalSpacing(GRID // 2)
        for place, box in enumerate(self.boxes):
            grid.addWidget(box, place % 3, 1 + place // 3)
        for row, axis in enumerate(AXES):
            grid.addWidget(QLabel(axis), row, 0)
        grid.setColumnStretch(1, 1)
        grid.setColumnStretch(2, 1)
        return grid

    @property
    def box(self) -> Box:
        """The box in force, or the one that switching on would put in force."""
        return self._document.project.parameters.crop or self._remembered or self._bounds

    @property
    def _bounds(self) -> Box:
        facts = self._document.facts
        return facts.bounds if facts else (0.0, 0.0, 0.0, 1.0, 1.0, 1.0)

    def show_value(self) -> None:
        """Show what the document says."""
        crop = self._document.project.parameters.crop
        if crop is not None:
            self._remembered = None
        self.switch.setChecked(crop is not None)
        for place, metres in enumerate(self.box):
            self.boxes[place].show_length(metres)
        kept = crop or self._bounds
        self.slab.show_ends(self._share(kept[2]), self._share(kept[5]))

    def forget(self) -> None:
        """Forget the box of another scan."""
        self._remembered = None

    def _share(self, z: float) -> float:
        low, high = self._bounds[2], self._bounds[5]
        return (z - low) / (high - low) if high > low else 0.0

    def _cut(self, lower: float, upper: float) -> None:
        """Crop to the slab between the ends; an end of the whole keeps that exactly."""
        low, high = self._bounds[2], self._bounds[5]
        exact = {0.0: low, 1.0: high}
        bottom, top = (exact.get(share, low + (high - low) * share) for share in (lower, upper))
        self._remembered = None  # the slab shows the whole scan while no box is in force
        self._replace({2: bottom, 5: top}, f"Crop z {bottom:.2f} to {top:.2f} m", self._hand.touch())

    def _replace(self, changed: dict[int, float], text: str, gesture: object | None) -> None:
        crop = tuple(changed.get(place, metres) for place, metres in enumerate(self.box))
        self._document.set_parameters(text, gesture, crop=crop)

    def _turn(self, is_on: bool) -> None:
        box = self.box
        self._document.set_parameters("Crop on" if is_on else "Crop off", crop=box if is_on else None)
        self._remembered = None if is_on else box
        self.show_value()

    def _clear(self) -> None:
        self._document.set_parameters("Clear the crop box", crop=None)
        self.forget()
        self.show_value()
