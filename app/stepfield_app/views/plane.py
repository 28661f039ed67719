"""A plane in metres to pan, zoom and work in: its mouse and its keys."""

from __future__ import annotations

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QContextMenuEvent, QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QFrame, QWidget

from stepfield_app.views.axes import MetreAxis
from stepfield_app.views.extent import Extent
from stepfield_app.views.pane import Pane
from stepfield_app.views.tool import Grip

#: Zoom of one press of a key.
KEY_ZOOM = 1.25


class Plane(pg.PlotWidget):  # type: ignore[misc]
    """A plane with axes in metres; a tool may take mouse and keys before they pan and zoom.

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
    #: Pixel of the widget at which a menu should open.
    menu_wanted = Signal(QPointF)

    def __init__(self, across: str, up: str, equal_scales: bool, parent: QWidget | None = None) -> None:
        self.pane = Pane(equal_scales)
        self.axes = {"bottom": MetreAxis("bottom", across), "left": MetreAxis("left", up)}
        super().__init__(parent, viewBox=self.pane, axisItems=self.axes)
        self.grip: Grip[Plane] = Grip(self, self.viewport())
        self.pane.fit_asked.connect(self.fit)
        self.pane.menu_asked.connect(self.menu_wanted)
        self.pane.sigResized.connect(self._refit)
        self.hideButtons()
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.let_drop(False)  # Qt would take everything for the scene
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMinimumSize(120, 100)

    def let_drop(self, may_drop: bool) -> None:
        """Take what is dragged over it, or leave that to what lies behind."""
        for part in (self, self.viewport()):
            part.setAcceptDrops(may_drop)

    # --- Which part is visible ------------------------------------------------------------------------------

    def set_extent(self, extent: Extent, keep_zoom: bool) -> None:
        """Know what there is to see, and show all of it unless the zoom is to be kept."""
        is_first, is_known = self.extent is None, extent == self.extent
        if not is_known:
            self.pane.know(extent)
            for axis in self.axes.values():
                axis.make_room(extent.bottom, extent.top)
        is_seen = is_known and not self.is_touched  # every size refits it
        if is_first or not (keep_zoom or is_seen):
            self.fit()

    def fit(self) -> None:
        """Show everything."""
        self.pane.fit()

    def forget(self) -> None:
        """Forget what there was to see: the next extent will be fitted."""
        self.pane.forget()

    def _refit(self) -> None:
        """Show everything at every size, until the operator zooms or pans."""
        if not self.is_touched:
            self.fit()
        self.viewport().update()  # what is painted over the plot has moved

    @property
    def is_touched(self) -> bool:
        """Whether the operator has zoomed or panned since everything was shown."""
        return self.pane.is_touched

    @property
    def extent(self) -> Extent | None:
        """What there is to see."""
        return self.pane.extent

    @property
    def visible(self) -> Extent:
        """Which part is visible."""
        return self.pane.visible

    @property
    def inside(self) -> QRectF:
        """The plot within its axes, in pixels of the widget."""
        area: QRectF = self.pane.sceneBoundingRect()
        return area

    def place_at(self, at: QPointF) -> QPointF:
        """Return the coordinates of a pixel of the widget."""
        place: QPointF = self.pane.mapSceneToView(at)
        return place

    def places_at(self, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the coordinates of pixels of the widget, shape (n, 2)."""
        origin, unit = (np.array(self.place_at(QPointF(side, side)).toTuple()) for side in (0.0, 1.0))
        places: NDArray[np.float64] = origin + pixels * (unit - origin)
        return places

    def pixel_of(self, x: float, y: float) -> QPointF:
        """Return the pixel of the widget at which coordinates are drawn."""
        pixel: QPointF = self.pane.mapViewToScene(QPointF(x, y))
        return pixel

    def is_over(self, at: QPointF) -> bool:
        """Whether a pixel of the widget shows a place of the plane."""
        return self.extent is not None and self.getPlotItem().isVisible() and self.inside.contains(at)

    # --- Mouse ----------------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Give the press to the tool, else to the plane."""
        if not self.grip.press(event):
            super().mousePressEvent(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Count as a press to a tool: two quick ones are not to show the whole plot."""
        if not self.grip.press(event):
            super().mouseDoubleClickEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Tell where the cursor is."""
        if not self.grip.move(event):
            super().mouseMoveEvent(event)
            if event.buttons() == Qt.MouseButton.NoButton:
                self._point(event)
        if self.is_over(event.position()):
            place = self.place_at(event.position())
            self.hovered.emit(place.x(), place.y())
        else:
            self.hover_ended.emit()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Let go."""
        if not self.grip.release(event):
            super().mouseReleaseEvent(event)

    def _point(self, event: QMouseEvent) -> None:
        if not self.is_over(event.position()):
            self.viewport().setCursor(Qt.CursorShape.ArrowCursor)
        elif not self.grip.hover(event):
            self.viewport().setCursor(self.cursor_at(event.position()))

    def cursor_at(self, at: QPointF) -> Qt.CursorShape:
        """Return the cursor that tells what a press at a pixel would do while there is no tool."""
        return Qt.CursorShape.ArrowCursor

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Give the wheel to the tool, else zoom."""
        if self.grip.wheel(event):
            event.accept()
        else:
            super().wheelEvent(event)

    def leaveEvent(self, event: QEvent) -> None:  # noqa: N802
        """Tell that the cursor has left."""
        super().leaveEvent(event)
        self.grip.leave()
        self.hover_ended.emit()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:  # noqa: N802
        """Open a menu by its key; the mouse asks for one by a click, as a drag pans."""
        event.accept()
        if event.reason() == QContextMenuEvent.Reason.Keyboard:
            self.menu_wanted.emit(self.inside.center())

    # --- Keyboard -------------------------------------------------------------------------------------------

    def event(self, event: QEvent) -> bool:
        """Keep F from the window, which would fit the 3-D views, and what the tool wants."""
        if event.type() == QEvent.Type.ShortcutOverride and self._keeps(event):
            event.accept()
            return True
        return bool(super().event(event))

    def _keeps(self, event: QEvent) -> bool:
        return isinstance(event, QKeyEvent) and (_fits(event) or self.grip.keeps(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Offer the key to the tool and to what is in the plane; else fit, zoom and pan."""
        if not (self.grip.key(event, is_down=True) or self.takes_key(event) or self._navigates(event)):
            QWidget.keyPressEvent(self, event)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Offer the key to the tool."""
        if not self.grip.key(event, is_down=False):
            QWidget.keyReleaseEvent(self, event)

    def takes_key(self, event: QKeyEvent) -> bool:
        """Do what a key means for what is in the plane; False for nothing."""
        return False

    def _navigates(self, event: QKeyEvent) -> bool:
        if _fits(event):
            self.fit()
        elif event.key() == Qt.Key.Key_Escape:
            self.escaped.emit()
        elif event.text() in ("+", "-"):
            self.pane.zoom(1 / KEY_ZOOM if event.text() == "+" else KEY_ZOOM)
        elif event.key() in _STEPS:
            self.pane.step(*_STEPS[Qt.Key(event.key())])
        else:
            return False
        return True


def _fits(event: QKeyEvent) -> bool:
    return event.key() == Qt.Key.Key_F and not event.modifiers()


_STEPS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, 1),
    Qt.Key.Key_Down: (0, -1),
}
