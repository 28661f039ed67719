"""What the window can be told to do: its actions, menus and toolbars, one module a menu."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stepfield_app.actions import Actions
from stepfield_app.commands import edit, file, help, layers, select, tools, view
from stepfield_app.toolbars import TOOLBARS

if TYPE_CHECKING:
    from stepfield_app.main_window import MainWindow


def make(window: MainWindow) -> Actions:
    """Make every action and put it where it is looked for."""
    actions = Actions(window)
    file.make(actions, window)
    edit.make(actions, window)
    view.make(actions, window)
    layers.make(actions, window)
    tools.make(actions, window)
    select.make(actions, window)
    help.make(actions, window)
    file.fill(actions, window)
    edit.fill(actions)
    view.fill(actions, window)
    layers.fill(actions)
    tools.fill(actions)
    help.fill(actions)
    for title, names in TOOLBARS.items():
        actions.toolbar(title, names)
    return actions
