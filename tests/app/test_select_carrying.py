"""Selecting by keys, carrying the selection to a layer, and the menu of every view."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, Qt
from PySide6.QtGui import (
    QContextMenuEvent,
    QDrag,
    QDragEnterEvent,
    QDropEvent,
)
from PySide6.QtWidgets import QApplication, QMenu
from pytestqt.qtbot import QtBot
from tests.app.desk import (
    ALT,
    CTRL,
    FLOOR,
    LEFT,
    PLAIN,
    RIGHT,
    SHIFT,
    Desk,
    desk_at,
    draw,
    hold,
    press,
)
from tests.app.scenes_made import UTM

from stepfield_app.editor import PILLARS_MIME
from stepfield_app.render.scene import PILLARS
from stepfield_app.views.overlay import Overlay

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks


@pytest.fixture(params=[(0.0, 0.0, 0.0), UTM], ids=["near", "far"])
def desk(request: pytest.FixtureRequest, qtbot: QtBot, tmp_path: Path) -> Iterator[Desk]:
    """A desk with the table at home, and in a national grid."""
    yield from desk_at(request.param, qtbot, tmp_path)


# --- Keys ---------------------------------------------------------------------------------------------------


def test_keys_alone_select_a_rectangle_in_the_map(desk: Desk) -> None:
    """If it failed, who cannot use a mouse could not edit."""
    plot = desk.map.plot
    desk.tools.choose("rectangle")
    press(plot, Qt.Key.Key_Right)  # the cursor appears in the middle
    for _ in range(20):
        press(plot, Qt.Key.Key_Left)
        press(plot, Qt.Key.Key_Up)
    for _ in range(3):
        press(plot, Qt.Key.Key_Right, SHIFT)
    press(plot, Qt.Key.Key_Down, SHIFT)
    press(plot, Qt.Key.Key_Return)
    assert desk.taken() == {0: 8}
    press(plot, Qt.Key.Key_Down)
    press(plot, Qt.Key.Key_Return, SHIFT)
    assert desk.taken() == {0: 9}
    press(plot, Qt.Key.Key_Space)
    press(plot, Qt.Key.Key_Space, is_down=False)
    assert desk.taken() == {0: 1}, "Space takes what Enter takes"


def test_the_cursor_of_the_keys_stays_in_sight(desk: Desk) -> None:
    plot = desk.map.plot
    desk.tools.choose("click")
    x, y = desk.corner[:2]
    plot.pane.setRange(xRange=(x + 3, x + 5), yRange=(y + 2, y + 4), padding=0)
    for _ in range(8):
        press(plot, Qt.Key.Key_Right, CTRL)
    assert plot.visible.right > x + 7.5
    press(plot, Qt.Key.Key_Return)
    desk.rest()
    selection = desk.selection
    assert selection.mask is not None
    assert selection.result is not None
    box = selection.result.field.boxes(np.flatnonzero(selection.mask))[0]
    assert box[0] == pytest.approx(x + 7.5)


def test_arrows_pan_the_map_while_one_navigates(desk: Desk) -> None:
    seen = desk.map.plot.visible
    press(desk.map.plot, Qt.Key.Key_Right)
    assert desk.map.plot.visible != seen


# --- Carrying away ------------------------------------------------------------------------------------------


@pytest.fixture
def carried(monkeypatch: pytest.MonkeyPatch) -> list[QMimeData]:
    """What was dragged out of a view; nobody drops it."""
    found: list[QMimeData] = []

    def exec_(drag: QDrag, *_: object) -> Qt.DropAction:
        found.append(drag.mimeData())
        assert not drag.pixmap().isNull()
        return Qt.DropAction.IgnoreAction

    monkeypatch.setattr(QDrag, "exec", exec_)
    return found


@pytest.mark.parametrize("where", ["map", "view", "profile"])
def test_a_drag_from_what_is_selected_carries_it_away(
    desk: Desk, carried: list[QMimeData], where: str
) -> None:
    desk.tools.choose("lasso")
    desk.selection.all_of(0)
    desk.rest()
    widget, way = {
        "map": (desk.map.plot.viewport(), desk.on_map((1, 1), (3, 3))),
        "view": (desk.trio.canvases[PILLARS], desk.in_view((1, 1, 0), (3, 3, 0))),
        "profile": (desk.profile.plot.viewport(), desk.in_profile((1, -0.2), (3, 0.8))),
    }[where]
    hold(widget, way)
    assert [bytes(data.data(PILLARS_MIME).data()) for data in carried] == [str(FLOOR).encode()]
    assert desk.taken() == {0: FLOOR}, "the drag has changed the selection"
    draw(desk.map.plot.viewport(), desk.on_map((0.1, 0.1), (0.9, 0.1), (0.9, 0.9), (0.1, 0.9)), ALT)
    assert desk.taken() == {0: FLOOR - 4}, "the next stroke is lost after a drag"


def test_a_press_on_what_is_selected_that_does_not_move_is_a_click(
    desk: Desk, carried: list[QMimeData]
) -> None:
    desk.tools.choose("click")
    desk.selection.all_of(0)
    desk.rest()
    draw(desk.map.plot.viewport(), desk.on_map((0.25, 0.25)))
    assert desk.taken() == {0: 1}
    assert not carried


def test_a_drop_on_the_map_moves_to_the_layer_it_shows(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    monkeypatch.setattr(Overlay, "note", lambda self, text, colour: said.append(text))
    desk.selection.all_of(1)
    desk.rest()
    desk.editor.plan_ahead()
    desk.qtbot.waitUntil(lambda: desk.editor.preview(0) is not None)
    plot, data = desk.map.plot, QMimeData()
    data.setData(PILLARS_MIME, b"24")
    where, move = desk.on_map((4, 3))[0], Qt.DropAction.MoveAction
    enter = QDragEnterEvent(where.toPoint(), move, data, LEFT, PLAIN)
    QApplication.sendEvent(plot.viewport(), enter)
    assert enter.isAccepted()
    plot.grab()
    plan = desk.editor.preview(0)
    assert plan is not None
    assert said[-1] == f"Layer 1: {plan.sentence}"
    QApplication.sendEvent(plot.viewport(), QDropEvent(where, move, data, LEFT, PLAIN))
    desk.qtbot.waitUntil(lambda: desk.document.undo_stack.count() == 1)
    assert desk.document.project.moves[0].text.startswith("Move ")
    desk.settle()


def test_the_map_leaves_files_to_the_window(desk: Desk) -> None:
    data = QMimeData()
    data.setText("file:///tmp/scan.ply")
    enter = QDragEnterEvent(QPoint(200, 200), Qt.DropAction.CopyAction, data, LEFT, PLAIN)
    QApplication.sendEvent(desk.map.plot.viewport(), enter)
    assert not enter.isAccepted()


# --- The menu -----------------------------------------------------------------------------------------------


def menu_texts() -> tuple[QMenu, list[str]]:
    menu = QApplication.activePopupWidget()
    assert isinstance(menu, QMenu)
    return menu, [action.text().replace("&", "") for action in menu.actions() if action.text()]


@pytest.mark.parametrize("tool", ["navigate", "lasso"])
@pytest.mark.parametrize("where", ["map", "view", "profile"])
def test_a_right_click_opens_the_menu_in_every_view(desk: Desk, where: str, tool: Any) -> None:
    desk.tools.choose(tool)
    desk.show_map(0 if where == "view" else 1)
    widget, at = {
        "map": (desk.map.plot.viewport(), desk.on_map((3.2, 3.2))),
        "view": (desk.trio.canvases[PILLARS], desk.in_view((1.2, 1.2, 0))),
        "profile": (desk.profile.plot.viewport(), desk.in_profile((3, 0.99))),
    }[where]
    draw(widget, at, button=RIGHT)
    menu, texts = menu_texts()
    assert "Select the pillar here" in texts
    moving = next(action for action in menu.actions() if "Move to" in action.text().replace("&", ""))
    assert not moving.isEnabled(), "nothing is selected yet"
    next(action for action in menu.actions() if "surface" in action.text()).trigger()
    menu.close()
    assert desk.taken()


def test_a_drag_of_the_right_button_opens_no_menu(desk: Desk) -> None:
    draw(desk.trio.canvases[PILLARS], desk.in_view((1, 1, 0), (3, 3, 0)), button=RIGHT)
    draw(desk.map.plot.viewport(), desk.on_map((1, 1), (3, 3)), button=RIGHT)
    assert QApplication.activePopupWidget() is None


def test_the_menu_moves_the_selection(desk: Desk) -> None:
    desk.selection.all_of(1)
    desk.rest()
    plot = desk.map.plot
    event = QContextMenuEvent(QContextMenuEvent.Reason.Keyboard, QPoint(10, 10), QPoint(10, 10))
    QApplication.sendEvent(plot.viewport(), event)
    menu, _ = menu_texts()
    moving: Any = next(action for action in menu.actions() if action.menu() is not None).menu()
    next(action for action in moving.actions() if "Unassigned" in action.text()).trigger()
    menu.close()
    desk.qtbot.waitUntil(lambda: desk.document.undo_stack.count() == 1)
    desk.settle()
