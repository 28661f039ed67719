"""The Layers menu: where the selection goes, and what can be done with the active layer."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtGui import QKeySequence, QShortcut

from stepfield.layers import UNASSIGNED
from stepfield_app.actions import Actions
from stepfield_app.panels.move_menu import KEYS

if TYPE_CHECKING:
    from stepfield_app.main_window import MainWindow

#: Actions on the active layer: name, text, key, icon, explanation; the name is the wish's too.
OF_LAYER = (
    ("merge", "&Merge…", "Ctrl+M", "merge", "Put the active layer into another one; the numbers come first"),
    ("split", "S&plit at an elevation…", "Ctrl+Shift+M", "split", "Part the active layer at an elevation"),
    ("up", "Move &up", "Ctrl+Up", "up", "Exchange the active layer with the one above"),
    ("down", "Move &down", "Ctrl+Down", "down", "Exchange the active layer with the one below"),
    ("toggle_locked", "&Lock or unlock", "Ctrl+L", "locked", "Nothing goes into or out of a locked layer"),
    ("remove", "&Remove", "Ctrl+Del", "remove", "Put the active layer's pillars into Unassigned"),
)


def make(actions: Actions, window: MainWindow) -> None:
    """Make the actions of the menu."""
    _make_moves(actions, window)
    actions.make(
        "new layer",
        "&New layer",
        window.layer_editing.new,
        keys="Ctrl+Shift+N",
        glyph="new layer",
        tip="Make an empty layer",
    )
    for wish, text, keys, glyph, tip in OF_LAYER:
        do = getattr(window.layer_editing, wish)
        actions.make(f"layer {wish}", text, do, keys=keys, glyph=glyph, tip=tip)
    for name, text, keys, step in (
        ("layer above", "Go to the layer abo&ve", "Ctrl+PgUp", 1),
        ("layer below", "Go to the layer &below", "Ctrl+PgDown", -1),
    ):
        actions.make(name, text, partial(_go, window, step), keys=keys, tip="Make it the active one")
    actions.make("show all layers", "Show &all", window.layers.show_all, keys="Ctrl+Shift+H", glyph="visible")
    window.layer_editing.merge_wanted.connect(partial(merge, window))
    window.layer_editing.split_wanted.connect(partial(split, window))


def fill(actions: Actions) -> None:
    """Fill the menu."""
    layers = actions.menu("&Layers", [])
    moves = layers.addMenu("Move the &selection to")
    actions.fill(moves, [*(f"to layer {number}" for number in range(1, KEYS + 1)), "to unassigned"])
    actions.fill(moves, [None, "to new layer"])
    actions.fill(layers, [None, "new layer", "layer merge", "layer split", None, "layer up", "layer down"])
    actions.fill(layers, ["layer toggle_locked", "layer remove", None])
    actions.fill(layers, ["layer above", "layer below", "show all layers"])


def _go(window: MainWindow, step: int) -> None:
    """Make the next layer up or down the active one; below the lowest is Unassigned."""
    document = window.document
    if document.answer is not None:
        highest = len(document.answer.result.layers) - 1
        document.set_active_layer(min(highest, max(UNASSIGNED, document.active_layer + step)))


def merge(window: MainWindow, source: int, target: int) -> None:
    """Ask into which layer another one goes, with the numbers, and do it."""
    from stepfield_app.dialogs.merge import MergeDialog

    dialog = MergeDialog(window.editor, source, target, window)
    if dialog.exec():
        window.editor.merge(source, dialog.target)
    dialog.deleteLater()


def split(window: MainWindow, layer: int) -> None:
    """Ask where a layer is parted, and do it."""
    from stepfield_app.dialogs.split import SplitDialog

    answer = window.document.answer
    if answer is None or layer >= len(answer.result.layers):
        return
    of = next(target for target in window.editor.targets if target.to == layer)
    if not len(answer.result.layers[layer].pillars):
        window.editor.told.emit(f"{of.name} is empty: there is nothing to split")
        return
    dialog = SplitDialog(answer.result, layer, of.name, of.colour, window.appearance.theme, window)
    if dialog.exec():
        window.editor.split(layer, dialog.elevation)
    dialog.deleteLater()


def _make_moves(actions: Actions, window: MainWindow) -> None:
    """Make the actions that move the selection: a digit takes it to a layer."""
    editor, shortcuts = window.editor, []
    for number in range(1, KEYS + 1):
        action = actions.make(
            f"to layer {number}",
            f"Move to layer &{number}",
            partial(editor.move_to, number - 1),
            keys=str(number),
            tip=f"Move the selected pillars to layer {number}",
        )
        action.setVisible(False)
        shortcuts.append(_say_there_is_none(window, number))
    actions.make(
        "to unassigned",
        "Move to &Unassigned",
        partial(editor.move_to, -1),
        keys="0",
        tip="Take the selected pillars out of all layers",
    )
    actions.make(
        "to new layer",
        "Move to a &new layer",
        partial(editor.new_layer, move_selection=True),
        keys="Shift+N",
        glyph="new layer",
        tip="Make a layer of the selected pillars",
    )
    _follow_names(actions, window, shortcuts)


def _say_there_is_none(window: MainWindow, number: int) -> QShortcut:
    """Let the digit of a layer that is not there say so: an action that is hidden says nothing."""
    shortcut = QShortcut(QKeySequence(str(number)), window)
    shortcut.activated.connect(lambda: window.editor.told.emit(f"There is no layer {number}"))
    shortcut.setEnabled(False)
    return shortcut


def _follow_names(actions: Actions, window: MainWindow, shortcuts: Sequence[QShortcut]) -> None:
    """Let the menu have an entry for each layer there is, under its name."""
    known: dict[int, str] = {}

    def follow(_: object) -> None:
        names = {target.to: target.name for target in window.editor.targets}
        if names == known:  # as at nearly every step of a slider
            return
        known.clear()
        known.update(names)
        for place, shortcut in enumerate(shortcuts):
            shortcut.setEnabled(bool(names) and place not in names)
            action = actions[f"to layer {place + 1}"]
            action.setVisible(place in names)
            name = names.get(place, "").replace("&", "&&")
            action.setText(f"&{place + 1}  {name}")

    for signal in (window.document.answer_changed, window.document.project_changed):
        signal.connect(follow)
