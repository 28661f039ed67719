"""The Help menu: the sheet of keys, and about."""

from __future__ import annotations

from functools import partial

from stepfield_app.actions import Actions
from stepfield_app.commands import select
from stepfield_app.frame import Frame

#: What the mouse does, for the sheet of keys: no action knows it.
GESTURES = {
    "3-D views": [
        ("Orbit", "Left drag"),
        ("Pan", "Right or middle drag"),
        ("Zoom to the cursor", "Wheel"),
        ("Turn around a point", "Double-click it"),
        ("Orbit, pan, zoom", "Arrows, Shift+arrows, + −"),
        ("One view large, or all", "Double-click its title"),
    ],
    **select.GESTURES,
    "Map and profile": [
        ("Pan", "Drag"),
        ("Zoom to the cursor", "Wheel"),
        ("Move a profile line", "Drag it or its ends"),
    ],
}


def make(actions: Actions, frame: Frame) -> None:
    """Make the actions of the menu."""
    actions.make("keys", "&Keys", partial(_show_keys, frame), keys="F1", glyph="shortcuts", needs_scan=False)
    actions.make("about", "&About Stepfield", partial(_show_about, frame), glyph="info", needs_scan=False)


def fill(actions: Actions) -> None:
    """Fill the menu."""
    actions.menu("&Help", ["keys", "about"])


def _show_keys(frame: Frame) -> None:
    from stepfield_app.dialogs.shortcuts import ShortcutSheet

    sheet = ShortcutSheet(frame, GESTURES)
    sheet.exec()
    sheet.deleteLater()


def _show_about(frame: Frame) -> None:
    from stepfield_app.dialogs.about import AboutDialog

    about = AboutDialog(frame)
    about.exec()
    about.deleteLater()
