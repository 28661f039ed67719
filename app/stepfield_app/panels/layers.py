"""The layers panel: which layers there are, which of them are shown, and which one is worked on."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QItemSelectionModel, QModelIndex, QPersistentModelIndex, QPoint, Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import (
    QColorDialog,
    QLabel,
    QMenu,
    QStackedLayout,
    QVBoxLayout,
    QWidget,
)

from stepfield.layers import UNASSIGNED
from stepfield.project import LayerStyle, Project
from stepfield_app.appearance import icon
from stepfield_app.document import Document
from stepfield_app.panels.layer_row import LayerDelegate
from stepfield_app.panels.layers_list import LayersList
from stepfield_app.panels.layers_model import LayerRow, LayersModel, Role
from stepfield_app.panels.row_layout import Part
from stepfield_app.requests import Answer
from stepfield_app.scenes.summary import LayerSummary
from stepfield_app.theme import Theme

EMPTY = "Open a scan: its layers appear here, the highest first. Show, hide, name and colour them."


class LayersPanel(QWidget):
    """Lists the layers; every change goes through the document, but for a layer shown alone for a while."""

    visibility_changed = Signal()
    lock_wanted = Signal(int, bool)
    menu_made = Signal(object, QMenu)  # LayerRow: others may add what they can do with it

    def __init__(self, document: Document, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._document = document
        self._styles: tuple[LayerStyle, ...] | None = None
        self.model = LayersModel(self)
        self.view = LayersList()
        self.view.setModel(self.model)
        self._delegate = LayerDelegate(self.view)
        self.view.setItemDelegate(self._delegate)
        self._empty = QLabel(EMPTY, wordWrap=True, alignment=Qt.AlignmentFlag.AlignCenter, margin=16)
        self._empty.setProperty("role", "muted")
        content = QWidget()
        self._content = QVBoxLayout(content)
        self._content.setContentsMargins(0, 0, 0, 0)
        self._content.setSpacing(0)
        self._content.addWidget(self.view, 1)
        self._stack = QStackedLayout(self)
        self._stack.addWidget(self._empty)
        self._stack.addWidget(content)
        self._connect()
        self._take_project(document.project)
        self.model.set_active(document.active_layer)

    def _connect(self) -> None:
        self._document.project_changed.connect(self._take_project)
        self._document.answer_changed.connect(self._take_answer)
        self._document.active_layer_changed.connect(self._take_active)
        self.model.renamed.connect(self._rename)
        self.model.visibility_changed.connect(self.visibility_changed)
        self.model.modelReset.connect(self._take_active)
        self.view.selectionModel().currentChanged.connect(self._activate)
        self.view.key_pressed.connect(self._act_on_key)
        self.view.customContextMenuRequested.connect(self._show_menu)
        self._delegate.part_clicked.connect(self._act_on_click)

    # --- What it is given -----------------------------------------------------------------------------------

    def set_layers(self, layers: Sequence[LayerSummary]) -> None:
        """Show the layers of a result; none shows how to get some."""
        self.model.set_layers(layers)
        self._stack.setCurrentIndex(1 if layers else 0)

    def add_foot(self, foot: QWidget) -> None:
        """Put something below the list."""
        self._content.addWidget(foot)

    def set_thumbnails(self, thumbnails: Mapping[int, NDArray[np.uint8]]) -> None:
        """Show small pictures of layers, by number; arrays of shape (rows, columns, 4), uint8."""
        self.model.set_thumbnails(thumbnails)

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self._delegate.set_theme(theme)
        self.view.set_theme(theme)

    def visible_layers(self) -> tuple[int, ...]:
        """Numbers of the layers that are shown, ascending, -1 for Unassigned."""
        return self.model.visible_layers

    def _take_answer(self, answer: Answer | None) -> None:
        self.set_layers(answer.summaries() if answer is not None else ())

    def _take_project(self, project: Project) -> None:
        if project.layers != self._styles:
            self._styles = project.layers
            self.model.set_styles(project.layers)

    def _take_active(self) -> None:
        """Show which layer is active, without making it so again."""
        active = self._document.active_layer
        self.model.set_active(active)
        current = self.model.index(self.model.row_of(active))
        self.view.selectionModel().setCurrentIndex(current, QItemSelectionModel.SelectionFlag.ClearAndSelect)
        self.view.scrollTo(current)

    # --- What the operator does -----------------------------------------------------------------------------

    def toggle_visible(self, row: LayerRow) -> None:
        """Show or hide a layer; what is shown alone stops being so."""
        if self.model.solo is not None:
            self.model.set_solo(None)
        elif row.index == UNASSIGNED:
            self.model.set_rest_shown(not row.is_visible)
        else:
            text = f"{'Hide' if row.is_visible else 'Show'} {row.name}"
            self._document.set_style(text, row.index, visible=not row.is_visible)

    def toggle_solo(self, row: LayerRow) -> None:
        """Show one layer alone, or all as before."""
        self.model.set_solo(None if row.is_solo else row.index)

    def show_all(self) -> None:
        """Show every layer, in one step that can be undone."""
        self.model.set_solo(None)
        self.model.set_rest_shown(True)
        project = self._document.project
        styles = tuple(style.model_copy(update={"visible": True}) for style in project.layers)
        self._document.edit("Show all layers", project.model_copy(update={"layers": styles}))

    def rename(self, row: LayerRow) -> None:
        """Let the name be edited in its place."""
        self.view.edit(self.model.index(self.model.row_of(row.index)))

    def choose_colour(self, row: LayerRow) -> None:
        """Ask for the colour of a layer."""
        colour = QColorDialog.getColor(QColor(row.colour), self, f"Colour of {row.name}")
        if colour.isValid():
            self.set_colour(row, colour.name())

    def set_colour(self, row: LayerRow, colour: str | None) -> None:
        """Give a layer a colour as #rrggbb, or the usual one again."""
        self._document.set_style(f"Colour of {row.name}", row.index, color=colour)

    def menu_for(self, row: LayerRow) -> QMenu:
        """Make the menu of a row."""
        menu, is_layer = QMenu(self), row.index != UNASSIGNED
        entries: tuple[tuple[str, str, bool, Callable[[], None]] | None, ...] = (
            ("rename", "Rename\tF2", is_layer, lambda: self.rename(row)),
            ("colour", "Colour…", is_layer, lambda: self.choose_colour(row)),
            ("reset", "Usual colour", is_layer, lambda: self.set_colour(row, None)),
            None,
            ("visible", "Show only this layer\tS", not row.is_solo, lambda: self.toggle_solo(row)),
            ("layers", "Show all layers", True, self.show_all),
        )
        for entry in entries:
            if entry is None:
                menu.addSeparator()
                continue
            meaning, text, is_enabled, act = entry
            action = menu.addAction(icon(meaning), text, act)
            action.setEnabled(is_enabled)
        self.menu_made.emit(row, menu)
        return menu

    def _rename(self, index: int, name: str) -> None:
        self._document.set_style(f"Rename to {name}", index, name=name)

    def _activate(self, current: QModelIndex) -> None:
        if current.isValid():
            self._document.set_active_layer(current.data(Role.ROW).index)

    def _act_on_click(self, index: QPersistentModelIndex, part: Part, is_alt: bool) -> None:
        row: LayerRow = index.data(Role.ROW)
        if part is Part.SOLO or (part is Part.EYE and is_alt):
            self.toggle_solo(row)
        elif part is Part.EYE:
            self.toggle_visible(row)
        elif part is Part.LOCK and row.index != UNASSIGNED:
            self.lock_wanted.emit(row.index, not row.is_locked)
        elif part is Part.SWATCH and row.index != UNASSIGNED:
            self.choose_colour(row)

    def _act_on_key(self, key: Qt.Key) -> None:
        current = self.view.currentIndex()
        if current.isValid():
            row = current.data(Role.ROW)
            (self.toggle_visible if key == Qt.Key.Key_Space else self.toggle_solo)(row)

    def _show_menu(self, place: QPoint) -> None:
        index = self.view.indexAt(place)
        if index.isValid():
            menu = self.menu_for(index.data(Role.ROW))
            menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
            menu.popup(self.view.viewport().mapToGlobal(place))
