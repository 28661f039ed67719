"""The strip above the views while a selecting tool is in use: what it does, its width, what it reaches."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeVar

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import (
    QAbstractSpinBox,
    QButtonGroup,
    QDoubleSpinBox,
    QLabel,
    QSpinBox,
    QToolButton,
)

from stepfield_app.appearance import numbers_font
from stepfield_app.controls import named
from stepfield_app.selection import ReachKind, Selection
from stepfield_app.tools.choice import LEAST, MOST, Choice
from stepfield_app.views.strip import Strip

Box = TypeVar("Box", bound=QAbstractSpinBox)

#: What every tool is called, and what a hand does with it.
TITLES = {
    "navigate": ("Navigate", ""),
    "click": ("Click", "Click a pillar"),
    "rectangle": ("Rectangle", "Drag a rectangle"),
    "lasso": ("Lasso", "Draw around pillars"),
    "brush": ("Brush", "Brush over pillars"),
    "surface": ("Connected surface", "Click a surface"),
}
MORE = (
    " · Shift adds, Alt subtracts · drag the selection onto a layer · Space navigates · Esc leaves",
    " · Shift adds, Alt subtracts · Space navigates · Esc leaves",
    " · Shift adds, Alt subtracts",
    "",
)
#: Longer names of layers are cut on their button.
LONGEST = 18
#: Widths of the boxes: of an elevation, of the brush.
ELEVATION_WIDTH, BRUSH_WIDTH = 96, 68


class SelectStrip(Strip):
    """Shows the reach of the selecting tools, always, and lets it be chosen.

    Parameters
    ----------
    selection : Selection
    choice : Choice
    name_of : callable
        What a layer is called.
    """

    def __init__(self, selection: Selection, choice: Choice, name_of: Callable[[int], str]) -> None:
        super().__init__("")
        self._selection, self._choice, self._name_of = selection, choice, name_of
        self._range: tuple[float, float, float] | None = None
        self._brush = _brush_box()
        self._group = QButtonGroup(self)
        self._reaches: dict[ReachKind, QToolButton] = {
            "layer": self._reach("layer", "Only pillars of the active layer are selected"),
            "range": self._reach("range", "Only pillars within a range of elevations are selected"),
            "everything": self._reach("everything", "Pillars of all layers are selected, hidden ones too"),
        }
        self.low, self.high = (_elevation_box(name) for name in ("Lowest", "Highest"))
        self.to = QLabel("to")
        reaches = [QLabel("Reaches"), *self._reaches.values(), self.low, self.to, self.high]
        self.add(self._brush, *reaches)
        self._connect()
        self.show_reach()
        self._show_tool(choice.tool)
        self._show_radius(choice.radius)

    def _connect(self) -> None:
        self._brush.valueChanged.connect(self._choice.set_radius)
        self._choice.radius_changed.connect(self._show_radius)
        self._choice.tool_changed.connect(self._show_tool)
        self._selection.reach_changed.connect(self.show_reach)
        for box in (self.low, self.high):
            box.valueChanged.connect(lambda _: self._choose_range())

    def button(self, kind: ReachKind) -> QToolButton:
        """Return the button that chooses a reach."""
        return self._reaches[kind]

    def set_range(self, low: float, high: float, step: float) -> None:
        """Know between which elevations there are pillars, and a step that is worth one, metres."""
        if (low, high, step) == self._range:
            return
        self._range = low, high, step
        for box in (self.low, self.high):
            with QSignalBlocker(box):
                box.setSingleStep(step)
                box.setRange(low - 1, high + 1)
        self.show_reach()

    def show_reach(self) -> None:
        """Show what is reached."""
        selection = self._selection
        self._reaches[selection.reach_kind].setChecked(True)
        for box, value in zip((self.low, self.high), selection.z_range, strict=True):
            with QSignalBlocker(box):
                box.setValue(value)
        for widget in (self.low, self.to, self.high):
            widget.setEnabled(selection.reach_kind == "range")

    def name_layer(self, layer: int) -> None:
        """Name the active layer on its button."""
        name = self._name_of(layer)
        short = name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"
        text = f"{short} only".replace("&", "&&")
        if self._reaches["layer"].text() != text:
            self._reaches["layer"].setText(text)

    def _reach(self, kind: ReachKind, tip: str) -> QToolButton:
        text = {"layer": "Active layer only", "range": "Elevations", "everything": "Everything"}[kind]
        button = named(QToolButton(), f"Reach: {text}", tip)
        button.setText(text)
        button.setCheckable(True)
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        button.clicked.connect(partial(self._choose, kind))
        self._group.addButton(button)
        return button

    def _choose(self, kind: ReachKind, _: bool = True) -> None:
        """Choose a reach; a range has the ends it had, which may have more digits than the boxes show."""
        self._selection.set_reach(kind)

    def _choose_range(self) -> None:
        self._selection.set_reach("range", *sorted((self.low.value(), self.high.value())))

    def _show_tool(self, tool: str) -> None:
        title, hint = TITLES[tool]
        self.title.setText(title)
        self.set_detail(*(hint + more for more in MORE))
        self._brush.setVisible(tool == "brush")

    def _show_radius(self, radius: float) -> None:
        with QSignalBlocker(self._brush):
            self._brush.setValue(round(radius))


def _brush_box() -> QSpinBox:
    tip = "Radius of the brush on the screen (Ctrl+wheel over a view)"
    box = named(QSpinBox(suffix=" px", minimum=round(LEAST), maximum=round(MOST)), "Radius of the brush", tip)
    box.setFixedWidth(BRUSH_WIDTH)
    return _numeric(box)


def _elevation_box(name: str) -> QDoubleSpinBox:
    tip = f"{name} elevation that is selected, metres in the scan's coordinates"
    box = named(QDoubleSpinBox(suffix=" m", decimals=2, minimum=-1e6, maximum=1e6), f"{name} elevation", tip)
    box.setFixedWidth(ELEVATION_WIDTH)
    return _numeric(box)


def _numeric(box: Box) -> Box:
    box.setAlignment(Qt.AlignmentFlag.AlignRight)
    box.setFont(numbers_font(box.font()))
    box.setKeyboardTracking(False)
    return box
