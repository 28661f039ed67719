"""Lets the layers panel edit: drops, buttons, menus and keys become wishes of the editor."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from stepfield.layers import UNASSIGNED
from stepfield_app.document import Document
from stepfield_app.editor import Editor
from stepfield_app.icons import icon
from stepfield_app.panels.layers import LayersPanel
from stepfield_app.panels.layers_bar import LayersBar
from stepfield_app.panels.layers_drops import LayersDrops
from stepfield_app.panels.layers_model import LayerRow
from stepfield_app.panels.move_menu import colour_icon
from stepfield_app.wording import counted

#: Stands for a target that is still to be chosen.
TO_BE_CHOSEN = -1


class LayersEditing(QObject):
    """Adds the editor's part to a layers panel.

    Parameters
    ----------
    document : Document
    panel : LayersPanel
    editor : Editor
    """

    merge_wanted = Signal(int, int)  # which layer, and into which or TO_BE_CHOSEN
    split_wanted = Signal(int)

    def __init__(self, document: Document, panel: LayersPanel, editor: Editor) -> None:
        super().__init__(panel)
        self._document, self._panel, self._editor = document, panel, editor
        self.bar = LayersBar()
        self.drops = LayersDrops(panel.view, panel.model, editor)
        panel.add_foot(self.bar)
        self._connect()
        self._show_choice()
        self._show_active()

    def _connect(self) -> None:
        document, editor, bar = self._document, self._editor, self.bar
        for signal in (document.active_layer_changed, document.answer_changed, document.project_changed):
            signal.connect(lambda _: self._show_active())
        editor.conflict_changed.connect(bar.set_conflict)
        editor.selection.changed.connect(self._show_selected)
        bar.conflict_chosen.connect(editor.set_conflict)
        bar.pressed.connect(lambda name: getattr(self, name)())
        bar.lock_wanted.connect(self.set_locked)
        bar.pillars_dropped.connect(partial(editor.new_layer, move_selection=True))
        self._panel.lock_wanted.connect(editor.set_locked)
        self._panel.menu_made.connect(self._extend)

    # --- What acts on the active layer ----------------------------------------------------------------------

    def new(self) -> None:
        """Make an empty layer."""
        self._editor.new_layer()

    def merge(self) -> None:
        """Ask into which layer the active one goes."""
        if self.has_active and self._count > 1:
            self.merge_wanted.emit(self._document.active_layer, TO_BE_CHOSEN)

    def split(self) -> None:
        """Ask where to part the active layer."""
        if self.has_active:
            self.split_wanted.emit(self._document.active_layer)

    def up(self) -> None:
        """Exchange the active layer with the one above."""
        self._step(1)

    def down(self) -> None:
        """Exchange the active layer with the one below."""
        self._step(-1)

    def set_locked(self, is_locked: bool) -> None:
        """Lock the active layer, or no more."""
        if self.has_active:
            self._editor.set_locked(self._document.active_layer, is_locked)

    def toggle_locked(self) -> None:
        """Lock the active layer if it is not."""
        self.set_locked(self._document.active_layer not in self._editor.locked)

    def remove(self) -> None:
        """Take the active layer away."""
        if self.has_active:
            self._editor.remove(self._document.active_layer)

    @property
    def has_active(self) -> bool:
        """Whether a layer is active, and not Unassigned."""
        return 0 <= self._document.active_layer < self._count

    @property
    def _count(self) -> int:
        return len(self._document.answer.result.layers) if self._document.answer else 0

    def _step(self, step: int) -> None:
        """Exchange with a neighbour, once the last exchange is on the screen: a key may be held down."""
        layer = self._document.active_layer
        is_shown = self._editor.is_idle and not self._document.pending
        if self.has_active and is_shown and 0 <= layer + step < self._count:
            self._editor.exchange(layer, layer + step)

    # --- What it shows --------------------------------------------------------------------------------------

    def _show_active(self) -> None:
        active = self._document.active_layer
        self.bar.set_active(active, self._count, active in self._editor.locked)

    def _show_choice(self) -> None:
        self.bar.set_conflict(self._editor.conflict)

    def _show_selected(self) -> None:
        self._panel.model.set_selected(self._editor.selection.by_layer)

    # --- The menu of a row ----------------------------------------------------------------------------------

    def _extend(self, row: LayerRow, menu: QMenu) -> None:
        """Put what edits a layer into its menu: the selection first, the layer before what only shows it."""
        rename, *_, line, _only, _all = menu.actions()
        self._offer_selection(row, menu, rename)
        if row.index != UNASSIGNED:
            self._offer_layer(row, menu, line)

    def _offer_selection(self, row: LayerRow, menu: QMenu, before: QAction) -> None:
        editor, layer = self._editor, row.index
        plan = editor.preview(layer) if editor.selection.count else None
        text = "Move the selection here"
        if plan is not None:
            text = f"{text} ({plan.sentence})"
        can_move = bool(editor.selection.count) and (plan is None or bool(plan.moves))
        _insert(menu, before, "layers", text, partial(editor.move_to, layer), can_move)
        everything = partial(editor.selection.all_of, layer)
        _insert(menu, before, "select all", "Select all of it", everything, row.summary.pillars > 0)
        menu.insertSeparator(before)

    def _offer_layer(self, row: LayerRow, menu: QMenu, before: QAction) -> None:
        editor, layer, count = self._editor, row.index, self._count
        verb, glyph = ("Unlock", "unlocked") if row.is_locked else ("Lock", "locked")
        removed = counted(row.summary.pillars, "pillar")
        menu.insertSeparator(before)
        _insert(menu, before, glyph, verb, partial(editor.set_locked, layer, not row.is_locked))
        menu.insertMenu(before, self._merging(row, menu))
        _insert(menu, before, "split", "Split at an elevation…", partial(self.split_wanted.emit, layer))
        up, down = partial(editor.exchange, layer, layer + 1), partial(editor.exchange, layer, layer - 1)
        _insert(menu, before, "up", "Move up", up, layer + 1 < count)
        _insert(menu, before, "down", "Move down", down, layer > 0)
        text = f"Remove ({removed} to Unassigned)"
        _insert(menu, before, "remove", text, partial(editor.remove, layer), count > 1 and not row.is_locked)

    def _merging(self, row: LayerRow, parent: QMenu) -> QMenu:
        """Make the menu of layers that a layer can be merged into; numbers are said before it is done."""
        menu = QMenu("Merge into", parent)
        menu.setIcon(icon("merge"))
        for target in self._editor.targets:
            if target.to not in (row.index, UNASSIGNED):
                act = partial(self.merge_wanted.emit, row.index, target.to)
                name = f"{target.name}…".replace("&", "&&")
                menu.addAction(colour_icon(target.colour), name, act).setEnabled(not target.is_locked)
        menu.setEnabled(not menu.isEmpty() and not row.is_locked)
        return menu


def _insert(
    menu: QMenu, before: QAction, glyph: str, text: str, act: Callable[[], object], is_enabled: bool = True
) -> None:
    """Put an entry into a menu."""
    action = QAction(icon(glyph), text, menu)
    action.triggered.connect(lambda: act())
    action.setEnabled(is_enabled)
    menu.insertAction(before, action)
