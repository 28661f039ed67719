"""Cloud, pillars and reconstruction: one camera, one arrangement, and headers that say what is drawn."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox, QToolButton
from pytestqt.qtbot import QtBot
from tests.app.stubs import StubClient, floor_frame

from stepfield_app.render.camera import MARGIN
from stepfield_app.render.scene import CLOUD, PILLARS, RECONSTRUCTION, VIEWS
from stepfield_app.theme import LIGHT
from stepfield_app.views.trio import Trio
from stepfield_app.views.viewpoint import PRESETS

LOW, HIGH = np.array([0.0, 0.0, 0.0]), np.array([40.0, 25.0, 9.0])
CORNERS = np.array([[x, y, z] for x in (0, 40) for y in (0, 25) for z in (0, 9)], float)


@pytest.fixture
def client(qtbot: QtBot) -> StubClient:
    return StubClient()


@pytest.fixture
def trio(qtbot: QtBot, client: StubClient) -> Trio:
    trio = Trio(client)  # type: ignore[arg-type]
    qtbot.addWidget(trio)
    trio.resize(1200, 400)
    with qtbot.waitExposed(trio):
        trio.show()
    trio.set_bounds(LOW, HIGH)
    trio.fit()
    return trio


def test_all_views_follow_one_hand(trio: Trio, client: StubClient) -> None:
    """If it failed, the views could not be compared."""
    before = trio.viewpoint.camera
    QTest.mousePress(trio.canvases[PILLARS], Qt.MouseButton.LeftButton, pos=QPoint(50, 50))
    QTest.mouseMove(trio.canvases[PILLARS], QPoint(90, 60))
    QTest.mouseRelease(trio.canvases[PILLARS], Qt.MouseButton.LeftButton, pos=QPoint(90, 60))
    assert trio.viewpoint.camera == before.orbited(40, 10)
    assert {client.cameras[view][0] for view in VIEWS} == {trio.viewpoint.camera}
    for view in VIEWS:
        canvas = trio.canvases[view]
        assert client.cameras[view][1] == (canvas.width(), canvas.height())


def test_when_the_hand_rests_every_view_is_asked_for_in_full(
    trio: Trio, client: StubClient, qtbot: QtBot
) -> None:
    trio.viewpoint.stir()
    assert all(client.cameras[view][2] for view in VIEWS)
    qtbot.waitUntil(lambda: not any(client.cameras[view][2] for view in VIEWS))


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("parallel", [False, True])
def test_presets_frame_everything(trio: Trio, preset: str, parallel: bool) -> None:
    """If it failed, a corner of the scan would be cut off, or the scan be a dot."""
    trio.set_parallel(parallel)
    trio.look_from(preset)
    camera, canvas = trio.viewpoint.camera, trio.canvases[CLOUD]
    assert (camera.azimuth, camera.elevation, camera.parallel) == (*PRESETS[preset], parallel)
    size = np.array(canvas.pixels)
    pixels, _ = camera.project(CORNERS, canvas.pixels)
    assert (pixels >= MARGIN * size - 1).all()
    assert (pixels <= (1 - MARGIN) * size + 1).all()
    assert (np.ptp(pixels, axis=0) / size).max() > 0.7


def test_fit_keeps_the_direction(trio: Trio) -> None:
    framed = trio.viewpoint.camera
    trio.viewpoint.look(framed.looking(77, 12).zoomed(9).panned(300, 40, (400, 300)))
    trio.fit()
    camera = trio.viewpoint.camera
    assert (camera.azimuth, camera.elevation) == (77, 12)
    assert camera.centre == pytest.approx((20, 12.5, 4.5))


def test_parallel_keeps_the_scale_at_the_centre(trio: Trio) -> None:
    """If it failed, the scene would jump when the projection is switched."""
    before = trio.viewpoint.camera
    trio.set_parallel(True)
    camera = trio.viewpoint.camera
    assert camera.parallel
    assert camera.metres_per_pixel((400, 300)) == before.metres_per_pixel((400, 300))
    trio.set_parallel(False)
    assert trio.viewpoint.camera == before


@pytest.mark.parametrize("place", range(3))
def test_a_double_click_on_a_title_enlarges_and_puts_back(
    trio: Trio, client: StubClient, qtbot: QtBot, place: int
) -> None:
    view, camera = VIEWS[place], trio.viewpoint.camera.orbited(5, 5)
    trio.viewpoint.look(camera)
    for expected in ((view,), VIEWS):
        with qtbot.waitSignal(trio.arranged):
            QTest.mouseDClick(trio.headers[view], Qt.MouseButton.LeftButton)
        assert trio.shown == expected
        assert client.shown == expected, "hidden views would be drawn for nobody"
        assert [trio.canvases[each].isVisible() for each in VIEWS] == [each in expected for each in VIEWS]
    assert trio.viewpoint.camera == camera


def test_the_button_of_a_header_enlarges_too(trio: Trio) -> None:
    trio.headers[RECONSTRUCTION].findChildren(QToolButton)[0].click()
    assert trio.shown == (RECONSTRUCTION,)


def test_from_one_large_view_to_another(trio: Trio, client: StubClient) -> None:
    """If it failed, Ctrl+2 after Ctrl+1 would show all three."""
    trio.arrange((CLOUD,))
    trio.arrange((PILLARS,))
    assert trio.shown == client.shown == (PILLARS,)
    assert client.cameras[PILLARS][0] == trio.viewpoint.camera


def test_fit_in_a_large_view_uses_its_room(trio: Trio, qtbot: QtBot) -> None:
    trio.arrange((RECONSTRUCTION,))
    canvas = trio.canvases[RECONSTRUCTION]
    qtbot.waitUntil(lambda: canvas.width() > 1000)
    trio.fit()
    pixels, _ = trio.viewpoint.camera.project(CORNERS, canvas.pixels)
    away = np.abs(pixels / canvas.pixels - 0.5).max()
    assert away == pytest.approx(0.5 - MARGIN, abs=0.001), "a corner should come just up to the margin"


def test_everything_stays_framed_until_the_hand_moves_the_camera(trio: Trio, qtbot: QtBot) -> None:
    """If it failed, a larger window would show a small scan, or a resize would undo what the hand did."""
    canvas = trio.canvases[CLOUD]
    trio.resize(1200, 250)
    qtbot.waitUntil(lambda: canvas.height() < 240)
    pixels, _ = trio.viewpoint.camera.project(CORNERS, canvas.pixels)
    assert np.abs(pixels / canvas.pixels - 0.5).max() == pytest.approx(0.5 - MARGIN, abs=0.001)
    camera = trio.viewpoint.camera.orbited(5, 5)
    trio.viewpoint.look(camera)
    trio.resize(1200, 500)
    qtbot.waitUntil(lambda: canvas.height() > 400)
    assert trio.viewpoint.camera == camera


def test_headers_say_how_much_is_drawn(trio: Trio, client: StubClient) -> None:
    client.deliver(CLOUD, floor_frame(trio.viewpoint.camera, (40, 30)))
    assert trio.headers[CLOUD].detail.startswith("12.0 k points")
    assert trio.headers[PILLARS].detail == ""
    trio.set_empty_text("Nothing to see.")
    assert trio.headers[CLOUD].detail == ""


def test_colours_are_offered_and_chosen(trio: Trio, qtbot: QtBot) -> None:
    box = trio.headers[CLOUD].findChildren(QComboBox)[0]
    trio.headers[CLOUD].set_colours((("height", "Height"), ("rgb", "RGB")), "rgb")
    assert (box.currentText(), box.isVisible()) == ("RGB", True)
    with qtbot.waitSignal(trio.colour_chosen) as heard:
        QTest.keyClick(box, Qt.Key.Key_Up)
    assert heard.args == [CLOUD, "height"]
    trio.headers[CLOUD].set_colours((("height", "Height"),), "height")
    assert not box.isVisible(), "a choice of one is no choice"


def test_only_what_depends_on_parameters_is_marked(trio: Trio, monkeypatch: pytest.MonkeyPatch) -> None:
    """The cloud is the scan itself: no parameter changes it."""
    marked: list[str] = []
    for view in VIEWS:
        monkeypatch.setattr(trio.canvases[view], "set_pending", lambda _, view=view: marked.append(view))
    trio.set_pending(True)
    assert marked == [PILLARS, RECONSTRUCTION]


def test_hovering_any_view_is_told(trio: Trio, client: StubClient) -> None:
    places: list[object] = []
    trio.hovered.connect(places.append)
    for view in VIEWS:
        client.deliver(view, floor_frame(trio.viewpoint.camera, trio.canvases[view].pixels))
        QTest.mouseMove(trio.canvases[view], QPoint(100, 100))
        assert places[-1] == trio.canvases[view].place_at(QPoint(100, 100))  # type: ignore[arg-type]


def test_the_theme_reaches_every_view(trio: Trio) -> None:
    trio.set_theme(LIGHT)
    assert all(canvas._theme is LIGHT for canvas in trio.canvases.values())
