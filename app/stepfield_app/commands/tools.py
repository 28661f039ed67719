"""The Tools menu: what takes the mouse before the camera does."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from stepfield_app.actions import Actions

if TYPE_CHECKING:
    from stepfield_app.main_window import MainWindow


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
    actions.make("leave", "&Leave the tool", partial(leave, window), keys="Esc", needs_scan=False)


def fill(actions: Actions) -> None:
    """Fill the menu."""
    actions.menu("&Tools", ["crop", "profile line", None, "leave"])


def leave(window: MainWindow) -> None:
    """Leave the tool in use, else stop what is being made, else dismiss the newest message."""
    if put_away(window):
        return
    if window.document.busy or window.demo_feed.is_busy:
        window.cancel()
    else:
        window.message_bar.dismiss_newest()


def put_away(window: MainWindow) -> bool:
    """Leave every tool; False when there was none in use."""
    used = [tool for name in ("crop", "profile line") if (tool := window.actions_[name]).isChecked()]
    for tool in used:
        tool.setChecked(False)
    return bool(used)
