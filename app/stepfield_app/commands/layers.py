"""The Layers menu: where the selection goes, and what can be done with the active layer."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from PySide6.QtGui import QKeySequence, QShortcut

from stepfield.layers import UNASSIGNED
from stepfield_app.actions import Actions
from stepfield_app.panels.move_menu import KEYS
from stepfield_app.workbench import Workbench

#: Actions on the active layer: name, text, key, icon, explanation; the name is the wish's too.
OF_LAYER = (
    ("merge", "&Merge…", "Ctrl+M", "merge", "Put the active layer into another one; the numbers come first"),
    ("split", "S&plit at an elevation…", "Ctrl+Shift+M", "split", "Part the active layer at an elevation"),
    ("up", "Move &up", "Ctrl+Up", "up", "Exchange the active layer with the one above"),
    ("down", "Move &down", "Ctrl+Down", "down", "Exchange the active layer with the one below"),
    ("toggle_locked", "&Lock or unlock", "Ctrl+L", "locked", "Nothing goes into or out of a locked layer"),
    ("remove", "&Remove", "Ctrl+Del", "remove", "Put the active layer's pillars into Unassigned"),
)


def make(actions: Actions, bench: Workbench) -> None:
    """Make the actions of the menu."""
    _make_moves(actions, bench)
    actions.make(
        "new layer",
        "&New layer",
        bench.layer_editing.new,
        keys="Ctrl+Shift+N",
        glyph="new layer",
        tip="Make an empty layer",
    )
    for wish, text, keys, glyph, tip in OF_LAYER:
        do = getattr(bench.layer_editing, wish)
        actions.make(f"layer {wish}", text, do, keys=keys, glyph=glyph, tip=tip)
    for name, text, keys, step in (
        ("layer above", "Go to the layer abo&ve", "Ctrl+PgUp", 1),
        ("layer below", "Go to the layer &below", "Ctrl+PgDown", -1),
    ):
        actions.make(name, text, partial(_go, bench, step), keys=keys, tip="Make it the active one")
    actions.make("show all layers", "Show &all", bench.layers.show_all, keys="Ctrl+Shift+H", glyph="visible")
    bench.layer_editing.merge_wanted.connect(partial(merge, bench))
    bench.layer_editing.split_wanted.connect(partial(split, bench))


def fill(actions: Actions) -> None:
    """Fill the menu."""
    layers = actions.menu("&Layers", [])
    moves = layers.addMenu("Move the &selection to")
    actions.fill(moves, [*(f"to layer {number}" for number in range(1, KEYS + 1)), "to unassigned"])
    actions.fill(moves, [None, "to new layer"])
    actions.fill(layers, [None, "new layer", "layer merge", "layer split", None, "layer up", "layer down"])
    actions.fill(layers, ["layer toggle_locked", "layer remove", None])
    actions.fill(layers, ["layer above", "layer below", "show all layers"])


def _go(bench: Workbench, step: int) -> None:
    """Make the next layer up or down the active one; below the lowest is Unassigned."""
    document = bench.document
    if document.answer is not None:
        highest = len(document.answer.result.layers) - 1
        document.set_active_layer(min(highest, max(UNASSIGNED, document.active_layer + step)))


def merge(bench: Workbench, source: int, target: int) -> None:
    """Ask into which layer another one goes, with the numbers, and do it."""
    from stepfield_app.dialogs.merge import MergeDialog

    dialog = MergeDialog(bench.editor, source, target, bench.frame)
    if dialog.exec():
        bench.editor.merge(source, dialog.target)
    dialog.deleteLater()


def split(bench: Workbench, layer: int) -> None:
    """Ask where a layer is parted, and do it."""
    from stepfield_app.dialogs.split import SplitDialog

    answer = bench.document.answer
    if answer is None or layer >= len(answer.result.layers):
        return
    of = next(target for target in bench.editor.targets if target.to == layer)
    if not len(answer.result.layers[layer].pillars):
        bench.editor.told.emit(f"{of.name} is empty: there is nothing to split")
        return
    dialog = SplitDialog(answer.result, layer, of.name, of.colour, bench.frame.appearance.theme, bench.frame)
    if dialog.exec():
        bench.editor.split(layer, dialog.elevation)
    dialog.deleteLater()


def _make_moves(actions: Actions, bench: Workbench) -> None:
    """Make the actions that move the selection: a digit takes it to a layer."""
    editor, shortcuts = bench.editor, []
    for number in range(1, KEYS + 1):
        action = actions.make(
            f"to layer {number}",
            f"Move to layer &{number}",
            partial(editor.move_to, number - 1),
            keys=str(number),
            tip=f"Move the selected pillars to layer {number}",
        )
        action.setVisible(False)
        shortcuts.append(_say_there_is_none(bench, number))
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
    _follow_names(actions, bench, shortcuts)


def _say_there_is_none(bench: Workbench, number: int) -> QShortcut:
    """Let the digit of a layer that is not there say so: an action that is hidden says nothing."""
    shortcut = QShortcut(QKeySequence(str(number)), bench.frame)
    shortcut.activated.connect(lambda: bench.editor.told.emit(f"There is no layer {number}"))
    shortcut.setEnabled(False)
    return shortcut


def _follow_names(actions: Actions, bench: Workbench, shortcuts: Sequence[QShortcut]) -> None:
    """Let the menu have an entry for each layer there is, under its name."""
    known: dict[int, str] = {}

    def follow(_: object) -> None:
        names = {target.to: target.name for target in bench.editor.targets}
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

    for signal in (bench.document.answer_changed, bench.document.project_changed):
        signal.connect(follow)
