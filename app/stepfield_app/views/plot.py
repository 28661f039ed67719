"""What the map, the profile and the histogram share: a plane in metres to pan and zoom, and its theming."""

from __future__ import annotations

from typing import Any, Protocol

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QResizeEvent
from PySide6.QtWidgets import QFrame, QWidget

from stepfield_app.scenes.legend import Legend
from stepfield_app.theme import DARK, Theme
from stepfield_app.views.axes import MetreAxis
from stepfield_app.views.extent import Extent
from stepfield_app.views.overlay import Overlay, small_font

pg.setConfigOptions(imageAxisOrder="row-major", antialias=False)

#: Share of the extent left free around it when it is fitted.
MARGIN = 0.03
#: How far one can zoom: as a share of the extent at the nearest, as a multiple of it at the farthest.
NEAREST, FARTHEST = 1e-4, 20.0
#: Milliseconds that pass before a newer result that is under way is mentioned: most arrive sooner.
PATIENCE = 250
#: Width of a legend beside a plot, how much nearer to the edge it may come, and the least width of a plot
#: that has one.
LEGEND_ROOM, MARGIN_BESIDE, LEAST_FOR_LEGEND = 84, 8, 360
#: Share of what is visible that one press of a key moves, and the zoom of one press.
KEY_STEP, KEY_ZOOM = 0.1, 1.25


class Tool(Protocol):
    """Something that takes drags of the left button before they pan."""

    def takes(self, event: Any) -> bool:
        """Say whether a drag is the tool's; asked at every move of it."""

    def drag(self, event: Any) -> None:
        """Follow a drag that was taken."""


class Pane(pg.ViewBox):  # type: ignore[misc]
    """The inside of a plot: every button pans, a double-click fits, a tool may take the left button."""

    fit_asked = Signal()
    touched = Signal()

    def __init__(self, equal_scales: bool) -> None:
        super().__init__(enableMenu=False, lockAspect=equal_scales)
        self.tool: Tool | None = None

    def mouseDragEvent(self, event: Any, axis: int | None = None) -> None:  # noqa: N802
        """Give the drag to the tool if it takes it, else pan."""
        event.accept()
        if self.tool is not None and event.button() == Qt.MouseButton.LeftButton and self.tool.takes(event):
            self.tool.drag(event)
            return
        shift = self.mapToView(event.lastPos()) - self.mapToView(event.pos())
        self.translateBy(x=shift.x(), y=shift.y())
        self.touched.emit()

    def wheelEvent(self, event: Any, axis: int | None = None) -> None:  # noqa: N802
        """Zoom to the cursor."""
        super().wheelEvent(event, axis)
        self.touched.emit()

    def mouseClickEvent(self, event: Any) -> None:  # noqa: N802
        """Fit on a double-click."""
        if event.double() and event.button() == Qt.MouseButton.LeftButton:
            event.accept()
            self.fit_asked.emit()


class Plot(pg.PlotWidget):  # type: ignore[misc]
    """A plane with axes in metres, an overlay, and a sentence while it is empty.

    Parameters
    ----------
    across, up : str
        What the axes measure.
    equal_scales : bool
        Whether a metre is as long upwards as across.
    """

    #: Coordinates under the cursor.
    hovered = Signal(float, float)
    hover_ended = Signal()
    escaped = Signal()

    def __init__(self, across: str, up: str, equal_scales: bool, parent: QWidget | None = None) -> None:
        self.theme = DARK
        self._empty_text, self._legend = "", Legend("")
        self._extent: Extent | None = None
        self._equal_scales = equal_scales
        self._patience = QTimer(singleShot=True, interval=PATIENCE)
        self._is_late = False
        self._is_touched = False
        self.pane = Pane(equal_scales)
        self.axes = {"bottom": MetreAxis("bottom", across), "left": MetreAxis("left", up)}
        super().__init__(parent, viewBox=self.pane, axisItems=self.axes)
        self._patience.timeout.connect(self._mention)
        self.pane.fit_asked.connect(self.fit)
        self.pane.touched.connect(self._touch)
        self.pane.sigResized.connect(self._refit)
        self.hideButtons()
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMinimumSize(120, 100)
        self._leave_room(0)
        self.set_theme(DARK)

    # --- What it shows --------------------------------------------------------------------------------------

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self.theme = theme
        self.setBackground(QColor(theme.window))
        for axis in self.axes.values():
            axis.set_theme(theme)
        self.viewport().update()

    def set_empty_text(self, text: str) -> None:
        """Say this in place of a plot; an empty text shows the plot."""
        self._empty_text = text
        self.getPlotItem().setVisible(not text)
        self.viewport().update()

    def set_legend(self, legend: Legend) -> None:
        """Say what the colours mean."""
        self._legend = legend
        self._leave_room(self._legend_room)
        self.viewport().update()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Leave the room beside the plot to the legend, if there is enough for both."""
        super().resizeEvent(event)
        if self.getPlotItem() is not None:  # the base class resizes itself before there is a plot
            self._leave_room(self._legend_room)

    def _refit(self) -> None:
        """Show everything at every size, until the operator zooms or pans."""
        if not self._is_touched:
            self.fit()
        self.viewport().update()  # what is painted over the plot has moved

    @property
    def _legend_room(self) -> int:
        """Pixels at the right that the legend has for itself: over the plot it would hide data."""
        return LEGEND_ROOM if self._legend.title and self.width() >= LEAST_FOR_LEGEND else 0

    def _leave_room(self, room: int) -> None:
        self.getPlotItem().layout.setContentsMargins(4, 8, 12 + room, 4)

    def set_pending(self, is_pending: bool) -> None:
        """Mark the plot as of older parameters, unless the newer one arrives in a moment."""
        if not is_pending:
            self._patience.stop()
            self._is_late = False
            self.viewport().update()
        elif not self._is_late and not self._patience.isActive():
            self._patience.start()

    @property
    def is_marked_pending(self) -> bool:
        """Whether the mark is on the screen."""
        return self._is_late

    def _mention(self) -> None:
        self._is_late = True
        self.viewport().update()

    def drawForeground(self, painter: QPainter, rect: QRectF) -> None:  # noqa: N802
        """Paint what lies over the plot, in pixels of the widget."""
        painter.save()
        painter.resetTransform()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._empty_text:
            painter.setFont(self.font())
            Overlay(painter, QRectF(self.viewport().rect()), self.theme).sentence(self._empty_text)
        else:
            painter.setFont(small_font(self.font()))
            self.paint_over(painter, self.pane.sceneBoundingRect())
        painter.restore()

    def paint_over(self, painter: QPainter, area: QRectF) -> None:
        """Paint over the plot; ``area`` is its inside, in pixels of the widget."""
        overlay = Overlay(painter, area, self.theme)
        if self._legend_room:
            beside = area.adjusted(0, 0, self._legend_room + MARGIN_BESIDE, 0)
            Overlay(painter, beside, self.theme).legend(self._legend)
        if self._is_late:
            overlay.note("updating…", self.theme.muted)

    # --- Which part is visible ------------------------------------------------------------------------------

    def set_extent(self, extent: Extent, keep_zoom: bool) -> None:
        """Know what there is to see, and show all of it unless the zoom is to be kept."""
        is_first = self._extent is None
        self._extent = extent
        sides = extent.width, extent.height
        across, up = (max(sides), max(sides)) if self._equal_scales else sides
        self.pane.setLimits(
            maxXRange=across * FARTHEST,
            maxYRange=up * FARTHEST,
            minXRange=across * NEAREST,
            minYRange=up * NEAREST,
        )
        for axis in self.axes.values():
            axis.make_room(extent.bottom, extent.top)
        if is_first or not keep_zoom:
            self.fit()

    def fit(self) -> None:
        """Show everything."""
        self._is_touched = False
        if self._extent is not None:
            self.pane.setRange(self._extent.rectangle(), padding=MARGIN)

    def forget(self) -> None:
        """Forget what there was to see: the next extent will be fitted."""
        self._extent, self._is_touched = None, False

    @property
    def is_touched(self) -> bool:
        """Whether the operator has zoomed or panned since everything was shown."""
        return self._is_touched

    def _touch(self) -> None:
        self._is_touched = True

    @property
    def extent(self) -> Extent | None:
        """What there is to see."""
        return self._extent

    @property
    def visible(self) -> Extent:
        """Which part is visible."""
        (left, right), (bottom, top) = self.pane.viewRange()
        return Extent(left, bottom, right, top)

    # --- Mouse and keyboard ---------------------------------------------------------------------------------

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Tell where the cursor is."""
        super().mouseMoveEvent(event)
        inside = self.pane.sceneBoundingRect().contains(event.position())
        if inside and self._extent is not None and not self._empty_text:
            place = self.place_at(event.position())
            self.hovered.emit(place.x(), place.y())
        else:
            self.hover_ended.emit()

    def leaveEvent(self, event: QEvent) -> None:  # noqa: N802
        """Tell that the cursor has left."""
        super().leaveEvent(event)
        self.hover_ended.emit()

    def place_at(self, at: QPointF) -> QPointF:
        """Return the coordinates of a pixel of the widget."""
        place: QPointF = self.pane.mapSceneToView(at)
        return place

    def pixel_of(self, x: float, y: float) -> QPointF:
        """Return the pixel of the widget at which coordinates are drawn."""
        pixel: QPointF = self.pane.mapViewToScene(QPointF(x, y))
        return pixel

    def event(self, event: QEvent) -> bool:
        """Keep F from the window, which would fit the 3-D views: the plot has the keyboard."""
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.ShortcutOverride and _fits(event):
            event.accept()
            return True
        return bool(super().event(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Fit, zoom and pan by keys."""
        if _fits(event):
            self.fit()
        elif event.key() == Qt.Key.Key_Escape:
            self.escaped.emit()
        elif event.text() in ("+", "-"):
            factor = 1 / KEY_ZOOM if event.text() == "+" else KEY_ZOOM
            self.pane.scaleBy((factor, factor))
            self._touch()
        elif event.key() in _STEPS:
            self.step(*_STEPS[Qt.Key(event.key())])
        else:
            QWidget.keyPressEvent(self, event)

    def step(self, right: int, up: int) -> None:
        """Move what is visible by a step of the keys."""
        visible = self.visible
        self.pane.translateBy(x=right * KEY_STEP * visible.width, y=up * KEY_STEP * visible.height)
        self._touch()


def _fits(event: QKeyEvent) -> bool:
    return event.key() == Qt.Key.Key_F and not event.modifiers()


_STEPS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, 1),
    Qt.Key.Key_Down: (0, -1),
}
