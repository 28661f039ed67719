"""The map: what it shows, what it asks for, and the profile line."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from stepfield_app.ramps import ramp
from stepfield_app.scenes.legend import Legend
from stepfield_app.theme import LIGHT
from stepfield_app.views.line import ProfileLine, part_at
from stepfield_app.views.map import MapView
from stepfield_app.views.pictures import MapPicture

SIZE = 520, 420


def picture(rows: int = 40, columns: int = 60, west: float = 84_600.0, name: str = "Layer 2") -> MapPicture:
    """Draw a map whose north-west quarter is red and whose rest is blue, cells of half a metre."""
    pixels = np.zeros((rows, columns, 4), np.uint8)
    pixels[:] = 0, 0, 255, 255
    pixels[: rows // 2, : columns // 2] = 255, 0, 0, 255
    east, north = west + columns / 2, 447_000.0 + rows / 2
    legend = Legend("Elevation", "m", ramp("height"), low=1.0, high=2.0)
    return MapPicture(1, name, "#009e73", pixels, west, 447_000.0, east, north, 0.5, legend)


pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks


@pytest.fixture
def view(qtbot: QtBot) -> MapView:
    view = MapView()
    qtbot.addWidget(view)
    view.setAttribute(Qt.WidgetAttribute.WA_DontShowOnScreen)
    view.resize(*SIZE)
    view.show()
    return view


def drag(view: MapView, start: tuple[float, float], end: tuple[float, float], button: Qt.MouseButton) -> None:
    """Drag between places of the map, in small steps as a hand does."""
    viewport = view.plot.viewport()
    first, last = view.plot.pixel_of(*start), view.plot.pixel_of(*end)
    send(viewport, "press", first, button)
    for share in np.linspace(0.1, 1, 10):
        send(viewport, "move", first + (last - first) * float(share), button)
    send(viewport, "release", last, button)


def send(viewport: QWidget, what: str, at: QPointF, button: Qt.MouseButton) -> None:
    kind = {
        "press": QEvent.Type.MouseButtonPress,
        "move": QEvent.Type.MouseMove,
        "release": QEvent.Type.MouseButtonRelease,
    }[what]
    held = Qt.MouseButton.NoButton if what == "release" else button
    own = Qt.MouseButton.NoButton if what == "move" else button
    event = QMouseEvent(kind, at, viewport.mapToGlobal(at), own, held, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(viewport, event)


def colour_at(view: MapView, x: float, y: float) -> QColor:
    """Colour on the screen of a place of the map."""
    pixel = view.plot.pixel_of(x, y)
    image = view.plot.grab().toImage()
    colour: QColor = image.pixelColor((pixel * image.devicePixelRatioF()).toPoint())
    return colour


def test_row_0_is_drawn_north_west(view: MapView) -> None:
    """A map upside down or mirrored would send robots the wrong way."""
    view.set_picture(picture())
    assert colour_at(view, 84_603, 447_017) == QColor(255, 0, 0)
    assert colour_at(view, 84_627, 447_017) == QColor(0, 0, 255)
    assert colour_at(view, 84_603, 447_003) == QColor(0, 0, 255)


def test_room_that_is_left_to_a_legend_has_one(view: MapView) -> None:
    """In a low window it stayed empty."""
    view.set_picture(picture())
    view.resize(400, 240)
    plot = view.plot.grab().toImage()
    beside = [plot.pixelColor(x, y) for x in range(plot.width() - 60, plot.width()) for y in range(100)]
    assert len({colour.name() for colour in beside}) > 10


def test_a_metre_is_as_long_up_as_across(view: MapView) -> None:
    """Unequal scales would make square compartments oblong."""
    view.set_picture(picture())
    across, up = view.plot.pane.viewPixelSize()
    assert across == pytest.approx(up, rel=0.01)


def test_another_result_keeps_the_zoom_and_another_scan_is_fitted(view: MapView) -> None:
    """Losing the zoom at every tick of a slider would make tuning by eye impossible."""
    view.set_picture(picture())
    view.plot.pane.setRange(xRange=(84_605, 84_610), yRange=(447_005, 447_010), padding=0)
    zoomed = view.plot.visible
    view.set_picture(picture(columns=62))
    assert view.plot.visible == zoomed
    view.clear()
    view.set_picture(picture(west=500.0))
    assert view.plot.visible.left < 500.0 < 530.0 < view.plot.visible.right


def test_the_wheel_zooms_to_the_cursor(view: MapView) -> None:
    """The place under the cursor would slip away otherwise."""
    view.set_picture(picture())
    at = view.plot.pixel_of(84_610, 447_005)
    before, width = view.plot.place_at(at), view.plot.visible.width
    none, phase = Qt.KeyboardModifier.NoModifier, Qt.ScrollPhase.NoScrollPhase
    place = view.plot.viewport().mapToGlobal(at)
    event = QWheelEvent(at, place, QPoint(), QPoint(0, 120), Qt.MouseButton.NoButton, none, phase, False)
    QApplication.sendEvent(view.plot.viewport(), event)
    after = view.plot.place_at(at)
    assert view.plot.visible.width < width
    assert (after.x(), after.y()) == pytest.approx((before.x(), before.y()), abs=0.02)


@pytest.mark.parametrize(
    "button", [Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton, Qt.MouseButton.RightButton]
)
def test_every_button_pans(view: MapView, button: Qt.MouseButton) -> None:
    """Habits of other programs would not carry over."""
    view.set_picture(picture())
    width, left = view.plot.visible.width, view.plot.visible.left
    drag(view, (84_610, 447_010), (84_620, 447_010), button)
    assert view.plot.visible.width == pytest.approx(width)
    assert view.plot.visible.left < left - 5


def test_f_shows_everything_again(view: MapView, qtbot: QtBot) -> None:
    """There would be no way back from a deep zoom by keys."""
    view.set_picture(picture())
    view.plot.pane.setRange(xRange=(84_605, 84_606), yRange=(447_005, 447_006), padding=0)
    QTest.keyClick(view.plot, Qt.Key.Key_F)
    assert view.plot.visible.width > 30


def test_the_cursor_is_told_in_scan_coordinates(view: MapView, qtbot: QtBot) -> None:
    """The status bar would show a wrong place."""
    view.set_picture(picture())
    with qtbot.waitSignal(view.cursor_moved) as moved:
        send(view.plot.viewport(), "move", view.plot.pixel_of(84_612, 447_007), Qt.MouseButton.NoButton)
    assert moved.args == pytest.approx([84_612, 447_007], abs=0.1)


def test_another_mode_is_asked_for(view: MapView, qtbot: QtBot) -> None:
    """Choosing a mode would do nothing."""
    view.set_picture(picture())
    with qtbot.waitSignal(view.picture_wanted) as wanted:
        view.set_mode("hillshade")
    assert wanted.args == [1, "hillshade"]


def test_a_line_is_drawn_by_a_drag_and_told_all_the_way(view: MapView) -> None:
    """The profile would not follow the hand."""
    view.set_picture(picture())
    told: list[tuple[object, object, float]] = []
    view.section_wanted.connect(lambda start, end, width: told.append((start, end, width)))
    view.set_drawing(True)
    drag(view, (84_605, 447_005), (84_625, 447_015), Qt.MouseButton.LeftButton)
    assert len({end for _, end, _ in told}) >= 2
    start, end, width = told[-1]
    assert start == pytest.approx((84_605, 447_005), abs=0.1)
    assert end == pytest.approx((84_625, 447_015), abs=0.1)
    assert width == 1.0  # two compartments


def test_an_end_of_the_line_can_be_dragged_without_the_tool(view: MapView) -> None:
    """A line could be corrected only by drawing it anew."""
    view.set_picture(picture())
    view.set_line(ProfileLine((84_605, 447_010), (84_625, 447_010), 1.0))
    drag(view, (84_625, 447_010), (84_620, 447_004), Qt.MouseButton.LeftButton)
    assert view.line is not None
    assert view.line.start == (84_605, 447_010)
    assert view.line.end == pytest.approx((84_620, 447_004), abs=0.1)


def test_the_line_can_be_drawn_moved_and_removed_by_keys(view: MapView, qtbot: QtBot) -> None:
    """The profile would be out of reach without a mouse."""
    view.set_picture(picture())
    view.set_drawing(True)
    QTest.keyClick(view.plot, Qt.Key.Key_Return)
    assert view.line is not None
    end = view.line.end
    QTest.keyClick(view.plot, Qt.Key.Key_Up, Qt.KeyboardModifier.ShiftModifier)
    assert view.line.end[1] > end[1]
    with qtbot.waitSignal(view.section_ended):
        QTest.keyClick(view.plot, Qt.Key.Key_Delete)
    assert view.line is None


def test_escape_leaves_the_tool(view: MapView, qtbot: QtBot) -> None:
    """The next drag would draw where panning is meant."""
    view.set_picture(picture())
    view.set_drawing(True)
    with qtbot.waitSignal(view.drawing_changed) as changed:
        QTest.keyClick(view.plot, Qt.Key.Key_Escape)
    assert changed.args == [False]
    drag(view, (84_605, 447_005), (84_615, 447_010), Qt.MouseButton.LeftButton)
    assert view.line is None


def test_another_width_is_wanted_for_the_same_line(view: MapView, qtbot: QtBot) -> None:
    """The width would count for the next line only."""
    view.set_picture(picture())
    view.set_line(ProfileLine((84_605, 447_010), (84_625, 447_010), 1.0))
    with qtbot.waitSignal(view.section_wanted) as wanted:
        view.set_line_width(2.5)
    assert wanted.args == [(84_605, 447_010), (84_625, 447_010), 2.5]


def test_a_newer_result_is_mentioned_only_when_it_takes_a_while(view: MapView, qtbot: QtBot) -> None:
    """Every tick of a slider would blink."""
    view.set_picture(picture())
    view.set_pending(True)
    view.set_pending(False)
    assert not view.plot.is_marked_pending
    view.set_pending(True)
    qtbot.waitUntil(lambda: view.plot.is_marked_pending)
    view.set_pending(False)
    assert not view.plot.is_marked_pending


def test_large_coordinates_are_written_in_full(view: MapView) -> None:
    """An exponent or a cut label would hide where the scan is."""
    view.set_theme(LIGHT)
    view.set_picture(picture())
    axis = view.plot.axes["left"]
    (step, values), *_ = axis.tickValues(447_000.0, 447_020.0, 300)
    labels = axis.tickStrings(values, 1.0, step)
    assert "447\N{NARROW NO-BREAK SPACE}010" in labels
    assert axis.minimumWidth() >= axis._width("447\N{NARROW NO-BREAK SPACE}010.5")


def test_labels_below_the_map_never_overlap(view: MapView) -> None:
    """Wide numbers on a narrow map would be unreadable."""
    axis = view.plot.axes["bottom"]
    for low, high, size in ((84_600.0, 84_600.4, 200), (1_000_000.0, 1_000_050.0, 90), (-3.0, 4.0, 500)):
        for step, values in axis.tickValues(low, high, size):
            widest = max((axis._width(text) for text in axis.tickStrings(values, 1.0, step)), default=0.0)
            assert widest < step / (high - low) * size


def test_the_band_is_across_the_line() -> None:
    """The band on the map would not be what the profile is cut from."""
    corners = ProfileLine((0.0, 0.0), (3.0, 4.0), 2.0).corners()
    np.testing.assert_allclose(corners, [(-0.8, 0.6), (2.2, 4.6), (3.8, 3.4), (0.8, -0.6)])


@pytest.mark.parametrize(
    ("at", "part"), [((1, 1), "start"), ((99, 2), "end"), ((50, 3), "whole"), ((50, 20), None)]
)
def test_a_press_takes_the_nearest_part(at: tuple[float, float], part: str | None) -> None:
    """An end could not be grasped, or the line would catch every press."""
    assert part_at(QPointF(0, 0), QPointF(100, 0), QPointF(*at)) == part
