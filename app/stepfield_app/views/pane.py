"""The inside of a plot: knows what there is to see, pans and zooms over it."""

from __future__ import annotations

from typing import Any, Protocol

import pyqtgraph as pg
from PySide6.QtCore import QPointF, Qt, Signal

from stepfield_app.views.extent import Extent

#: Share of the extent left free around it when it is fitted.
MARGIN = 0.03
#: How far one can zoom: as a share of the extent at the nearest, as a multiple of it at the farthest.
NEAREST, FARTHEST = 1e-4, 20.0
#: Share of what is visible that one step moves.
STEP = 0.1


class DragTaker(Protocol):
    """Something in the plane, a line with ends, that takes drags of the left button before they pan."""

    def takes(self, event: Any) -> bool:
        """Say whether a drag is taken; asked at every move of it."""

    def drag(self, event: Any) -> None:
        """Follow a drag that was taken."""


class Pane(pg.ViewBox):  # type: ignore[misc]
    """Every button pans, the wheel zooms to the cursor, a double-click asks for everything.

    Parameters
    ----------
    equal_scales : bool
        Whether a metre is as long upwards as across.
    """

    fit_asked = Signal()
    #: Where the right button was clicked, pixels of the scene.
    menu_asked = Signal(QPointF)

    def __init__(self, equal_scales: bool) -> None:
        super().__init__(enableMenu=False, lockAspect=equal_scales)
        self.drag_taker: DragTaker | None = None
        self.extent: Extent | None = None
        self.is_touched = False
        self._equal_scales = equal_scales

    # --- Which part is visible ------------------------------------------------------------------------------

    def know(self, extent: Extent) -> None:
        """Know what there is to see, and how near and far one may go."""
        self.extent = extent
        sides = extent.width, extent.height
        across, up = (max(sides), max(sides)) if self._equal_scales else sides
        self.setLimits(
            maxXRange=across * FARTHEST,
            maxYRange=up * FARTHEST,
            minXRange=across * NEAREST,
            minYRange=up * NEAREST,
        )

    def forget(self) -> None:
        """Know nothing."""
        self.extent, self.is_touched = None, False

    def fit(self) -> None:
        """Show everything."""
        self.is_touched = False
        if self.extent is not None:
            self.setRange(self.extent.rectangle(), padding=MARGIN)

    @property
    def visible(self) -> Extent:
        """Which part is visible."""
        (left, right), (bottom, top) = self.viewRange()
        return Extent(left, bottom, right, top)

    def step(self, right: int, up: int) -> None:
        """Move what is visible by a step of the keys."""
        visible = self.visible
        self.shift(right * STEP * visible.width, up * STEP * visible.height)

    def shift(self, right: float, up: float) -> None:
        """Move what is visible, metres."""
        self.translateBy(x=right, y=up)
        self.is_touched = True

    def zoom(self, factor: float) -> None:
        """Show so many times as much, around the middle."""
        self.scaleBy((factor, factor))
        self.is_touched = True

    # --- Mouse ----------------------------------------------------------------------------------------------

    def mouseDragEvent(self, event: Any, axis: int | None = None) -> None:  # noqa: N802
        """Give the drag to what takes it, else pan."""
        event.accept()
        taker, is_left = self.drag_taker, event.button() == Qt.MouseButton.LeftButton
        if taker is not None and is_left and taker.takes(event):
            taker.drag(event)
            return
        shift = self.mapToView(event.lastPos()) - self.mapToView(event.pos())
        self.shift(shift.x(), shift.y())

    def wheelEvent(self, event: Any, axis: int | None = None) -> None:  # noqa: N802
        """Zoom to the cursor."""
        super().wheelEvent(event, axis)
        self.is_touched = True

    def mouseClickEvent(self, event: Any) -> None:  # noqa: N802
        """Fit on a double-click; ask for a menu with the right button."""
        if event.button() == Qt.MouseButton.RightButton:
            event.accept()
            self.menu_asked.emit(QPointF(event.scenePos()))
        elif event.double() and event.button() == Qt.MouseButton.LeftButton:
            event.accept()
            self.fit_asked.emit()
