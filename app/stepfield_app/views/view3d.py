"""One 3-D view: shows the frames of the Open3D process and turns the mouse into a camera."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QApplication, QSizePolicy, QWidget

from stepfield_app.render.client import RenderClient
from stepfield_app.render.scene import Frame
from stepfield_app.scenes.legend import Legend
from stepfield_app.theme import DARK, Theme
from stepfield_app.views import navigation
from stepfield_app.views.lateness import UPDATING, Lateness
from stepfield_app.views.overlay import Overlay, small_font
from stepfield_app.views.recoloured import Recoloured
from stepfield_app.views.tool import Grip
from stepfield_app.views.viewpoint import Viewpoint

Place = tuple[float, float, float]

#: What a view says while it has no picture, by the state of the Open3D process.
SENTENCES = {
    "starting": "Starting the 3-D drawing…",
    "running": "Drawing…",
    "stopped": "The 3-D drawing has stopped and is coming back by itself.",
}


class Canvas(QWidget):
    """The picture of one view with its overlay; follows the shared viewpoint."""

    #: Local coordinates under the cursor, or None.
    hovered = Signal(object)
    #: Name of the view.
    resized = Signal(str)
    #: Logical pixel at which a menu should open.
    menu_wanted = Signal(QPointF)

    def __init__(
        self, name: str, client: RenderClient, viewpoint: Viewpoint, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.name = name
        self.grip: Grip[Canvas] = Grip(self, self)
        self._client, self._viewpoint = client, viewpoint
        self._theme, self._trouble = DARK, ""
        self._legend: Legend | None = None
        self._empty_text = ""
        self.recoloured = Recoloured(self)
        self.recoloured.changed.connect(self.update)
        self._lateness = Lateness(self)
        self._lateness.changed.connect(self.update)
        self._drag: navigation.Drag | None = None
        self._pressed = QPointF()
        self._button = Qt.MouseButton.NoButton
        self._zoom: tuple[QPointF, Place] | None = None
        self._deep: Frame | None = None
        self.setAccessibleName(f"3-D view: {name}")
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(120, 100)
        viewpoint.changed.connect(self._ask)
        client.frame_arrived.connect(self._show)
        client.state_changed.connect(self._tell)

    # --- What it shows --------------------------------------------------------------------------------------

    def set_theme(self, theme: Theme) -> None:
        """Paint the overlay in the colours of a theme."""
        self._theme = theme
        self.update()

    def set_legend(self, legend: Legend | None) -> None:
        """Say what the colours mean."""
        self._legend = legend
        self.update()

    def set_empty_text(self, text: str) -> None:
        """Say this in place of a picture; an empty text shows the picture."""
        self._empty_text = text
        self.update()

    def set_pending(self, is_pending: bool) -> None:
        """Mark the picture as of older parameters, unless the newer one arrives in a moment."""
        self._lateness.set_pending(is_pending)

    @property
    def frame(self) -> Frame | None:
        """The newest picture."""
        return self.recoloured.of(self._client.frame(self.name))

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height in device pixels."""
        ratio = self.devicePixelRatioF()
        return max(1, round(self.width() * ratio)), max(1, round(self.height() * ratio))

    def sizeHint(self) -> QSize:  # noqa: N802
        """Return a size that leaves three views side by side on a small screen."""
        return QSize(420, 320)

    def _ask(self) -> None:
        if self.isVisible():
            self._client.set_camera(self.name, self._viewpoint.camera, self.pixels, self._viewpoint.is_moving)

    def _show(self, name: str) -> None:
        if name == self.name:
            self._trouble = ""
            if self.frame is not None and self.frame.depth is not None:
                self._deep = self.frame
            self.update()

    def _tell(self, state: str) -> None:
        self._trouble = self._client.reason if state == "failed" else SENTENCES[state]
        if state == "running":
            self._trouble = ""
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint the newest picture and what lies over it."""
        painter = QPainter(self)
        painter.setFont(small_font(self.font()))
        frame, area = self.frame, QRectF(self.rect())
        overlay = Overlay(painter, area, self._theme)
        if frame is None or self._empty_text:
            painter.fillRect(self.rect(), QColor(self._theme.window))
            overlay.sentence(self._empty_text or self._trouble or SENTENCES["running"])
            return
        painter.drawImage(area, _image(frame))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self.grip.paint(painter)
        if self._legend is not None:
            overlay.legend(self._legend)
        overlay.scale(self._viewpoint.camera, self.pixels, self.devicePixelRatioF())
        overlay.axes(self._viewpoint.camera)
        if self._trouble:
            overlay.note(self._trouble, self._theme.warning)
        elif self._lateness:
            overlay.note(UPDATING, self._theme.muted)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Ask for a picture of the new size."""
        self._viewpoint.stir()
        self.resized.emit(self.name)

    # --- Mouse and keyboard ---------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Give the press to the tool, else hold the scene; one button at a time."""
        if self._drag is not None or self.grip.press(event):
            return
        self._button, self._pressed = event.button(), event.position()
        button = navigation.starts_drag(event.button(), event.modifiers())
        if button is not None:
            ratio = self.devicePixelRatioF()
            self._drag = navigation.Drag(self._viewpoint.camera, event.position(), button, self.pixels, ratio)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Follow the mouse."""
        if self.grip.move(event):
            self.hovered.emit(self.place_at(event.position()))
        elif self._drag is not None:
            self._viewpoint.look(self._drag.moved(event.position()))
        else:
            self._hover(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Let go, of what the button has taken hold; a right click that has not moved asks for a menu."""
        if self.grip.release(event) or event.button() != self._button:
            return
        was_held, self._drag = self._drag is not None, None
        way = (event.position() - self._pressed).manhattanLength()
        if (
            was_held
            and event.button() == Qt.MouseButton.RightButton
            and way < QApplication.startDragDistance()
        ):
            self.menu_wanted.emit(event.position())

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:  # noqa: N802
        """Open a menu by its key; the mouse asks for one by a click, as a drag pans."""
        event.accept()
        if event.reason() == QContextMenuEvent.Reason.Keyboard:
            self.menu_wanted.emit(QRectF(self.rect()).center())

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Turn around what was clicked from now on; to a tool it is one more press."""
        if self.grip.press(event):
            return
        place = self.place_at(event.position())
        if event.button() == Qt.MouseButton.LeftButton and place is not None:
            self._viewpoint.look(self._viewpoint.camera.with_centre(place))

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Give the wheel to the tool, else zoom to the cursor."""
        event.accept()
        if self.grip.wheel(event):
            return
        notches = event.angleDelta().y() / 120
        if notches:
            towards = self._zoom_target(event.position())
            self._viewpoint.look(navigation.zoomed(self._viewpoint.camera, notches, towards))

    def _zoom_target(self, at: QPointF) -> Place:
        """Keep to one place while the wheel turns: pictures on the way have no depth to pick another from."""
        if self._zoom is None or not self._viewpoint.is_moving or self._zoom[0] != at:
            self._zoom = at, self.place_at(at) or self._on_centre_plane(at)
        return self._zoom[1]

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Offer the key to the tool, else orbit, pan and zoom."""
        if self.grip.key(event, is_down=True):
            return
        camera = navigation.keyed(self._viewpoint.camera, event.key(), event.modifiers(), self.pixels)
        if camera is None:
            super().keyPressEvent(event)
        else:
            self._viewpoint.look(camera)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Offer the key to the tool."""
        if not self.grip.key(event, is_down=False):
            super().keyReleaseEvent(event)

    def leaveEvent(self, event: object) -> None:  # noqa: N802
        """Say that nothing is under the cursor."""
        self.grip.leave()
        self.hovered.emit(None)

    def _hover(self, event: QMouseEvent) -> None:
        if not self.grip.hover(event):
            self.setCursor(Qt.CursorShape.ArrowCursor)
        self.hovered.emit(self.place_at(event.position()))

    # --- Places ---------------------------------------------------------------------------------------------

    def place_at(self, at: QPointF) -> Place | None:
        """Return what the picture shows at a logical pixel, in local coordinates; None for background."""
        frame = self._frame_with_depth()
        if frame is None or frame.depth is None or not self.width() or not self.height():
            return None
        height, width = frame.depth.shape
        column, row = int(at.x() * width / self.width()), int(at.y() * height / self.height())
        if not (0 <= column < width and 0 <= row < height) or not frame.depth[row, column] > 0:
            return None
        x, y, z = frame.camera.unproject(
            column + 0.5, row + 0.5, float(frame.depth[row, column]), (width, height)
        )
        return float(x), float(y), float(z)

    def _frame_with_depth(self) -> Frame | None:
        """Return the picture, or the last full one where this is a quick one from the same place."""
        frame, deep = self.frame, self._deep
        if frame is None or frame.depth is not None or deep is None or deep.camera != frame.camera:
            return frame
        return deep

    def pixel_of(self, place: Place) -> QPointF:
        """Return the logical pixel at which a place in local coordinates is drawn."""
        where, _ = self._viewpoint.camera.project([place], self.pixels)
        return QPointF(*where[0]) / self.devicePixelRatioF()

    @property
    def viewpoint(self) -> Viewpoint:
        """The camera it follows."""
        return self._viewpoint

    def _on_centre_plane(self, at: QPointF) -> Place:
        """Return the place under the cursor at the depth of the rotation centre."""
        camera, ratio = self._viewpoint.camera, self.devicePixelRatioF()
        x, y, z = camera.unproject(at.x() * ratio, at.y() * ratio, camera.distance, self.pixels)
        return float(x), float(y), float(z)


def _image(frame: Frame) -> QImage:
    """Wrap a frame's memory, which the caller keeps alive while it paints."""
    height, width = frame.pixels.shape[:2]
    return QImage(frame.pixels.data, width, height, frame.pixels.strides[0], QImage.Format.Format_RGB32)
