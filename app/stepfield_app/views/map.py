"""The map: the active layer's height-map from above, north up."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QComboBox, QVBoxLayout, QWidget

from stepfield_app.controls import named, snug
from stepfield_app.scenes.legend import Legend
from stepfield_app.theme import Theme
from stepfield_app.views.line import ProfileLine
from stepfield_app.views.map_plot import MapPlot
from stepfield_app.views.pictures import MODES, OVERLAYS, MapPicture
from stepfield_app.views.strip import Strip, tool_button
from stepfield_app.wording import reading

EMPTY = "Open a scan to see the height-map of the active layer here."
#: A new line's band is this many compartments wide.
BAND_CELLS = 2


#: How a map is drawn until another way is chosen: the one that shows most.
FIRST_MODE = "hillshade"


class MapView(QWidget):
    """Shows finished pictures, and says what it would like to show."""

    #: Layer and mode of the picture that should come next.
    picture_wanted = Signal(int, str)
    #: Another way of drawing was chosen.
    mode_changed = Signal(str)
    #: Start (x, y), end (x, y) and width in metres of the profile line; at every move of it.
    section_wanted = Signal(object, object, float)
    section_ended = Signal()
    #: Another picture is shown.
    picture_changed = Signal()
    cursor_moved = Signal(float, float)
    cursor_left = Signal()
    #: Whether the tool that draws a profile line is in use.
    drawing_changed = Signal(bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._layer = 0
        self._picture: MapPicture | None = None
        self._note = ""
        self._is_new = True
        self.plot = MapPlot(self)
        self.plot.setAccessibleName("Map of the active layer")
        self.plot.set_empty_text(EMPTY)
        self.strip = Strip("Map")
        self._modes = _mode_box()
        self._line_button = tool_button(
            "profile", "Profile line", "Profile line: draw a line to cut along (P)", checkable=True
        )
        self._fit_button = tool_button("fit", "Show the whole map", "Show the whole map (F)")
        self.strip.add(self._modes, self._line_button, self._fit_button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addWidget(self.strip)
        layout.addWidget(self.plot, 1)
        self._connect()
        self.clear()

    def _connect(self) -> None:
        self._modes.activated.connect(self._choose)
        self._line_button.toggled.connect(self.set_drawing)
        self._fit_button.clicked.connect(self.plot.fit)
        self.plot.line_changed.connect(self._tell_line)
        self.plot.escaped.connect(lambda: self.set_drawing(False))
        self.plot.hovered.connect(self.cursor_moved)
        self.plot.hover_ended.connect(self.cursor_left)
        self.plot.hovered.connect(self._read)
        self.plot.hover_ended.connect(self._read_nothing)
        self._line_button.toggled.connect(self.drawing_changed)

    # --- What it shows --------------------------------------------------------------------------------------

    @property
    def mode(self) -> str:
        """One of :data:`MODES`."""
        return str(self._modes.currentData())

    @property
    def layer(self) -> int:
        """The layer it shows or has asked for."""
        return self._layer

    def set_layer(self, layer: int) -> None:
        """Ask for the map of another layer."""
        self._layer = layer
        self.ask()

    def set_mode(self, mode: str) -> None:
        """Ask for another way of drawing."""
        self._modes.setCurrentIndex(self._modes.findData(mode))
        self._choose()

    def _choose(self) -> None:
        self.mode_changed.emit(self.mode)
        self.ask()

    def _read(self, x: float, y: float) -> None:
        """Say beside the layer's name what the overlay shows under the cursor."""
        if self._picture is not None and self._picture.values is not None:
            said = reading(self._picture.mode, self._picture.value_at(x, y), self._picture.names)
            name = self._picture.name
            self.strip.set_detail(*((f"{name}: {said}", said) if said else (name,)))

    def _read_nothing(self) -> None:
        if self._picture is not None:
            self.strip.set_detail(self._picture.name)

    def ask(self) -> None:
        """Ask for the picture of the layer and mode chosen."""
        self.picture_wanted.emit(self._layer, self.mode)

    def set_picture(self, picture: MapPicture | None) -> None:
        """Show a finished picture; None shows how to get one."""
        if picture is None:
            self.clear()
            return
        self._layer = picture.layer
        self._picture = picture
        self.strip.set_subject(picture.name, picture.colour)
        self.plot.set_empty_text("")
        self._tell_legend()
        self._take_cell_size(picture.cell_size)
        self.plot.show_picture(picture)
        self._enable(True)
        self.picture_changed.emit()

    def set_note(self, note: str) -> None:
        """Say in the legend what marks over the picture mean; nothing where there are none."""
        if note != self._note:
            self._note = note
            self._tell_legend()

    def _tell_legend(self) -> None:
        legend = (self._picture and self._picture.legend) or Legend("")
        notes = ", ".join(filter(None, [legend.note, self._note]))
        self.plot.set_legend(replace(legend, note=notes))

    def clear(self) -> None:
        """Forget the scan: the next picture is of another one and will be fitted."""
        self._is_new = True
        self._picture = None
        self.set_drawing(False)
        self.plot.forget()
        self.plot.set_empty_text(EMPTY)
        self.strip.set_subject("", "")
        self._enable(False)

    def set_pending(self, is_pending: bool) -> None:
        """Mark the picture as of older parameters."""
        self.plot.set_pending(is_pending)

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self.plot.set_theme(theme)

    def _enable(self, is_on: bool) -> None:
        for control in (self._line_button, self._fit_button, self._modes):
            control.setEnabled(is_on)

    def _take_cell_size(self, cell_size: float) -> None:
        if self._is_new:
            self._is_new = False
            if self.line is None:
                self.plot.set_line_width(BAND_CELLS * cell_size)

    # --- The profile line -----------------------------------------------------------------------------------

    @property
    def line(self) -> ProfileLine | None:
        """The line on the map."""
        return self.plot.line

    def set_line(self, line: ProfileLine | None) -> None:
        """Put a line on the map, or take it away."""
        if line is not None:
            self.plot.line_width = line.width
        self.plot.set_line(line)

    def set_mark(self, place: tuple[float, float] | None) -> None:
        """Mark a place (x, y), scan coordinates in metres: where the cursor is in the profile."""
        self.plot.set_mark(place)

    def set_drawing(self, is_drawing: bool) -> None:
        """Enter or leave the tool that draws a profile line."""
        self.plot.is_drawing = is_drawing
        self._line_button.setChecked(is_drawing)
        self.plot.viewport().update()
        if is_drawing:
            self.plot.setFocus()

    def set_line_width(self, width: float) -> None:
        """Make the band of the line wider or narrower, metres."""
        self.plot.set_line_width(width)

    def _tell_line(self, line: ProfileLine | None) -> None:
        if line is None:
            self.section_ended.emit()
        elif line.length:
            self.section_wanted.emit(line.start, line.end, line.width)


def _mode_box() -> QComboBox:
    box = named(QComboBox(), "How the map is drawn", "What the pixels of the map show")
    for place, (mode, (name, explanation)) in enumerate(MODES.items()):
        box.addItem(name, mode)
        box.setItemData(place, explanation, Qt.ItemDataRole.ToolTipRole)
    box.insertSeparator(len(MODES) - len(OVERLAYS))
    box.setCurrentIndex(box.findData(FIRST_MODE))
    return snug(box)
