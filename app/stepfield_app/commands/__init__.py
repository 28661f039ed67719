"""What the window can be told to do: its actions, menus and toolbars, one module a menu."""

from __future__ import annotations

from stepfield_app.actions import Actions
from stepfield_app.commands import edit, file, help, layers, select, tools, view
from stepfield_app.commands.filing import Filing
from stepfield_app.toolbars import TOOLBARS
from stepfield_app.workbench import Workbench


def make(bench: Workbench, filing: Filing) -> Actions:
    """Make every action and put it where it is looked for."""
    actions = Actions(bench.frame)
    file.make(actions, bench, filing)
    edit.make(actions, bench)
    view.make(actions, bench)
    layers.make(actions, bench)
    tools.make(actions, bench)
    select.make(actions, bench)
    help.make(actions, bench.frame)
    file.fill(actions, bench.frame, filing)
    edit.fill(actions)
    view.fill(actions, bench)
    layers.fill(actions)
    tools.fill(actions)
    help.fill(actions)
    for title, names in TOOLBARS.items():
        actions.toolbar(title, names)
    return actions
