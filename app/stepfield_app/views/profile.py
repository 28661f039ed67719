"""The profile along a line on the map: the one place where surfaces above each other are apart."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, QSignalBlocker, Signal
from PySide6.QtGui import QIcon, QPainter
from PySide6.QtWidgets import QToolButton, QVBoxLayout, QWidget

from stepfield_app.scenes.units import format_length
from stepfield_app.theme import Theme
from stepfield_app.views.dots import Blocks, Dots
from stepfield_app.views.extent import Extent
from stepfield_app.views.outlines import SelectedBlocks
from stepfield_app.views.overlay import Overlay
from stepfield_app.views.pictures import Section
from stepfield_app.views.plot import Plot
from stepfield_app.views.strip import Strip, WidthBox, tool_button
from stepfield_app.wording import counted, digits_for, metres, number, round_step

EMPTY = "Turn on “Profile line” above the map and draw a line: points and pillars along it appear here."
#: Least height of what is shown, as a share of the length: a flat floor is no mountain range.
FLATTEST = 0.02
#: Free room above and below the points, as a share of their height.
HEADROOM = 0.08
NONE = np.zeros((0, 4))


class ProfileView(QWidget):
    """Shows a finished section, and says how wide it should be."""

    width_changed = Signal(float)
    #: Another section is shown, or none.
    section_changed = Signal()
    #: Distance along the line and elevation under the cursor, metres.
    cursor_moved = Signal(float, float)
    #: Place (x, y) on the line under the cursor.
    place_hovered = Signal(float, float)
    cursor_left = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._section: Section | None = None
        self.plot = ProfilePlot(self)
        self.plot.setAccessibleName("Profile along the line on the map")
        self.plot.set_empty_text(EMPTY)
        self.strip = Strip("Profile")
        self._points = _toggle("cloud", "Points", "Show the points of the scan in the band")
        self._pillars = _toggle("pillars", "Pillars", "Show the pillars, with a line at their height")
        self._width = WidthBox()
        self._equal = tool_button(
            "parallel",
            "Equal scales",
            "Equal scales: a metre up is as long as a metre across",
            checkable=True,
        )
        self._equal.setIcon(QIcon())
        self._equal.setText("1:1")
        self._fit = tool_button("fit", "Show the whole profile", "Show the whole profile (F)")
        self.strip.add(self._points, self._pillars, self._width, self._equal, self._fit)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addWidget(self.strip)
        layout.addWidget(self.plot, 1)
        self._connect()
        self.set_section(None)

    def _connect(self) -> None:
        self._points.toggled.connect(self.plot.dots.setVisible)
        self._pillars.toggled.connect(self.plot.blocks.setVisible)
        self._width.valueChanged.connect(self.width_changed)
        self._equal.toggled.connect(self.plot.set_equal_scales)
        self._fit.clicked.connect(self.plot.fit)
        self.plot.hovered.connect(self._tell_cursor)
        self.plot.hover_ended.connect(self._forget_cursor)
        self.plot.pane.sigTransformChanged.connect(self._describe)

    @property
    def section(self) -> Section | None:
        """What is shown."""
        return self._section

    def set_selected(self, is_selected: NDArray[np.bool_]) -> None:
        """Outline some pillars of the section, shape (m,); none with an empty array."""
        spans = self._section.spans[is_selected] if self._section is not None and len(is_selected) else NONE
        self.plot.selected.set_spans(spans)

    def set_section(self, section: Section | None) -> None:
        """Show a finished section; None says how to get one."""
        self._section = section
        self.plot.set_empty_text("" if section is not None else EMPTY)
        for control in (self._points, self._pillars, self._width, self._equal, self._fit):
            control.setEnabled(section is not None)
        if section is None:
            self.plot.forget()
        else:
            self._take_width(section.width)
            self.plot.show_section(section)
        self._describe()
        self.section_changed.emit()

    def set_cell_size(self, cell_size: float) -> None:
        """Let the width be stepped by compartments."""
        with QSignalBlocker(self._width):
            self._width.set_cell_size(cell_size)

    def _take_width(self, width: float) -> None:
        """Show the width of the band, unless somebody is typing another."""
        if not self._width.hasFocus() and self._width.value() != width:
            with QSignalBlocker(self._width):
                self._width.setValue(width)

    def set_pending(self, is_pending: bool) -> None:
        """Mark the profile as of older parameters."""
        self.plot.set_pending(is_pending)

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self.plot.set_theme(theme)

    def _describe(self) -> None:
        if self._section is None:
            self.strip.set_detail()
            return
        exaggeration = self.plot.exaggeration
        parts = [format_length(length_of(self._section)), counted(self._section.total, "point")]
        if not math.isclose(exaggeration, 1, rel_tol=0.02):
            parts.append(f"heights ×{number(exaggeration, 1)}")
        self.strip.set_detail(*(" · ".join(parts[:count]) for count in range(len(parts), 0, -1)))

    def _tell_cursor(self, distance: float, elevation: float) -> None:
        section = self._section
        if section is None:
            return
        self.plot.set_readout(distance, elevation)
        self.cursor_moved.emit(distance, elevation)
        share = min(1.0, max(0.0, distance / length_of(section)))
        ends = zip(section.start, section.end, strict=True)
        self.place_hovered.emit(*(a + (b - a) * share for a, b in ends))

    def _forget_cursor(self) -> None:
        self.plot.set_readout(None)
        self.cursor_left.emit()


class ProfilePlot(Plot):
    """Distance across, elevation up."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("distance from A", "elevation", equal_scales=False, parent=parent)
        self.blocks, self.dots, self.selected = Blocks(), Dots(), SelectedBlocks()
        self._readout = ""
        for item in (self.blocks, self.dots, self.selected):
            self.addItem(item, ignoreBounds=True)

    def show_section(self, section: Section) -> None:
        """Show another section, fitted as long as nobody has zoomed or panned."""
        self.blocks.set_blocks(section)
        self.dots.set_dots(section)
        self.set_extent(_extent(section), keep_zoom=self.is_touched)

    def set_equal_scales(self, is_equal: bool) -> None:
        """Make a metre as long upwards as across, or fill the plot."""
        self.pane.setAspectLocked(is_equal)
        self.fit()

    @property
    def exaggeration(self) -> float:
        """How much longer a metre is upwards than across."""
        across, up = self.pane.viewPixelSize()
        return float(across / up) if up else 1.0

    def set_readout(self, distance: float | None, elevation: float = 0.0) -> None:
        """Say where the cursor is."""
        self._readout = ""
        if distance is not None:
            digits = digits_for(round_step(min(self.pane.viewPixelSize())))
            self._readout = f"{metres(distance, digits)}   z {metres(elevation, digits)}"
        self.viewport().update()

    def paint_over(self, painter: QPainter, area: QRectF) -> None:
        """Name the ends of the line, and say where the cursor is."""
        super().paint_over(painter, area)
        overlay = Overlay(painter, area, self.theme)
        if self._readout:
            overlay.note(self._readout, self.theme.text)


def length_of(section: Section) -> float:
    """Length of the line, metres; never zero."""
    return max(math.dist(section.start, section.end), 1e-9)


def _extent(section: Section) -> Extent:
    """All points and pillars, from end to end of the line."""
    length = length_of(section)
    heights = [values for values in (section.elevation, *section.spans[:, 2:].T) if len(values)]
    low = min((float(values.min()) for values in heights), default=0.0)
    high = max((float(values.max()) for values in heights), default=length)
    missing = max(0.0, FLATTEST * length - (high - low)) / 2 + HEADROOM * (high - low)
    return Extent(0.0, low - missing, length, high + missing)


def _toggle(meaning: str, name: str, tip: str) -> QToolButton:
    button = tool_button(meaning, f"{name} in the profile", tip, checkable=True)
    button.setChecked(True)
    return button
