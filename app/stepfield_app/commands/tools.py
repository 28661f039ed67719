"""The Tools menu: what takes the mouse before the camera does."""

from __future__ import annotations

from functools import partial

from stepfield_app.actions import Actions
from stepfield_app.commands import select
from stepfield_app.toolbars import TOOLS
from stepfield_app.workbench import Workbench

#: Names of the actions that lead from one suspicious place to the next.
PLACES = ["next place", "previous place", "select place"]


def make(actions: Actions, bench: Workbench) -> None:
    """Make the actions of the menu."""
    crop = actions.make(
        "crop",
        "&Crop box",
        bench.cleaning.set_crop_tool,
        keys="C",
        glyph="crop",
        checkable=True,
        tip="Crop the scan with a box that has handles",
    )
    bench.cleaning.crop_tool_requested.connect(crop.setChecked)
    line = actions.make(
        "profile line",
        "&Profile line",
        bench.map.set_drawing,
        keys="P",
        glyph="profile",
        checkable=True,
        tip="Draw a line in the map to cut along",
    )
    bench.map.drawing_changed.connect(line.setChecked)
    _make_places(actions, bench)
    actions.make("leave", "&Leave the tool", partial(leave, actions, bench), keys="Esc", needs_scan=False)


def _make_places(actions: Actions, bench: Workbench) -> None:
    feed, make = bench.feeds.suspect, actions.make
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


def leave(actions: Actions, bench: Workbench) -> None:
    """Leave the tool in use, else stop what is being made, else dismiss the newest message."""
    if put_away(actions, bench):
        return
    if bench.document.busy or bench.feeds.demo.is_busy:
        bench.frame.status.cancel_wanted.emit()
    else:
        bench.frame.message_bar.dismiss_newest()


def put_away(actions: Actions, bench: Workbench) -> bool:
    """Leave every tool; False when there was none in use. A stroke under way ends first, then its tool."""
    if bench.select_tools.leave():
        return True
    used = [tool for name in ("crop", "profile line") if (tool := actions[name]).isChecked()]
    for tool in used:
        tool.setChecked(False)
    return bool(used)
