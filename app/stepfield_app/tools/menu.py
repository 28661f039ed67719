"""The menu of a view: select what is here, move what is selected."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from stepfield_app.editor import Editor
from stepfield_app.icons import icon
from stepfield_app.panels.move_menu import fill_move_menu
from stepfield_app.selection import Selection
from stepfield_app.tools.selecting import SelectingTool


def open_menu(
    tool: SelectingTool,
    at: QPointF,
    selection: Selection,
    editor: Editor,
    commands: Sequence[QAction],
) -> QMenu:
    """Open the menu at a pixel of a view; it deletes itself.

    Parameters
    ----------
    tool : SelectingTool
        Of the view.
    at : QPointF
    selection : Selection
    editor : Editor
    commands : sequence of QAction
        What the Edit menu can do to a selection.
    """
    surface = tool.ground.surface
    menu = QMenu(surface)
    menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    if tool.ground.is_over(at):
        menu.addAction(icon("click"), "Select the pillar here", partial(tool.point, at, kind="click"))
        menu.addAction(icon("surface"), "Select the surface here", partial(tool.point, at, kind="surface"))
        menu.addSeparator()
    moving = menu.addMenu("&Move to")
    moving.setEnabled(selection.count > 0)
    fill_move_menu(moving, editor)
    menu.addSeparator()
    menu.addActions(list(commands))
    menu.popup(surface.mapToGlobal(at.toPoint()))
    return menu
