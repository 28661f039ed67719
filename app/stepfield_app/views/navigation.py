"""Mouse and keyboard to camera: left orbits, middle or right pans, the wheel zooms to the cursor."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QPointF, Qt

from stepfield_app.render.camera import Camera

#: Zoom of one notch of the wheel.
NOTCH = 1.15
#: Degrees and pixels of one press of an arrow key.
STEP_DEGREES, STEP_PIXELS = 10.0, 40.0

ARROWS = {
    Qt.Key.Key_Left: (-1.0, 0.0),
    Qt.Key.Key_Right: (1.0, 0.0),
    Qt.Key.Key_Up: (0.0, -1.0),
    Qt.Key.Key_Down: (0.0, 1.0),
}


class Drag:
    """A hand holding the scene: what the camera becomes as the mouse moves."""

    def __init__(
        self, camera: Camera, at: QPointF, button: Qt.MouseButton, size: tuple[int, int], ratio: float
    ) -> None:
        self._camera, self._from, self._size, self._ratio = camera, at, size, ratio
        self._orbits = button == Qt.MouseButton.LeftButton

    def moved(self, at: QPointF) -> Camera:
        """Camera after the mouse has come to ``at``, logical pixels."""
        way = (at - self._from) * self._ratio
        if self._orbits:
            return self._camera.orbited(way.x() / self._ratio, way.y() / self._ratio)
        return self._camera.panned(way.x(), way.y(), self._size)


def starts_drag(button: Qt.MouseButton, modifiers: Qt.KeyboardModifier) -> Qt.MouseButton | None:
    """Return which drag a button starts: Shift makes a pan of the left one, for mice that have no other."""
    if button == Qt.MouseButton.LeftButton and modifiers & Qt.KeyboardModifier.ShiftModifier:
        return Qt.MouseButton.MiddleButton
    if button in (Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton, Qt.MouseButton.RightButton):
        return button
    return None


def zoomed(camera: Camera, notches: float, towards: tuple[float, float, float] | None) -> Camera:
    """Camera after the wheel has turned; positive comes nearer."""
    return camera.zoomed(NOTCH**notches, towards)


def keyed(camera: Camera, key: int, modifiers: Qt.KeyboardModifier, size: tuple[int, int]) -> Camera | None:
    """Camera after a key: arrows orbit, with Shift they pan, plus and minus zoom; None for other keys."""
    steps: dict[int, Callable[[], Camera]] = {
        Qt.Key.Key_Plus: lambda: camera.zoomed(NOTCH, None),
        Qt.Key.Key_Equal: lambda: camera.zoomed(NOTCH, None),
        Qt.Key.Key_Minus: lambda: camera.zoomed(1 / NOTCH, None),
    }
    if key in steps:
        return steps[key]()
    arrow = ARROWS.get(Qt.Key(key)) if key in set(ARROWS) else None
    if arrow is None:
        return None
    x, y = arrow
    if modifiers & Qt.KeyboardModifier.ShiftModifier:
        return camera.panned(-x * STEP_PIXELS, -y * STEP_PIXELS, size)
    return camera.looking(camera.azimuth + x * STEP_DEGREES, camera.elevation - y * STEP_DEGREES)
