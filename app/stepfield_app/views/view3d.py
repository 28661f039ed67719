"""One 3-D view: shows the frames of the Open3D process and turns the mouse into a camera."""

from __future__ import annotations

from typing import Protocol

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QColor,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from stepfield_app.render.client import RenderClient
from stepfield_app.render.scene import Frame
from stepfield_app.scenes.legend import Legend
from stepfield_app.theme import DARK, Theme
from stepfield_app.views import navigation
from stepfield_app.views.overlay import Overlay, small_font
from stepfield_app.views.viewpoint import Viewpoint

Place = tuple[float, float, float]

#: Milliseconds that pass before a newer result that is under way is mentioned: most arrive sooner.
PATIENCE = 250

#: What a view says while it has no picture, by the state of the Open3D process.
SENTENCES = {
    "starting": "Starting the 3-D drawing…",
    "running": "Drawing…",
    "stopped": "The 3-D drawing has stopped and is coming back by itself.",
}


class Tool(Protocol):
    """Something that takes the mouse before the camera does, and paints over the picture."""

    def press(self, view: Canvas, at: QPointF) -> bool:
        """Take the press, or leave it to the camera."""

    def drag(self, view: Canvas, at: QPointF) -> None:
        """Follow the mouse after a press that was taken."""

    def release(self) -> None:
        """Let go."""

    def hover(self, view: Canvas, at: QPointF) -> bool:
        """Say whether a press here would be taken."""

    def paint(self, view: Canvas, painter: QPainter) -> None:
        """Paint over the picture."""


class Canvas(QWidget):
    """The picture of one view with its overlay; follows the shared viewpoint."""

    #: Local coordinates under the cursor, or None.
    hovered = Signal(object)
    #: Name of the view.
    resized = Signal(str)

    def __init__(
        self, name: str, client: RenderClient, viewpoint: Viewpoint, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.name = name
        self.tool: Tool | None = None
        self._client, self._viewpoint = client, viewpoint
        self._theme, self._trouble = DARK, ""
        self._legend: Legend | None = None
        self._empty_text, self._is_late = "", False
        self._patience = QTimer(self, singleShot=True, interval=PATIENCE)
        self._patience.timeout.connect(self._mention)
        self._drag: navigation.Drag | None = None
        self._tool_has_mouse = False
        self._button = Qt.MouseButton.NoButton
        self._zoom: tuple[QPointF, Place] | None = None
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
        if not is_pending:
            self._patience.stop()
            self._is_late = False
            self.update()
        elif not self._is_late and not self._patience.isActive():
            self._patience.start()

    def _mention(self) -> None:
        self._is_late = True
        self.update()

    @property
    def frame(self) -> Frame | None:
        """The newest picture."""
        return self._client.frame(self.name)

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
        if self.tool is not None:
            self.tool.paint(self, painter)
        if self._legend is not None:
            overlay.legend(self._legend)
        overlay.scale(self._viewpoint.camera, self.pixels, self.devicePixelRatioF())
        overlay.axes(self._viewpoint.camera)
        if self._trouble:
            overlay.note(self._trouble, self._theme.warning)
        elif self._is_late:
            overlay.note("updating…", self._theme.muted)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Ask for a picture of the new size."""
        self._viewpoint.stir()
        self.resized.emit(self.name)

    # --- Mouse and keyboard ---------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Give the press to the tool, else hold the scene; one button at a time."""
        if self._is_held:
            return
        self._button = event.button()
        is_left = event.button() == Qt.MouseButton.LeftButton
        if is_left and self.tool is not None and self.tool.press(self, event.position()):
            self._tool_has_mouse = True
            return
        button = navigation.starts_drag(event.button(), event.modifiers())
        if button is not None:
            ratio = self.devicePixelRatioF()
            self._drag = navigation.Drag(self._viewpoint.camera, event.position(), button, self.pixels, ratio)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Follow the mouse."""
        if self._tool_has_mouse and self.tool is not None:
            self.tool.drag(self, event.position())
        elif self._drag is not None:
            self._viewpoint.look(self._drag.moved(event.position()))
        else:
            self._hover(event.position())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Let go, of what the button has taken hold."""
        if event.button() != self._button:
            return
        if self._tool_has_mouse and self.tool is not None:
            self.tool.release()
        self._tool_has_mouse, self._drag = False, None

    @property
    def _is_held(self) -> bool:
        return self._tool_has_mouse or self._drag is not None

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Turn around what was clicked from now on."""
        place = self.place_at(event.position())
        if event.button() == Qt.MouseButton.LeftButton and place is not None:
            self._viewpoint.look(self._viewpoint.camera.with_centre(place))

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Zoom to the cursor."""
        notches = event.angleDelta().y() / 120
        if notches:
            towards = self._zoom_target(event.position())
            self._viewpoint.look(navigation.zoomed(self._viewpoint.camera, notches, towards))
        event.accept()

    def _zoom_target(self, at: QPointF) -> Place:
        """Keep to one place while the wheel turns: pictures on the way have no depth to pick another from."""
        if self._zoom is None or not self._viewpoint.is_moving or self._zoom[0] != at:
            self._zoom = at, self.place_at(at) or self._on_centre_plane(at)
        return self._zoom[1]

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Orbit, pan and zoom by keys."""
        camera = navigation.keyed(self._viewpoint.camera, event.key(), event.modifiers(), self.pixels)
        if camera is None:
            super().keyPressEvent(event)
        else:
            self._viewpoint.look(camera)

    def leaveEvent(self, event: object) -> None:  # noqa: N802
        """Say that nothing is under the cursor."""
        self.hovered.emit(None)

    def _hover(self, at: QPointF) -> None:
        would_take = self.tool is not None and self.tool.hover(self, at)
        self.setCursor(Qt.CursorShape.PointingHandCursor if would_take else Qt.CursorShape.ArrowCursor)
        self.hovered.emit(self.place_at(at))

    # --- Places ---------------------------------------------------------------------------------------------

    def place_at(self, at: QPointF) -> Place | None:
        """Return what the picture shows at a logical pixel, in local coordinates; None for background."""
        frame = self.frame
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
