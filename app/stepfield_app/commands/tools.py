"""The Tools menu: what takes the mouse before the camera does."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from stepfield_app.actions import Actions
from stepfield_app.commands import select
from stepfield_app.toolbars import TOOLS

if TYPE_CHECKING:
    from stepfield_app.main_window import MainWindow

#: Names of the actions that lead from one suspicious place to the next.
PLACES = ["next place", "previous place", "select place"]


def make(actions: Actions, window: MainWindow) -> None:
    """Make the actions of the menu."""
    crop = actions.make(
        "crop",
        "&Crop box",
        window.cleaning.set_crop_tool,
        keys="C",
        glyph="crop",
        checkable=True,
        tip="Crop the scan with a box that has handles",
    )
    window.cleaning.crop_tool_requested.connect(crop.setChecked)
    line = actions.make(
        "profile line",
        "&Profile line",
        window.map.set_drawing,
        keys="P",
        glyph="profile",
        checkable=True,
        tip="Draw a line in the map to cut along",
    )
    window.map.drawing_changed.connect(line.setChecked)
    _make_places(actions, window)
    actions.make("leave", "&Leave the tool", partial(leave, window), keys="Esc", needs_scan=False)


def _make_places(actions: Actions, window: MainWindow) -> None:
    feed, make = window.feeds.suspect, actions.make
    make(
        "next place",
        "Ne&xt suspicious place",
        partial(feed.step, 1),
        keys=["F4", "."],
        glyph="next",
        tip="Go to the next place where layers are doubtful",
    )
    make(
        "previous place",
        "Pre&vious suspicious place",
        partial(feed.step, -1),
        keys=["Shift+F4", ","],
        glyph="previous",
    )
    make("select place", "Select the suspicious pl&ace", feed.select, keys="Ctrl+.", glyph="target")


def fill(actions: Actions) -> None:
    """Fill the menu."""
    tools = actions.menu(
        "&Tools", [*TOOLS, None, *select.BRUSH, select.KEYBOARD, None, "crop", "profile line"]
    )
    actions.fill(tools, [None, *PLACES, None, "leave"])


def leave(window: MainWindow) -> None:
    """Leave the tool in use, else stop what is being made, else dismiss the newest message."""
    if put_away(window):
        return
    if window.document.busy or window.feeds.demo.is_busy:
        window.cancel()
    else:
        window.message_bar.dismiss_newest()


def put_away(window: MainWindow) -> bool:
    """Leave every tool; False when there was none in use. A stroke under way ends first, then its tool."""
    if window.select_tools.leave():
        return True
    used = [tool for name in ("crop", "profile line") if (tool := window.actions_[name]).isChecked()]
    for tool in used:
        tool.setChecked(False)
    return bool(used)
