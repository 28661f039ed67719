"""Selecting with the mouse and with keys, in every view: what a hand does is what gets selected."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QComboBox, QDoubleSpinBox, QLineEdit, QSpinBox, QWidget
from pytestqt.qtbot import QtBot
from tests.app.desk import (
    ALT,
    CTRL,
    LEFT,
    PLAIN,
    SHIFT,
    TOP,
    Desk,
    desk_at,
    draw,
    hold,
    hover,
    mouse,
    press,
    turn,
)
from tests.app.scenes_made import UTM

from stepfield_app.render.scene import CLOUD, PILLARS
from stepfield_app.tools import selecting

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks


@pytest.fixture(params=[(0.0, 0.0, 0.0), UTM], ids=["near", "far"])
def desk(request: pytest.FixtureRequest, qtbot: QtBot, tmp_path: Path) -> Iterator[Desk]:
    """A desk with the table at home, and in a national grid."""
    yield from desk_at(request.param, qtbot, tmp_path)


# --- Shapes in every view -----------------------------------------------------------------------------------


def test_a_rectangle_on_the_map_takes_the_layer_that_is_active_and_no_other(desk: Desk) -> None:
    """If it failed, pillars would be taken that nobody sees."""
    desk.tools.choose("rectangle")
    draw(desk.map.plot.viewport(), desk.on_map((1.9, 1.9), (5.1, 4.1)))
    assert desk.taken() == {0: TOP}, "the floor under the table-top, for that is the layer shown"
    desk.show_map(1)
    draw(desk.map.plot.viewport(), desk.on_map((7.9, 5.9), (0.1, 0.1)))
    assert desk.taken() == {1: TOP}


def test_everything_is_reached_when_the_strip_says_so(desk: Desk) -> None:
    desk.tools.choose("lasso")
    desk.tools.strip.button("everything").click()
    draw(desk.map.plot.viewport(), desk.on_map((1.9, 1.9), (5.1, 1.9), (5.1, 4.1), (1.9, 4.1)))
    assert desk.taken() == {0: TOP, 1: TOP}


def test_a_range_of_elevations_is_reached_as_its_boxes_say(desk: Desk) -> None:
    desk.tools.choose("rectangle")
    strip = desk.tools.strip
    assert not strip.low.isEnabled()
    strip.button("range").click()
    assert strip.low.isEnabled()
    strip.low.setValue(float(desk.corner[2]) + 0.5)
    draw(desk.map.plot.viewport(), desk.on_map((0.1, 0.1), (7.9, 5.9)))
    assert desk.taken() == {1: TOP}


def test_a_range_that_nobody_has_changed_reaches_everything(desk: Desk) -> None:
    """The boxes show two decimals: what lies a millimetre beyond would be left out."""
    strip, before = desk.tools.strip, desk.selection.z_range
    strip.button("range").click()
    assert desk.selection.z_range == before
    strip.high.setValue(strip.high.value() - 0.01)
    assert desk.selection.z_range == (strip.low.value(), strip.high.value())


def test_ctrl_and_arrows_are_the_maps_while_a_tool_is_chosen(desk: Desk) -> None:
    """A far step of the cursor up or down would move a layer: the window has a command for these keys."""
    plot = desk.map.plot

    def keeps(key: Qt.Key) -> bool:
        event = QKeyEvent(QEvent.Type.ShortcutOverride, key, CTRL)
        event.ignore()
        QApplication.sendEvent(plot, event)
        return event.isAccepted()

    assert not keeps(Qt.Key.Key_Down)
    desk.tools.choose("rectangle")
    assert keeps(Qt.Key.Key_Down)
    assert not keeps(Qt.Key.Key_Z), "undo is the window's"


@pytest.mark.parametrize("kind", [QLineEdit, QSpinBox, QDoubleSpinBox, QComboBox])
def test_a_hand_at_rest_takes_the_keyboard_from_nobody_who_types(
    desk: Desk, kind: type[QWidget], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Digits meant for a box would move pillars."""
    typed_in, other = kind(desk.map), QWidget(desk.map)
    taken: list[object] = []
    monkeypatch.setattr(desk.map.plot, "setFocus", taken.append)
    desk.tools.choose("lasso")
    for focus in (typed_in, other):
        monkeypatch.setattr(selecting, "QApplication", type("Fake", (), {"focusWidget": lambda of=focus: of}))
        hover(desk.map.plot.viewport(), desk.on_map((4.0, 3.0))[0])
        assert bool(taken) == (focus is other)


def test_shift_adds_and_alt_or_ctrl_subtracts(desk: Desk) -> None:
    desk.tools.choose("rectangle")
    viewport = desk.map.plot.viewport()
    draw(viewport, desk.on_map((0.1, 0.1), (1.9, 0.9)))
    assert desk.taken() == {0: 8}
    draw(viewport, desk.on_map((6.1, 5.1), (7.9, 5.9)), SHIFT)
    assert desk.taken() == {0: 16}
    draw(viewport, desk.on_map((0.1, 0.1), (0.9, 0.9)), ALT)
    assert desk.taken() == {0: 12}
    draw(viewport, desk.on_map((6.1, 5.1), (6.9, 5.9)), CTRL)
    assert desk.taken() == {0: 8}
    draw(viewport, desk.on_map((3.1, 0.1), (3.9, 0.9)))
    assert desk.taken() == {0: 4}, "a plain drag begins anew"


def test_a_rectangle_in_a_3d_view_takes_what_is_drawn_there(desk: Desk) -> None:
    canvas, camera = desk.trio.canvases[PILLARS], desk.trio.viewpoint.camera
    desk.tools.choose("rectangle")
    draw(canvas, desk.in_view((0.1, 0.1, 0), (1.9, 0.9, 0)))
    assert desk.taken() == {0: 8}
    assert desk.trio.viewpoint.camera == camera, "the camera has moved too"
    desk.visible = (1, -1)
    draw(canvas, desk.in_view((6.1, 0.1, 0), (7.9, 0.9, 0)))
    assert desk.taken() == {}, "the floor is hidden"


def test_the_views_of_the_cloud_and_the_surface_select_too(desk: Desk) -> None:
    desk.tools.choose("lasso")
    corners = [(0.1, 0.1, 0.0), (1.9, 0.1, 0.0), (1.9, 0.9, 0.0), (0.1, 0.9, 0.0)]
    draw(desk.trio.canvases[CLOUD], desk.in_view(*corners, name=CLOUD))
    assert desk.taken() == {0: 8}


def test_the_profile_takes_blocks_by_their_tops(desk: Desk) -> None:
    desk.tools.choose("rectangle")
    desk.selection.set_reach("everything")
    draw(desk.profile.plot.viewport(), desk.in_profile((0.1, 0.8), (7.9, 1.05)))
    taken = desk.taken()
    assert set(taken) == {1}
    assert taken[1] >= 6


def test_a_click_takes_one_and_a_click_beside_everything_takes_none(desk: Desk) -> None:
    desk.tools.choose("click")
    draw(desk.map.plot.viewport(), desk.on_map((0.25, 0.25)))
    assert desk.taken() == {0: 1}
    draw(desk.trio.canvases[PILLARS], desk.in_view((7.25, 5.25, 0)), SHIFT)
    assert desk.taken() == {0: 2}
    draw(desk.map.plot.viewport(), desk.on_map((-0.15, 0.25)))
    assert desk.taken() == {}


@pytest.mark.parametrize("tool", ["rectangle", "lasso"])
def test_a_shape_of_no_size_is_a_click(desk: Desk, tool: Any) -> None:
    desk.tools.choose(tool)
    draw(desk.map.plot.viewport(), desk.on_map((0.25, 0.25)))
    assert desk.taken() == {0: 1}


def test_a_surface_is_all_that_is_connected(desk: Desk) -> None:
    desk.tools.choose("surface")
    desk.selection.set_reach("everything")
    desk.show_map(1)
    draw(desk.map.plot.viewport(), desk.on_map((3.25, 3.25)))
    assert desk.taken() == {1: TOP}


def test_a_brush_takes_what_it_touches_while_it_moves(desk: Desk) -> None:
    """If it failed, the hand would only see what it has done after it is done."""
    desk.tools.choose("brush")
    viewport = desk.map.plot.viewport()
    hold(viewport, desk.on_map((0.25, 0.25), (3.75, 0.25)))
    before = desk.taken()[0]
    assert before >= 8
    mouse(viewport, QEvent.Type.MouseButtonRelease, desk.on_map((3.75, 0.25))[0], LEFT)
    assert desk.taken()[0] == before


def test_ctrl_and_the_wheel_size_the_brush_and_the_plain_wheel_zooms(desk: Desk) -> None:
    desk.tools.choose("brush")
    viewport, middle = desk.map.plot.viewport(), desk.on_map((4, 3))[0]
    seen = desk.map.plot.visible
    for _ in range(9):
        turn(viewport, middle, CTRL)
    assert desk.map.plot.visible == seen
    draw(viewport, [middle])
    wide = desk.taken()[0]
    for _ in range(9):
        turn(viewport, middle, CTRL, -1)
    draw(viewport, desk.on_map((7.9, 5.9)), CTRL)
    desk.selection.clear()
    draw(viewport, [middle])
    assert desk.taken()[0] < wide
    turn(viewport, middle, PLAIN)
    assert desk.map.plot.visible != seen


# --- Navigating meanwhile, and leaving ----------------------------------------------------------------------


def test_space_navigates_as_long_as_it_is_held(desk: Desk) -> None:
    canvas = desk.trio.canvases[PILLARS]
    desk.tools.choose("rectangle")
    way, camera = desk.in_view((1, 1, 0), (3, 2, 0)), desk.trio.viewpoint.camera
    hover(canvas, way[0])
    press(canvas, Qt.Key.Key_Space)
    assert canvas.cursor().shape() == Qt.CursorShape.OpenHandCursor
    draw(canvas, way)
    assert desk.taken() == {}
    assert desk.trio.viewpoint.camera != camera
    press(canvas, Qt.Key.Key_Space, is_down=False)
    camera = desk.trio.viewpoint.camera
    draw(canvas, way)
    assert desk.trio.viewpoint.camera == camera
    assert desk.taken()


def test_other_buttons_pan_while_a_tool_is_chosen(desk: Desk) -> None:
    desk.tools.choose("lasso")
    canvas, camera, seen = desk.trio.canvases[PILLARS], desk.trio.viewpoint.camera, desk.map.plot.visible
    draw(canvas, desk.in_view((1, 1, 0), (3, 2, 0)), button=Qt.MouseButton.MiddleButton)
    assert desk.trio.viewpoint.camera.centre != camera.centre
    draw(desk.map.plot.viewport(), desk.on_map((1, 1), (3, 2)), button=Qt.MouseButton.MiddleButton)
    assert desk.map.plot.visible != seen
    assert desk.taken() == {}


@pytest.mark.parametrize("tool", ["brush", "lasso"])
def test_escape_gives_a_stroke_up_first_and_then_the_tool(desk: Desk, tool: Any) -> None:
    desk.tools.choose("rectangle")
    viewport = desk.map.plot.viewport()
    draw(viewport, desk.on_map((6.1, 5.1), (7.9, 5.9)))
    assert desk.taken() == {0: 8}
    desk.tools.choose(tool)
    way = desk.on_map((0.25, 0.25), (3.75, 0.25), (3.75, 1.75))
    hold(viewport, way)
    desk.rest()
    assert desk.tools.leave()
    assert desk.tools.tool == tool
    mouse(viewport, QEvent.Type.MouseButtonRelease, way[-1], LEFT)
    assert desk.taken() == {0: 8}, "what was selected before is lost"
    assert desk.tools.leave()
    assert desk.tools.tool == "navigate"
    assert not desk.tools.leave()
    assert desk.map.plot.grip.tool is None


def test_a_double_click_on_the_map_does_not_fit_while_a_tool_is_chosen(desk: Desk) -> None:
    desk.tools.choose("click")
    turn(desk.map.plot.viewport(), desk.on_map((4, 3))[0], PLAIN)
    seen = desk.map.plot.visible
    QTest.mouseDClick(desk.map.plot.viewport(), LEFT, pos=desk.on_map((4, 3))[0].toPoint())
    assert desk.map.plot.visible == seen


# --- What it shows ------------------------------------------------------------------------------------------


def test_the_cursor_tells_what_a_press_would_do(desk: Desk) -> None:
    viewport, at = desk.map.plot.viewport(), desk.on_map((0.25, 0.25))[0]
    desk.tools.choose("click")
    pictures = []
    for keys in (PLAIN, SHIFT, ALT):
        hover(viewport, at, keys)
        pictures.append(viewport.cursor().pixmap().toImage())
    assert pictures[0] != pictures[1] != pictures[2]
    draw(viewport, [at])
    desk.rest()
    hover(viewport, at)
    assert viewport.cursor().shape() == Qt.CursorShape.SizeAllCursor, "it can be dragged away"
    hover(viewport, QPointF(2, 2))
    assert viewport.cursor().shape() == Qt.CursorShape.ArrowCursor, "there is nothing to select on an axis"


def test_the_strip_and_the_status_bar_say_what_is_reached_and_selected(desk: Desk) -> None:
    strip = desk.tools.strip
    assert strip.isHidden()
    desk.tools.choose("brush")
    assert not strip.isHidden()
    assert strip.button("layer").text() == "Layer 1 only"
    desk.show_map(1)
    assert strip.button("layer").text() == "Layer 2 only"
    desk.selection.set_reach("everything")
    assert strip.button("everything").isChecked()
    desk.status.resize(1600, 30)
    desk.selection.all_of(1)
    desk.rest()
    said = [label.toolTip() for label in desk.status.findChildren(QWidget) if "selected" in label.toolTip()]
    assert f"{TOP} pillars selected (Layer 2: {TOP})" in said


def test_the_running_shape_is_painted(desk: Desk) -> None:
    desk.tools.choose("lasso")
    for widget, grabbed, way in (
        (desk.map.plot.viewport(), desk.map, desk.on_map((1, 1), (6, 1), (6, 5))),
        (desk.trio.canvases[PILLARS], desk.trio, desk.in_view((1, 1, 0), (6, 1, 0), (6, 5, 0))),
        (desk.profile.plot.viewport(), desk.profile, desk.in_profile((1, 0.2), (6, 0.2), (6, 0.9))),
    ):
        before = grabbed.grab().toImage()
        hold(widget, way)
        assert grabbed.grab().toImage() != before
        desk.tools.cancel()
        mouse(widget, QEvent.Type.MouseButtonRelease, way[-1], LEFT)
    assert desk.taken() == {}


def test_what_is_selected_is_outlined_in_map_and_profile(desk: Desk) -> None:
    maps, profiles = desk.map.plot.grab().toImage(), desk.profile.plot.grab().toImage()
    desk.selection.all_of(1)
    desk.rest()
    assert desk.map.plot.grab().toImage() != maps
    assert desk.profile.plot.grab().toImage() != profiles
    desk.selection.clear()
    desk.rest()
    assert desk.map.plot.grab().toImage() == maps
    assert desk.profile.plot.grab().toImage() == profiles
