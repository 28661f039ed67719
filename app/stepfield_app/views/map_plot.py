"""The plane of the map: the picture of a layer, and the line a profile is cut along."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QDragEnterEvent,
    QDragLeaveEvent,
    QDragMoveEvent,
    QDropEvent,
    QKeyEvent,
    QPainter,
    QPolygonF,
)
from PySide6.QtWidgets import QWidget

from stepfield_app.style_sheet import mixed
from stepfield_app.theme import Theme
from stepfield_app.views.drop import DropSite, paint_offer
from stepfield_app.views.extent import Extent
from stepfield_app.views.line import Part, ProfileLine, paint_line, paint_mark, part_at
from stepfield_app.views.outlines import SelectedCells
from stepfield_app.views.overlay import Overlay
from stepfield_app.views.pictures import MapPicture
from stepfield_app.views.plot import Plot

HINT = "Drag to draw the line; Enter draws one across"
#: Share of the text's colour in that of holes: apart from black, from white and from what is beside the map.
HOLE = 0.14


class MapPlot(Plot):
    """Shows a map north up, and lets a profile line be drawn and dragged."""

    #: The ProfileLine, or None once it is taken away; while dragging at every move.
    line_changed = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        self._picture, self.selected = Picture(), SelectedCells()
        super().__init__("x", "y", equal_scales=True, parent=parent)
        self.is_drawing = False
        self.line_width = 1.0
        self.line: ProfileLine | None = None
        self.mark: tuple[float, float] | None = None
        self._held: tuple[Part, ProfileLine] | None = None
        self._drop_site: DropSite | None = None
        self._is_offered = False
        for item in (self._picture, self.selected):
            self.addItem(item, ignoreBounds=True)
        self.pane.drag_taker = self

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        super().set_theme(theme)
        self._picture.set_ground(QColor(mixed(theme.window, theme.text, HOLE)))

    def show_picture(self, picture: MapPicture) -> None:
        """Show another map, keeping the zoom unless it is the first since :meth:`forget`."""
        extent = Extent(picture.west, picture.south, picture.east, picture.north)
        self._picture.show_pixels(picture.pixels, extent.rectangle())
        self.set_extent(extent, keep_zoom=True)

    def forget(self) -> None:
        """Take everything away: the next picture is of another scan."""
        super().forget()
        self._picture.clear()
        self.selected.set_marked(None)
        self.set_line(None)

    # --- The line -------------------------------------------------------------------------------------------

    def set_line(self, line: ProfileLine | None) -> None:
        """Draw a line, or none, and tell."""
        if line != self.line:
            self.line = line
            self.viewport().update()
            self.line_changed.emit(line)

    def set_line_width(self, width: float) -> None:
        """Make the band wider or narrower, now and for the next line."""
        self.line_width = width
        if self.line is not None:
            self.set_line(replace(self.line, width=width))

    def set_mark(self, place: tuple[float, float] | None) -> None:
        """Mark a place, or none."""
        if place != self.mark:
            self.mark = place
            self.viewport().update()

    def draw_across(self) -> None:
        """Draw a line through the middle of what is visible, from west to east."""
        visible = self.visible
        middle = (visible.bottom + visible.top) / 2
        ends = (visible.left + visible.width * share for share in (0.2, 0.8))
        start, end = ((x, middle) for x in ends)
        self.set_line(ProfileLine(start, end, self.line_width))

    def takes(self, event: Any) -> bool:
        """Say whether a drag belongs to the line, and take hold of it."""
        if event.isStart():
            self._held = self._taken(event.buttonDownScenePos())
        return self._held is not None

    def drag(self, event: Any) -> None:
        """Follow the mouse with what was taken hold of."""
        assert self._held is not None
        part, before = self._held
        shift = self.place_at(event.scenePos()) - self.place_at(event.buttonDownScenePos())
        self.set_line(before.moved(part, shift.x(), shift.y()))
        if event.isFinish():
            self._held = None

    def _taken(self, at: QPointF) -> tuple[Part, ProfileLine] | None:
        part = self._part_at(at)
        if part is not None and self.line is not None:
            return part, self.line
        if not self.is_drawing or self.extent is None:
            return None
        place = self.place_at(at).toTuple()
        return "end", ProfileLine(place, place, self.line_width)

    def _part_at(self, at: QPointF) -> Part | None:
        if self.line is None:
            return None
        return part_at(self.pixel_of(*self.line.start), self.pixel_of(*self.line.end), at)

    def paint_over(self, painter: QPainter, area: QRectF) -> None:
        """Paint the line, then the legend over it."""
        if self.line is not None:
            painter.save()
            painter.setClipRect(area)
            ends = self.pixel_of(*self.line.start), self.pixel_of(*self.line.end)
            band = QPolygonF([self.pixel_of(*corner) for corner in self.line.corners()])
            paint_line(painter, ends, band, self.theme)
            if self.mark is not None:
                paint_mark(painter, self.pixel_of(*self.mark), self.theme)
            painter.restore()
        super().paint_over(painter, area)
        if self.is_drawing and self.line is None:
            Overlay(painter, area, self.theme).note(HINT, self.theme.text)
        if self._is_offered and self._drop_site is not None:
            paint_offer(painter, area, self._drop_site.offer(), self.theme)

    # --- Drops ----------------------------------------------------------------------------------------------

    def set_drop_site(self, site: DropSite) -> None:
        """Let something be dropped on the map."""
        self._drop_site = site
        self.let_drop(True)
        site.offer_changed.connect(self.viewport().update)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:  # noqa: N802
        """Consider what is dragged over the map; leave files to the window."""
        self._is_offered = self._drop_site is not None and self._drop_site.knows(event.mimeData())
        self.dragMoveEvent(event)

    def dragMoveEvent(self, event: QDragMoveEvent) -> None:  # noqa: N802
        """Say what a drop would do."""
        if self._drop_site is not None and self._is_offered:
            event.setDropAction(Qt.DropAction.MoveAction)
            event.setAccepted(True)  # also where nothing could be done: the map says why
            self.viewport().update()
        else:
            event.ignore()

    def dragLeaveEvent(self, event: QDragLeaveEvent) -> None:  # noqa: N802
        """Say nothing any more."""
        self._is_offered = False
        self.viewport().update()

    def dropEvent(self, event: QDropEvent) -> None:  # noqa: N802
        """Take what was dropped."""
        if self._drop_site is not None and self._is_offered:
            self._is_offered = False
            event.acceptProposedAction()
            self._drop_site.drop()
            self.viewport().update()

    # --- Mouse and keyboard ---------------------------------------------------------------------------------

    def cursor_at(self, at: QPointF) -> Qt.CursorShape:
        """Show by the cursor what a press would do."""
        if self._part_at(at) is not None:
            return Qt.CursorShape.SizeAllCursor
        return Qt.CursorShape.CrossCursor if self.is_drawing else Qt.CursorShape.ArrowCursor

    def takes_key(self, event: QKeyEvent) -> bool:
        """Draw a line with Enter, take it away with Delete, move its end with Shift and arrows."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.is_drawing and self.extent:
            self.draw_across()
        elif event.key() == Qt.Key.Key_Delete and self.line is not None:
            self.set_line(None)
        else:
            return bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier) and self._nudge(event.key())
        return True

    def _nudge(self, key: int) -> bool:
        """Move the end of the line by Shift and an arrow, five pixels at a time."""
        step = _NUDGES.get(Qt.Key(key))
        if step is None or self.line is None:
            return False
        size = self.pane.viewPixelSize()
        self.set_line(self.line.moved("end", step[0] * size[0], step[1] * size[1]))
        return True


_NUDGES = {
    Qt.Key.Key_Left: (-5, 0),
    Qt.Key.Key_Right: (5, 0),
    Qt.Key.Key_Up: (0, 5),
    Qt.Key.Key_Down: (0, -5),
}


class Picture(pg.ImageItem):  # type: ignore[misc]
    """An image with crisp compartments when enlarged, smooth when there are more of them than pixels."""

    _ground = QColor()

    def show_pixels(self, pixels: Any, place: QRectF) -> None:
        """Show an image of shape (rows, columns, 4), its first row at the upper edge of ``place``."""
        self.setImage(pixels, levels=None, autoLevels=False)
        rows, columns = pixels.shape[:2]
        upright = pg.QtGui.QTransform.fromTranslate(place.left(), place.bottom())  # y grows upwards here
        upright.scale(place.width() / columns, -place.height() / rows)
        self.setTransform(upright)

    def set_ground(self, colour: QColor) -> None:
        """Take the colour that shows through holes."""
        self._ground = colour
        self.update()

    def paint(self, painter: QPainter, *rest: Any) -> None:
        """Paint, smoothly where the image is made smaller."""
        if self.image is None:
            return
        painter.fillRect(self.boundingRect(), self._ground)
        scale = abs(painter.combinedTransform().m11())
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, scale < 1)
        super().paint(painter, *rest)
