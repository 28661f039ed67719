"""The actions of selecting: one tool at a time among all tools of the window, and keys that are free."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from PySide6.QtWidgets import QMainWindow
from pytestqt.qtbot import QtBot
from tests.app.desk import TOP, Desk, desk_at

from stepfield_app.actions import Actions
from stepfield_app.commands import select
from stepfield_app.render.scene import PILLARS
from stepfield_app.toolbars import TOOLS
from stepfield_app.tools.crop import CropTool
from stepfield_app.tools.selecting import SelectingTool

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks


@pytest.fixture
def desk(qtbot: QtBot, tmp_path: Path) -> Iterator[Desk]:
    yield from desk_at((0.0, 0.0, 0.0), qtbot, tmp_path)


@pytest.fixture
def actions(qtbot: QtBot, desk: Desk) -> Actions:
    """The actions of a window that has only what selecting needs."""
    window = QMainWindow()
    qtbot.addWidget(window)
    crop = CropTool(desk.document, desk.trio, desk.scene_feed)
    bench: Any = SimpleNamespace(
        document=desk.document,
        selection=desk.selection,
        select_tools=desk.tools,
        map=desk.map,
        raise_map=desk.map.show,
    )
    actions = Actions(window)
    actions.make("crop", "Crop", crop.set_active, checkable=True)
    actions.make("profile line", "Line", desk.map.set_drawing, checkable=True)
    select.make(actions, bench)
    actions.enable(True)
    return actions


def in_use(actions: Actions) -> list[str]:
    return [name for name in [*TOOLS, "crop", "profile line"] if actions[name].isChecked()]


def in_hand(desk: Desk) -> str:
    return desk.tools.tool


def test_one_tool_is_in_use_at_a_time(desk: Desk, actions: Actions) -> None:
    """If it failed, two tools would take the same press."""
    assert in_use(actions) == ["navigate"]
    actions["lasso"].trigger()
    assert in_use(actions) == ["lasso"]
    assert in_hand(desk) == "lasso"
    actions["crop"].trigger()
    assert in_use(actions) == ["navigate", "crop"]
    assert in_hand(desk) == "navigate"
    actions["brush"].trigger()
    assert in_use(actions) == ["brush"]
    actions["profile line"].trigger()
    assert in_use(actions) == ["navigate", "profile line"]
    assert desk.map.plot.grip.tool is None
    actions["click"].trigger()
    assert in_use(actions) == ["click"]
    assert not desk.map.plot.is_drawing
    assert desk.tools.leave()
    assert in_use(actions) == ["navigate"]


def test_commands_change_the_selection(desk: Desk, actions: Actions) -> None:
    desk.show_map(1)
    actions["select all"].trigger()
    assert desk.taken() == {1: TOP}
    actions["shrink"].trigger()
    assert desk.taken() == {1: 8}
    actions["grow"].trigger()
    assert desk.taken() == {1: 20}, "a cross around each of the eight"
    actions["invert"].trigger()
    assert desk.taken() == {1: 4}
    actions["clear selection"].trigger()
    assert desk.taken() == {}


def test_the_reach_can_be_chosen_by_keys_and_follows_the_strip(desk: Desk, actions: Actions) -> None:
    actions["reach everything"].trigger()
    assert desk.selection.reach_kind == "everything"
    desk.tools.strip.button("range").click()
    assert actions["reach range"].isChecked()
    assert not actions["reach everything"].isChecked()


def test_one_key_leads_to_the_map_and_its_cursor(desk: Desk, actions: Actions) -> None:
    actions[select.KEYBOARD].trigger()
    assert in_hand(desk) == "rectangle"
    actions["click"].trigger()
    actions[select.KEYBOARD].trigger()
    assert in_hand(desk) == "click", "the tool that is in the hand stays there"


def test_no_key_means_two_things(actions: Actions) -> None:
    names = [*TOOLS, *select.EDIT, *select.REACHES, *select.BRUSH, select.KEYBOARD]
    keys = [key.toString() for name in names for key in actions[name].shortcuts()]
    assert len(keys) == len(set(keys))
    assert all(actions[name].shortcuts() for name in names), "there must be a way without a mouse"


def test_the_crop_box_and_the_tools_take_turns(desk: Desk) -> None:
    crop, canvas = CropTool(desk.document, desk.trio, desk.scene_feed), desk.trio.canvases[PILLARS]
    desk.tools.choose("click")
    crop.set_active(True)
    desk.tools.choose("navigate")
    assert canvas.grip.tool is crop, "leaving one tool must not take the other away"
    crop.set_active(False)
    assert canvas.grip.tool is None
    desk.tools.choose("click")
    crop.set_active(False)
    assert isinstance(canvas.grip.tool, SelectingTool)
