"""One 3-D view: the hand moves the camera as promised, and the view says what it shows."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt, QTimer
from PySide6.QtGui import QImage, QPainter, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from tests.app.stubs import StubClient, floor_frame, moving_frame

from stepfield_app.ramps import ramp
from stepfield_app.render.camera import Camera
from stepfield_app.render.client import RenderClient
from stepfield_app.render.scene import CLOUD, PILLARS
from stepfield_app.scenes.legend import Legend
from stepfield_app.theme import DARK
from stepfield_app.views import navigation
from stepfield_app.views.overlay import Overlay
from stepfield_app.views.tool import Cursor, Hand, Tool
from stepfield_app.views.view3d import SENTENCES, Canvas
from stepfield_app.views.viewpoint import Viewpoint

SIZE = (400, 300)
MIDDLE = QPoint(200, 150)
CAMERA = Camera((3.0, 2.0, 0.0), 40.0, 50.0, 8.0)
LEFT, NOTHING = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
SHIFT = Qt.KeyboardModifier.ShiftModifier


@pytest.fixture
def client(qtbot: QtBot) -> StubClient:
    return StubClient()


@pytest.fixture
def canvas(qtbot: QtBot, client: StubClient) -> Canvas:
    """A view of an endless floor, shown."""
    viewpoint = Viewpoint()
    canvas = Canvas(CLOUD, client, viewpoint)  # type: ignore[arg-type]
    viewpoint.setParent(canvas)
    qtbot.addWidget(canvas)
    canvas.resize(*SIZE)
    with qtbot.waitExposed(canvas):
        canvas.show()
    viewpoint.look(CAMERA)
    client.deliver(CLOUD, floor_frame(CAMERA, SIZE))
    return canvas


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Sentences and notes a view paints."""
    found: list[str] = []
    monkeypatch.setattr(Overlay, "sentence", lambda self, text: found.append(text))
    monkeypatch.setattr(Overlay, "note", lambda self, text, colour: found.append(text))
    return found


def drag(
    canvas: Canvas,
    button: Qt.MouseButton,
    way: tuple[int, int],
    modifiers: Qt.KeyboardModifier = NOTHING,
    begin: QPoint = MIDDLE,
) -> None:
    QTest.mousePress(canvas, button, modifiers, begin)
    for share in (0.3, 0.7, 1.0):
        QTest.mouseMove(canvas, begin + QPoint(round(way[0] * share), round(way[1] * share)))
    QTest.mouseRelease(canvas, button, modifiers, begin + QPoint(*way))


def turn_wheel(canvas: Canvas, at: QPoint, notches: float = 1) -> None:
    place = QPointF(at)
    event = QWheelEvent(
        place,
        QPointF(canvas.mapToGlobal(at)),
        QPoint(),
        QPoint(0, round(120 * notches)),
        Qt.MouseButton.NoButton,
        NOTHING,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(canvas, event)


def pixel(canvas: Canvas, place: tuple[float, float, float]) -> tuple[float, float]:
    at = canvas.pixel_of(place)
    return at.x(), at.y()


def picture(canvas: Canvas) -> NDArray[np.uint8]:
    image = canvas.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    array = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.width(), 4)
    return array[..., 2::-1].copy()


def test_the_stub_is_like_the_real_client() -> None:
    """If it failed, the tests would prove something about a client there is not."""
    real = {name for name in vars(RenderClient) if not name.startswith("_")} - {"staticMetaObject"}
    missing = real - set(vars(StubClient))
    assert not missing, f"the stub lacks {sorted(missing)}"
    assert {"frame_arrived", "state_changed", "set_scene", "is_at_rest"} <= real


# --- Camera -------------------------------------------------------------------------------------------------


def test_a_left_drag_orbits_and_keeps_the_centre(canvas: Canvas) -> None:
    drag(canvas, LEFT, (60, 20))
    camera = canvas.viewpoint.camera
    assert (camera.centre, camera.distance) == (CAMERA.centre, CAMERA.distance)
    assert camera.azimuth == pytest.approx(CAMERA.azimuth + 18)
    assert camera.elevation == pytest.approx(CAMERA.elevation + 6)


def test_a_drag_there_and_back_changes_nothing(canvas: Canvas) -> None:
    """If it failed, errors would add up while the hand moves."""
    QTest.mousePress(canvas, LEFT, NOTHING, MIDDLE)
    for x in (240, 399, 90, 200):
        QTest.mouseMove(canvas, QPoint(x, 150))
    QTest.mouseRelease(canvas, LEFT, NOTHING, MIDDLE)
    assert canvas.viewpoint.camera == CAMERA


@pytest.mark.parametrize(
    ("button", "modifiers"),
    [(Qt.MouseButton.MiddleButton, NOTHING), (Qt.MouseButton.RightButton, NOTHING), (LEFT, SHIFT)],
)
def test_what_is_held_stays_under_the_hand_when_panning(
    canvas: Canvas, button: Qt.MouseButton, modifiers: Qt.KeyboardModifier
) -> None:
    drag(canvas, button, (70, -40), modifiers)
    camera = canvas.viewpoint.camera
    assert (camera.azimuth, camera.elevation, camera.distance) == (40.0, 50.0, 8.0)
    assert pixel(canvas, CAMERA.centre) == pytest.approx((270, 110))


def test_a_second_button_does_not_take_the_scene_out_of_the_hand(canvas: Canvas) -> None:
    """If it failed, a slip onto the other button would end the drag, or leave a tool held for good."""
    QTest.mousePress(canvas, LEFT, NOTHING, MIDDLE)
    QTest.mouseMove(canvas, MIDDLE + QPoint(10, 0))
    QTest.mousePress(canvas, Qt.MouseButton.RightButton, NOTHING, MIDDLE + QPoint(10, 0))
    QTest.mouseRelease(canvas, Qt.MouseButton.RightButton, NOTHING, MIDDLE + QPoint(10, 0))
    QTest.mouseMove(canvas, MIDDLE + QPoint(50, 0))
    assert canvas.viewpoint.camera.azimuth == pytest.approx(CAMERA.azimuth + 15)
    QTest.mouseRelease(canvas, LEFT, NOTHING, MIDDLE + QPoint(50, 0))
    QTest.mouseMove(canvas, MIDDLE)
    assert canvas.viewpoint.camera.azimuth == pytest.approx(CAMERA.azimuth + 15)


@pytest.mark.parametrize("notches", [1, 3, -2, 0.25])
@pytest.mark.parametrize("parallel", [False, True])
def test_the_wheel_zooms_to_what_is_under_the_cursor(
    canvas: Canvas, client: StubClient, notches: float, parallel: bool
) -> None:
    at, camera = QPoint(310, 210), Camera(CAMERA.centre, 40.0, 50.0, 8.0, parallel)
    canvas.viewpoint.look(camera)
    client.deliver(CLOUD, floor_frame(camera, SIZE))
    place = canvas.place_at(QPointF(at))
    assert place is not None
    turn_wheel(canvas, at, notches)
    assert canvas.viewpoint.camera.distance == pytest.approx(8 / navigation.NOTCH**notches)
    assert pixel(canvas, place) == pytest.approx((310.5, 210.5), abs=0.01)


def test_the_wheel_keeps_one_target_while_it_turns(canvas: Canvas, client: StubClient) -> None:
    """Pictures on the way have no depth: without a target kept, the scene would drift under the cursor."""
    at = QPoint(310, 210)
    place = canvas.place_at(QPointF(at))
    assert place is not None
    for _ in range(12):
        turn_wheel(canvas, at)
        client.deliver(CLOUD, moving_frame(canvas.viewpoint.camera, (100, 75), (9, 9, 9)))
    for _ in range(12):
        turn_wheel(canvas, at, -1)
    assert pixel(canvas, place) == pytest.approx((310.5, 210.5), abs=0.01)
    assert canvas.viewpoint.camera.distance == pytest.approx(8.0)


def test_another_place_of_the_cursor_is_another_target(canvas: Canvas, client: StubClient) -> None:
    turn_wheel(canvas, QPoint(310, 210))
    client.deliver(CLOUD, floor_frame(canvas.viewpoint.camera, SIZE))
    place = canvas.place_at(QPointF(80, 120))
    assert place is not None
    turn_wheel(canvas, QPoint(80, 120))
    assert pixel(canvas, place) == pytest.approx((80.5, 120.5), abs=0.01)


def test_over_nothing_the_wheel_zooms_to_the_depth_of_the_centre(canvas: Canvas, client: StubClient) -> None:
    client.frames.clear()
    camera = canvas.viewpoint.camera
    place = camera.unproject(30, 40, camera.distance, SIZE)
    turn_wheel(canvas, QPoint(30, 40), 2)
    assert pixel(canvas, place) == pytest.approx((30, 40))


def test_a_wheel_turned_sideways_leaves_the_camera(canvas: Canvas) -> None:
    turn_wheel(canvas, MIDDLE, 0)
    assert canvas.viewpoint.camera == CAMERA


def test_a_double_click_turns_around_what_was_clicked(canvas: Canvas) -> None:
    place = canvas.place_at(QPointF(300, 200))
    QTest.mouseDClick(canvas, LEFT, NOTHING, QPoint(300, 200))
    camera = canvas.viewpoint.camera
    assert camera.centre == place
    assert (camera.azimuth, camera.elevation, camera.distance) == (40.0, 50.0, 8.0)


def test_a_double_click_on_nothing_leaves_the_camera(canvas: Canvas, client: StubClient) -> None:
    sky = Camera(CAMERA.centre, 0.0, 0.0, 8.0)
    canvas.viewpoint.look(sky)
    client.deliver(CLOUD, floor_frame(sky, SIZE))
    QTest.mouseDClick(canvas, LEFT, NOTHING, QPoint(200, 20))
    assert canvas.viewpoint.camera == sky


@pytest.mark.parametrize(
    ("key", "azimuth", "elevation"),
    [("Left", 30, 50), ("Right", 50, 50), ("Up", 40, 60), ("Down", 40, 40)],
)
def test_arrows_orbit(canvas: Canvas, key: str, azimuth: float, elevation: float) -> None:
    QTest.keyClick(canvas, getattr(Qt.Key, f"Key_{key}"))
    camera = canvas.viewpoint.camera
    assert (camera.azimuth, camera.elevation) == pytest.approx((azimuth, elevation))
    assert camera.centre == CAMERA.centre


def test_arrows_with_shift_pan_and_come_back(canvas: Canvas) -> None:
    QTest.keyClick(canvas, Qt.Key.Key_Right, SHIFT)
    assert pixel(canvas, CAMERA.centre) == pytest.approx((200 - navigation.STEP_PIXELS, 150))
    QTest.keyClick(canvas, Qt.Key.Key_Left, SHIFT)
    assert pixel(canvas, CAMERA.centre) == pytest.approx((200, 150))


def test_plus_and_minus_zoom(canvas: Canvas) -> None:
    QTest.keyClick(canvas, Qt.Key.Key_Plus)
    assert canvas.viewpoint.camera.distance == pytest.approx(8 / navigation.NOTCH)
    QTest.keyClick(canvas, Qt.Key.Key_Minus)
    assert canvas.viewpoint.camera.distance == pytest.approx(8)


def test_other_keys_are_left_to_the_window(canvas: Canvas) -> None:
    QTest.keyClick(canvas, Qt.Key.Key_F)
    QTest.keyClick(canvas, Qt.Key.Key_Tab)
    assert canvas.viewpoint.camera == CAMERA


# --- Places -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("at", [(0, 0), (399, 299), (123, 45), (200, 150)])
@pytest.mark.parametrize("share", [1.0, 0.5])
def test_places_are_local_coordinates(
    canvas: Canvas, client: StubClient, at: tuple[int, int], share: float
) -> None:
    """If it failed, the status bar would lie; a frame may also be smaller than the view."""
    client.deliver(CLOUD, floor_frame(CAMERA, (round(400 * share), round(300 * share))))
    place = canvas.place_at(QPointF(*at))
    assert place is not None
    assert place[2] == pytest.approx(0, abs=1e-5), "the floor is at height zero"
    assert pixel(canvas, place) == pytest.approx((at[0] + 0.5, at[1] + 0.5), abs=1.01 / share)


@pytest.mark.parametrize("at", [(-1, 5), (5, -1), (400, 5), (5, 300), (9999, 9999)])
def test_outside_of_the_picture_is_no_place(canvas: Canvas, at: tuple[int, int]) -> None:
    assert canvas.place_at(QPointF(*at)) is None


def test_a_quick_picture_from_the_same_place_has_the_depth_of_the_last_one(
    canvas: Canvas, client: StubClient
) -> None:
    """What is selected could not be taken hold of while something else is drawn anew."""
    before = canvas.place_at(QPointF(MIDDLE))
    client.deliver(CLOUD, moving_frame(CAMERA, SIZE, (0, 0, 0)))
    assert before is not None
    assert canvas.place_at(QPointF(MIDDLE)) == before
    client.deliver(CLOUD, moving_frame(CAMERA.orbited(40, 0), SIZE, (0, 0, 0)))
    assert canvas.place_at(QPointF(MIDDLE)) is None, "a depth seen from elsewhere is another place's"


def test_hovering_tells_the_place_and_leaving_that_there_is_none(canvas: Canvas) -> None:
    places: list[object] = []
    canvas.hovered.connect(places.append)
    QTest.mouseMove(canvas, QPoint(120, 130))
    assert places[-1] == canvas.place_at(QPointF(120, 130))
    QApplication.sendEvent(canvas, QEvent(QEvent.Type.Leave))
    assert places[-1] is None


def test_a_tool_takes_the_mouse_before_the_camera(canvas: Canvas) -> None:
    class Held(Tool[Canvas]):
        told: tuple[str, ...] = ()

        def press(self, view: Canvas, hand: Hand) -> bool:
            self.told += ("press",)
            return hand.at.x() > 100

        def drag(self, view: Canvas, hand: Hand) -> None:
            self.told += ("drag",)

        def release(self, view: Canvas, hand: Hand) -> None:
            self.told += ("release",)

        def hover(self, view: Canvas, hand: Hand) -> Cursor | None:
            return Qt.CursorShape.PointingHandCursor if hand.at.x() > 100 else None

        def paint(self, view: Canvas, painter: QPainter) -> None:
            self.told += ("paint",)

    canvas.grip.tool = tool = Held()
    drag(canvas, LEFT, (30, 0))
    assert tuple(told for told in tool.told if told != "paint") == (
        "press",
        "drag",
        "drag",
        "drag",
        "release",
    )
    assert canvas.viewpoint.camera == CAMERA
    drag(canvas, LEFT, (30, 0), begin=QPoint(50, 50))
    assert canvas.viewpoint.camera != CAMERA, "what the tool does not take is the camera's"
    QTest.mouseMove(canvas, QPoint(150, 50))
    assert canvas.cursor().shape() == Qt.CursorShape.PointingHandCursor
    QTest.mouseMove(canvas, QPoint(50, 50))
    assert canvas.cursor().shape() == Qt.CursorShape.ArrowCursor
    picture(canvas)
    assert "paint" in tool.told


# --- What it shows ------------------------------------------------------------------------------------------


def test_a_small_moving_frame_fills_the_view(canvas: Canvas, client: StubClient) -> None:
    """If it failed, a moving scene would shrink into a corner on a slow device."""
    client.deliver(CLOUD, moving_frame(CAMERA, (100, 75), (200, 30, 40)))
    seen = picture(canvas)
    for row, column in ((1, 1), (1, 398), (298, 1), (150, 200), (298, 250)):
        assert seen[row, column].tolist() == [200, 30, 40]


def test_colours_of_a_frame_are_those_on_the_screen(canvas: Canvas) -> None:
    assert picture(canvas)[100, 100].tolist() == [0, 158, 115]


def test_it_asks_for_device_pixels_and_only_when_it_is_seen(
    canvas: Canvas, client: StubClient, qtbot: QtBot
) -> None:
    canvas.resize(320, 200)
    assert client.cameras[CLOUD] == (CAMERA, (320, 200), True)
    qtbot.waitUntil(lambda: not client.cameras[CLOUD][2])
    canvas.hide()
    canvas.viewpoint.look(CAMERA.orbited(9, 9))
    assert client.cameras[CLOUD][0] == CAMERA


def test_without_a_picture_it_says_why(canvas: Canvas, client: StubClient, said: list[str]) -> None:
    client.frames.clear()
    for state in ("starting", "running", "stopped"):
        client.enter(state)
        picture(canvas)
        assert said[-1] == SENTENCES[state]
    client.enter("failed", "The 3-D views cannot start: libGL.so.1 is missing.")
    picture(canvas)
    assert said[-1] == "The 3-D views cannot start: libGL.so.1 is missing."
    canvas.set_empty_text("Nothing here yet.")
    picture(canvas)
    assert said[-1] == "Nothing here yet."
    assert (picture(canvas)[10, 10] == [int(DARK.window[at : at + 2], 16) for at in (1, 3, 5)]).all()


def test_the_old_picture_stays_while_the_drawing_comes_back(
    canvas: Canvas, client: StubClient, said: list[str]
) -> None:
    client.enter("stopped")
    assert picture(canvas)[100, 100].tolist() == [0, 158, 115]
    assert said[-1] == SENTENCES["stopped"]
    said.clear()
    client.enter("running")
    client.deliver(CLOUD, floor_frame(CAMERA, SIZE))
    picture(canvas)
    assert not said


def test_a_frame_of_another_view_changes_nothing(canvas: Canvas, client: StubClient, said: list[str]) -> None:
    client.enter("stopped")
    client.deliver(PILLARS, moving_frame(CAMERA, (10, 10), (250, 0, 0)))
    assert picture(canvas)[100, 100].tolist() == [0, 158, 115]
    assert said[-1] == SENTENCES["stopped"]


def test_a_picture_of_older_parameters_is_marked_once_it_takes_long(
    canvas: Canvas, qtbot: QtBot, said: list[str]
) -> None:
    """If it failed, old data would pass for new, or the mark would blink at every move of a slider."""
    canvas.set_pending(True)
    picture(canvas)
    assert not said
    qtbot.waitUntil(lambda: bool(picture(canvas).any()) and said[-1:] == ["updating…"])
    canvas.set_pending(False)
    said.clear()
    picture(canvas)
    assert not said


def test_what_arrives_in_a_moment_is_not_marked(canvas: Canvas, qtbot: QtBot, said: list[str]) -> None:
    canvas.set_pending(True)
    canvas.set_pending(False)
    assert not any(timer.isActive() for timer in canvas._lateness.findChildren(QTimer))
    picture(canvas)
    assert not said


def test_the_legend_can_be_taken_away(canvas: Canvas) -> None:
    plain = picture(canvas)
    canvas.set_legend(Legend("Elevation", "m", ramp("height")))
    assert (picture(canvas) != plain).any()
    canvas.set_legend(None)
    assert (picture(canvas) == plain).all()
