"""The menu of places the selection can be moved to."""

from __future__ import annotations

from functools import partial

from PySide6.QtGui import QColor, QIcon, QPixmap
from PySide6.QtWidgets import QMenu

from stepfield_app.editor import Editor
from stepfield_app.icons import ICON_SIZE, icon

#: Layers that have a key of their own.
KEYS = 9


def fill_move_menu(menu: QMenu, editor: Editor) -> None:
    """Fill a menu with every layer, Unassigned and a new layer; each says what moving there would do."""
    menu.setToolTipsVisible(True)
    for target in editor.targets:
        key = f"\t{target.to + 1}" if target.to < KEYS else ""
        name = f"{target.name}{' (locked)' if target.is_locked else ''}".replace("&", "&&")
        action = menu.addAction(colour_icon(target.colour), name + key, partial(editor.move_to, target.to))
        plan = editor.preview(target.to)
        action.setEnabled(not target.is_locked)
        action.setToolTip(plan.sentence if plan is not None else "")
    menu.addSeparator()
    menu.addAction(icon("new layer"), "New layer", partial(editor.new_layer, move_selection=True))


def colour_icon(colour: str) -> QIcon:
    """Return a square of a colour."""
    square = QPixmap(ICON_SIZE, ICON_SIZE)
    square.fill(QColor(colour))
    return QIcon(square)
