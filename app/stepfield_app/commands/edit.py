"""The Edit menu: undo and redo by name."""

from __future__ import annotations

from functools import partial

from PySide6.QtGui import QAction

from stepfield_app.actions import Actions, Keys
from stepfield_app.commands import select
from stepfield_app.workbench import Workbench


def make(actions: Actions, bench: Workbench) -> None:
    """Make the actions of the menu."""
    stack = bench.document.undo_stack
    undo = actions.make("undo", "&Undo", stack.undo, keys=Keys.Undo, glyph="undo", needs_scan=False)
    redo = actions.make(
        "redo", "&Redo", stack.redo, keys=["Ctrl+Shift+Z", "Ctrl+Y"], glyph="redo", needs_scan=False
    )
    for action, can, text, verb in (
        (undo, stack.canUndoChanged, stack.undoTextChanged, "&Undo"),
        (redo, stack.canRedoChanged, stack.redoTextChanged, "&Redo"),
    ):
        action.setEnabled(False)
        can.connect(action.setEnabled)
        text.connect(partial(_name_step, action, verb))


def _name_step(action: QAction, verb: str, step: str) -> None:
    escaped = step.replace("&", "&&")  # a layer may be called what it likes
    text = f"{verb} {escaped}".strip()
    if action.text() != text:  # a step that takes another one in tells both
        action.setText(text)


def fill(actions: Actions) -> None:
    """Fill the menu."""
    edit = actions.menu("&Edit", ["undo", "redo", None, *select.EDIT])
    actions.fill(edit.addMenu("R&each"), select.REACHES)
