"""The crop box in the 3-D views: drag a face, the result follows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from stepfield.parameters import Box
from stepfield_app.document import Document
from stepfield_app.edit import Gesture
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.scenes import crop
from stepfield_app.theme import Theme
from stepfield_app.views.tool import Cursor, Hand, Tool
from stepfield_app.views.trio import Trio
from stepfield_app.views.view3d import Canvas

#: Radius of a handle, and how near the cursor must come, logical pixels.
RADIUS, REACH = 5.0, 10.0


class CropTool(QObject, Tool[Canvas]):
    """A box with a handle on every face.

    Parameters
    ----------
    document : Document
    trio : Trio
    scene_feed : SceneFeed
        Knows the local origin.
    """

    def __init__(self, document: Document, trio: Trio, scene_feed: SceneFeed) -> None:
        super().__init__(trio)
        self._document, self._trio, self._scene_feed = document, trio, scene_feed
        self._theme: Theme | None = None
        self._held: tuple[crop.Handle, Box, QPointF] | None = None
        self._hovered: crop.Handle | None = None
        self._gesture: Gesture | None = None
        document.project_changed.connect(self._follow)

    def set_theme(self, theme: Theme) -> None:
        """Paint in the colours of a theme."""
        self._theme = theme

    def set_active(self, is_active: bool) -> None:
        """Show the box and take the mouse on its handles, or not; a drag ends where it is."""
        self._let_go()
        self._hovered = None
        for canvas in self._trio.canvases.values():
            if is_active:
                canvas.grip.tool = self
            elif canvas.grip.tool is self:
                canvas.grip.tool = None
        box = self.box
        local = self._local(np.reshape(box, (2, 3))) if is_active and box is not None else None
        self._trio.reach_for((local[0], local[1]) if local is not None else None)
        self._repaint()

    @property
    def box(self) -> Box | None:
        """The crop box, or all of the scan while there is none; scan coordinates, metres."""
        facts = self._document.facts
        return self._document.project.parameters.crop or (facts.bounds if facts else None)

    def place_of(self, view: Canvas, side: tuple[int, int, int]) -> QPointF:
        """Where a handle is drawn in a view, logical pixels; (0, 0, 0) is the middle of the box."""
        assert self.box is not None
        return QPointF(*self._pixels(view, np.array([crop.Handle(side).point(self.box)]))[0])

    # --- The mouse ------------------------------------------------------------------------------------------

    def press(self, view: Canvas, hand: Hand) -> bool:
        """Take hold of the handle under the cursor."""
        box, handle = self.box, self._handle_at(view, hand.at)
        if box is None or handle is None:
            return False
        self._held, self._gesture = (handle, box, hand.at), self._document.begin_gesture()
        return True

    def drag(self, view: Canvas, hand: Hand) -> None:
        """Move what is held, and no further than the scan reaches."""
        facts = self._document.facts
        if self._held is None or facts is None:
            return
        handle, box, start = self._held
        way = (hand.at - start) * view.devicePixelRatioF()
        origin = np.tile(self._scene_feed.origin, 2)
        local = crop.dragged_on_screen(
            _box(box - origin), handle, view.viewpoint.camera, view.pixels, way.x(), way.y()
        )
        moved = crop.within(_box(local + origin), facts.bounds)
        self._document.set_parameters("Crop", self._gesture, crop=moved)

    def release(self, view: Canvas, hand: Hand) -> None:
        """Let go: one undo step a drag."""
        self._let_go()

    def _let_go(self) -> None:
        if self._gesture is not None:
            self._document.end_gesture(self._gesture)
        self._held = self._gesture = None

    def hover(self, view: Canvas, hand: Hand) -> Cursor | None:
        """Say by the cursor whether a handle is under it, and light it."""
        handle = self._handle_at(view, hand.at)
        if handle != self._hovered:
            self._hovered = handle
            self._repaint()
        return None if handle is None else Qt.CursorShape.PointingHandCursor

    def _handle_at(self, view: Canvas, at: QPointF) -> crop.Handle | None:
        box = self.box
        if box is None:
            return None
        places = self._pixels(view, np.array([handle.point(box) for handle in crop.HANDLES]))
        away = np.hypot(places[:, 0] - at.x(), places[:, 1] - at.y())
        nearest = int(np.argmin(away))
        return crop.HANDLES[nearest] if away[nearest] <= REACH else None

    # --- Painting -------------------------------------------------------------------------------------------

    def paint(self, view: Canvas, painter: QPainter) -> None:
        """Paint the box over a view: what lies behind shows through."""
        box = self.box
        if box is None or self._theme is None:
            return
        painter.setPen(QPen(QColor(self._theme.accent), 1.2))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        corners = self._pixels(view, np.array([corner.point(box) for corner in crop.CORNERS]))
        for one, other in crop.EDGES:
            painter.drawLine(QPointF(*corners[one]), QPointF(*corners[other]))
        places = self._pixels(view, np.array([handle.point(box) for handle in crop.HANDLES]))
        for handle, place in zip(crop.HANDLES, places, strict=True):
            is_lit = handle == self._hovered or (self._held is not None and handle == self._held[0])
            painter.setBrush(QColor(self._theme.accent if is_lit else self._theme.window))
            painter.drawEllipse(QPointF(*place), RADIUS, RADIUS)

    def _pixels(self, view: Canvas, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Logical pixels of places in scan coordinates, shape (n, 2)."""
        pixels, _ = view.viewpoint.camera.project(self._local(places), view.pixels)
        return np.asarray(pixels) / view.devicePixelRatioF()

    def _local(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        local: NDArray[np.float64] = places - self._scene_feed.origin
        return local

    def _follow(self) -> None:
        """Paint the box where it is now, if it is shown: three pictures a step of a slider take long."""
        if any(canvas.grip.tool is self for canvas in self._trio.canvases.values()):
            self._repaint()

    def _repaint(self) -> None:
        for canvas in self._trio.canvases.values():
            canvas.update()


def _box(values: NDArray[np.float64]) -> Box:
    x0, y0, z0, x1, y1, z1 = values.tolist()
    return x0, y0, z0, x1, y1, z1
