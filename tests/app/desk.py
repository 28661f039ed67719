"""A document on a desk: the views, a selection and its tools; and a hand to work them with."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import (
    QKeyEvent,
    QMouseEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import table
from tests.app.stubs import Bench, floor_frame

from stepfield_app.editor import Editor
from stepfield_app.feeds.plots import Cutting, MapWish, SectionWish, map_picture
from stepfield_app.render.scene import PILLARS
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.selection import Selection
from stepfield_app.tools.select import SelectTools, Views
from stepfield_app.views.line import ProfileLine
from stepfield_app.views.map import MapView
from stepfield_app.views.profile import ProfileView
from stepfield_app.views.status import Status

LEFT, RIGHT, NOBODY = Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton, Qt.MouseButton.NoButton
PLAIN, SHIFT = Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ShiftModifier
ALT, CTRL = Qt.KeyboardModifier.AltModifier, Qt.KeyboardModifier.ControlModifier
Way = list[QPointF]
#: The table of ``scenes_made``: 16 by 12 floor cells of half a metre, of which 6 by 4 have a top above.
FLOOR, TOP = 192, 24


class Desk(Bench):
    """A bench with a map, a profile through the middle of the table, a selection and its tools."""

    def __init__(self, qtbot: QtBot, scan: Path) -> None:
        super().__init__(qtbot)
        answer = self.open(scan, cell_size=0.5, layer_tolerance=0.3, alpha=0.5)
        self.corner = np.array(answer.result.scan.bounds()[0])
        self.trio.set_parallel(True)
        self.trio.look_from("top")
        self.status, self.map, self.profile = Status(), MapView(), ProfileView()
        for view in (self.map, self.profile, self.status):
            qtbot.addWidget(view)
            view.setAttribute(Qt.WidgetAttribute.WA_DontShowOnScreen)
            view.resize(560, 440)
            view.show()
        self.selection = Selection(self.document)
        self.editor = Editor(self.document, self.selection)
        self.visible: tuple[int, ...] = (0, 1, -1)
        views = Views(self.trio, self.map, self.profile, self.status)
        self.tools = SelectTools(
            self.document, self.selection, self.editor, views, self.scene_feed, lambda: self.visible
        )
        qtbot.addWidget(self.tools.strip)
        self.show_map(0)
        self._cut()
        for name, canvas in self.trio.canvases.items():
            self.client.deliver(name, floor_frame(self.trio.viewpoint.camera, canvas.pixels))

    def show_map(self, layer: int) -> None:
        """Show the map of a layer, as its feed does."""
        answer = self.document.answer
        assert answer is not None
        self.document.set_active_layer(layer)
        colours = layer_colours(len(answer.result.layers), ())
        self.map.set_picture(map_picture(MapWish(answer, layer, "gray", colours), lambda *_: None))

    def _cut(self) -> None:
        answer, cloud = self.document.answer, self.scene_feed.cloud
        assert answer is not None
        assert cloud is not None
        x, y = self.corner[:2]
        line = ProfileLine((x, y + 3.1), (x + 8, y + 3.1), 0.5)
        wish = SectionWish(answer, cloud, line, layer_colours(len(answer.result.layers), ()))
        self.profile.set_section(Cutting()(wish, lambda *_: None))

    def rest(self) -> None:
        """Wait until nothing is being worked out."""
        self.qtbot.waitUntil(lambda: not self.selection.busy and self.tools.is_idle and self.editor.is_idle)

    def on_map(self, *places: tuple[float, float]) -> Way:
        """Pixels of places, metres from the corner of the scan."""
        x, y = self.corner[:2]
        return [self.map.plot.pixel_of(x + east, y + north) for east, north in places]

    def in_profile(self, *places: tuple[float, float]) -> Way:
        """Pixels of places: metres along the line, elevation above the floor."""
        return [self.profile.plot.pixel_of(along, self.corner[2] + up) for along, up in places]

    def in_view(self, *places: tuple[float, float, float], name: str = PILLARS) -> Way:
        """Pixels of places in local coordinates."""
        return [self.trio.canvases[name].pixel_of(place) for place in places]

    def taken(self) -> dict[int, int]:
        """How many pillars of each layer are selected, once that is known."""
        self.rest()
        return self.selection.by_layer

    def close(self) -> None:
        self.tools.close()
        self.editor.close()
        self.selection.close()
        super().close()


def desk_at(corner: tuple[float, float, float], qtbot: QtBot, folder: Path) -> Iterator[Desk]:
    """Make a desk with the table at a place, and clear it away afterwards."""
    path = folder / "table.npy"
    np.save(path, table(corner))
    desk = Desk(qtbot, path)
    yield desk
    desk.close()


def mouse(
    widget: QWidget, kind: QEvent.Type, at: QPointF, button: Qt.MouseButton, keys: Qt.KeyboardModifier = PLAIN
) -> None:
    is_move, is_release = kind == QEvent.Type.MouseMove, kind == QEvent.Type.MouseButtonRelease
    own, held = NOBODY if is_move else button, NOBODY if is_release else button
    QApplication.sendEvent(widget, QMouseEvent(kind, at, widget.mapToGlobal(at), own, held, keys))


def hold(widget: QWidget, way: Way, keys: Qt.KeyboardModifier = PLAIN, button: Qt.MouseButton = LEFT) -> None:
    """Press and move, in small steps as a hand does, without letting go."""
    mouse(widget, QEvent.Type.MouseButtonPress, way[0], button, keys)
    for one, other in pairwise(way):
        for share in np.linspace(0.1, 1, 10):
            mouse(widget, QEvent.Type.MouseMove, one + (other - one) * float(share), button, keys)


def draw(widget: QWidget, way: Way, keys: Qt.KeyboardModifier = PLAIN, button: Qt.MouseButton = LEFT) -> None:
    """Drag along a way and let go."""
    hold(widget, way, keys, button)
    mouse(widget, QEvent.Type.MouseButtonRelease, way[-1], button, keys)


def hover(widget: QWidget, at: QPointF, keys: Qt.KeyboardModifier = PLAIN) -> None:
    mouse(widget, QEvent.Type.MouseMove, at, NOBODY, keys)


def turn(widget: QWidget, at: QPointF, keys: Qt.KeyboardModifier, notches: int = 1) -> None:
    place, angle, phase = widget.mapToGlobal(at), QPoint(0, 120 * notches), Qt.ScrollPhase.NoScrollPhase
    QApplication.sendEvent(widget, QWheelEvent(at, place, QPoint(), angle, NOBODY, keys, phase, False))


def press(widget: QWidget, key: Qt.Key, keys: Qt.KeyboardModifier = PLAIN, *, is_down: bool = True) -> None:
    kind = QEvent.Type.KeyPress if is_down else QEvent.Type.KeyRelease
    QApplication.sendEvent(widget, QKeyEvent(kind, key, keys))
