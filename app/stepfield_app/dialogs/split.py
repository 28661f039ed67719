"""Split: where a layer is parted, and how many pillars are on each side."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QVBoxLayout,
    QWidget,
)

from stepfield.reconstruction import Reconstruction
from stepfield_app.appearance import numbers_font
from stepfield_app.controls import named
from stepfield_app.dialogs.split_plot import SplitPlot
from stepfield_app.panels.lengths import LengthBox
from stepfield_app.scenes.parting import parting
from stepfield_app.theme import Theme, layer_colour
from stepfield_app.wording import counted

#: Digits after the point of an elevation in metres.
DIGITS = 3
#: Room for a number and its unit, logical pixels.
COUNT_WIDTH = 112


class SplitDialog(QDialog):
    """Asks at which elevation a layer is parted.

    Parameters
    ----------
    result : Reconstruction
    layer : int
    name, colour : str
        Of the layer.
    theme : Theme
    parent : QWidget, optional
    """

    def __init__(
        self,
        result: Reconstruction,
        layer: int,
        name: str,
        colour: str,
        theme: Theme,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._parting, self._name = parting(result, layer), name
        self.setWindowTitle(f"Split {name}")
        self.resize(640, 360)
        self.plot = SplitPlot(self._parting, (colour, layer_colour(len(result.layers))), theme)
        self.box = LengthBox(least=-1e9, decimals=DIGITS)
        named(self.box, "Elevation of the split, metres", "Pillars above this elevation go to a new layer")
        self.box.setFixedWidth(COUNT_WIDTH)
        self.above, self.below = _count(), _count()
        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        )
        self._split = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self._split.setText("Split")
        self._arrange()
        self.plot.chosen.connect(self._choose)
        self.box.chosen.connect(self._choose)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self._choose(round(self._parting.suggested(), DIGITS))
        self.box.setFocus()

    @property
    def elevation(self) -> float:
        """Where the layer is parted, scan coordinates, metres."""
        return self.box.value()

    def _arrange(self) -> None:
        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.setVerticalSpacing(8)
        form.addRow("Split at", self.box)
        form.addRow("Above, to a new layer", self.above)
        form.addRow(f"Below, stay in {self._name}", self.below)
        side = QVBoxLayout()
        side.setSpacing(16)
        side.addLayout(form)
        side.addStretch(1)
        side.addWidget(self.buttons)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(16, 16, 16, 16)
        layout.setSpacing(16)
        layout.addWidget(self.plot, 1)
        layout.addLayout(side)

    def _choose(self, elevation: float) -> None:
        self.box.show_length(elevation)
        self.plot.show_elevation(elevation)
        above = self._parting.above(elevation)
        below = len(self._parting.elevation) - above
        self.above.setText(counted(above, "pillar"))
        self.below.setText(counted(below, "pillar"))
        is_parted = above > 0 and below > 0
        self._split.setEnabled(is_parted)
        self._split.setToolTip("" if is_parted else "All pillars are on one side of the line")


def _count() -> QLabel:
    label = QLabel()
    label.setFont(numbers_font(label.font()))
    label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
    label.setFixedWidth(COUNT_WIDTH)
    return label
