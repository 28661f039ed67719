"""The layers of the result as a list model: the highest first, Unassigned at the foot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QAbstractListModel, QMimeData, QModelIndex, QPersistentModelIndex, Qt, Signal
from PySide6.QtGui import QImage

from stepfield.layers import UNASSIGNED
from stepfield.project import LayerStyle
from stepfield_app.scenes.summary import LayerSummary
from stepfield_app.theme import layer_colour
from stepfield_app.wording import counted, grouped, metres

AnyIndex = QModelIndex | QPersistentModelIndex


#: What a row carries when it is dragged: the number of its layer as text.
LAYER_MIME = "application/x-stepfield-layer"


@dataclass(frozen=True)
class Notice:
    """What a drop on a row would do, or why it can do nothing."""

    text: str
    is_refusal: bool = False


@dataclass(frozen=True)
class LayerRow:
    """A row as it is painted.

    ``notice`` says what a drop would do, and takes the place of the figures.
    """

    summary: LayerSummary
    name: str
    colour: str
    is_visible: bool
    is_active: bool
    is_solo: bool
    is_locked: bool = False
    selected: int = 0
    notice: Notice | None = None

    @property
    def index(self) -> int:
        """Number of the layer."""
        return self.summary.index

    @property
    def sentence(self) -> str:
        """The row in words, for those who do not see it."""
        state = "shown" if self.is_visible else "hidden"
        average = f", average elevation {metres(self.summary.elevation)}" if self.summary.pillars else ""
        selected = f" of which {grouped(self.selected)} selected" if self.selected else ""
        locked = ", locked" if self.is_locked else ""
        pillars = counted(self.summary.pillars, "pillar")
        return f"{self.name}, {pillars}{selected}{self._walls}{average}, {state}{locked}"

    @property
    def _walls(self) -> str:
        if self.summary.is_obstacles:
            return ", walls and columns"
        return f", {grouped(self.summary.vertical)} of them vertical" if self.summary.vertical else ""


class Role(IntEnum):
    """What a row is asked for beyond Qt's own roles."""

    ROW = Qt.ItemDataRole.UserRole
    THUMBNAIL = Qt.ItemDataRole.UserRole + 1


class LayersModel(QAbstractListModel):
    """Rows of layers; tells only of the rows that changed, unless their number did."""

    #: Layer and new name, once the operator has typed one.
    renamed = Signal(int, str)
    #: Which layers are visible has changed.
    visibility_changed = Signal()

    def __init__(self, parent: Any = None) -> None:
        super().__init__(parent)
        self._summaries: tuple[LayerSummary, ...] = ()
        self._styles: dict[int, LayerStyle] = {}
        self._rows: list[LayerRow] = []
        self._thumbnails: dict[int, QImage] = {}
        self._active = 0
        self._solo: int | None = None
        self._is_rest_shown = True
        self._selected: Mapping[int, int] = {}
        self._notice: tuple[int, Notice] | None = None

    # --- What it is given -----------------------------------------------------------------------------------

    def set_layers(self, summaries: Sequence[LayerSummary]) -> None:
        """Show other layers, the lowest first and Unassigned before them or absent."""
        self._summaries = tuple(sorted(summaries, key=lambda summary: -summary.index))
        if self._solo is not None and self._solo not in {summary.index for summary in summaries}:
            self._solo = None
        self._refresh()

    def set_styles(self, styles: Sequence[LayerStyle]) -> None:
        """Take the operator's names, colours and visibility."""
        self._styles = {style.index: style for style in styles}
        self._refresh()

    def set_active(self, index: int) -> None:
        """Highlight another layer."""
        self._active = index
        self._refresh()

    def set_solo(self, index: int | None) -> None:
        """Show one layer alone, or as before."""
        self._solo = index
        self._refresh()

    def set_rest_shown(self, is_shown: bool) -> None:
        """Show or hide the pillars that are in no layer."""
        self._is_rest_shown = is_shown
        self._refresh()

    def set_selected(self, selected: Mapping[int, int]) -> None:
        """Show how many pillars are selected in each layer."""
        self._selected = dict(selected)
        self._refresh()

    def set_notice(self, index: int, notice: Notice | None) -> None:
        """Let one row, and no other, say what a drop on it would do."""
        self._notice = None if notice is None else (index, notice)
        self._refresh()

    def set_thumbnails(self, thumbnails: Mapping[int, NDArray[np.uint8]]) -> None:
        """Show small pictures of layers, each of shape (rows, columns, 4), red, green, blue, opacity."""
        self._thumbnails = {index: _image(pixels) for index, pixels in thumbnails.items()}
        if self._rows:
            self.dataChanged.emit(self.index(0), self.index(len(self._rows) - 1), [Role.THUMBNAIL])

    # --- What it tells --------------------------------------------------------------------------------------

    @property
    def rows(self) -> tuple[LayerRow, ...]:
        """All rows, from the top."""
        return tuple(self._rows)

    @property
    def solo(self) -> int | None:
        """The layer shown alone."""
        return self._solo

    @property
    def visible_layers(self) -> tuple[int, ...]:
        """Numbers of the layers that are shown, ascending, -1 for Unassigned."""
        return tuple(sorted(row.index for row in self._rows if row.is_visible))

    def row_of(self, index: int) -> int:
        """Row of a layer, -1 where there is none."""
        return next((place for place, row in enumerate(self._rows) if row.index == index), -1)

    def rowCount(self, parent: AnyIndex = QModelIndex()) -> int:  # noqa: N802, B008
        """Count the layers, Unassigned included."""
        return 0 if parent.isValid() else len(self._rows)

    def data(self, index: AnyIndex, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return what a row shows."""
        if not index.isValid():
            return None
        row = self._rows[index.row()]
        match role:
            case Qt.ItemDataRole.DisplayRole | Qt.ItemDataRole.EditRole:
                return row.name
            case Qt.ItemDataRole.AccessibleTextRole:
                return row.sentence
            case Role.ROW:
                return row
            case Role.THUMBNAIL:
                return self._thumbnails.get(row.index)
        return None

    def flags(self, index: AnyIndex) -> Qt.ItemFlag:
        """Every layer can be chosen; all but Unassigned can be named and dragged."""
        if not index.isValid():
            return Qt.ItemFlag.NoItemFlags
        flags = Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemNeverHasChildren
        is_layer = self._rows[index.row()].index != UNASSIGNED
        own = Qt.ItemFlag.ItemIsEditable | Qt.ItemFlag.ItemIsDragEnabled
        return flags | own if is_layer else flags

    def setData(self, index: AnyIndex, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:  # noqa: N802
        """Ask for another name; it is shown once the document has it."""
        row, name = self._rows[index.row()], str(value).strip()
        if role != Qt.ItemDataRole.EditRole or not name or name == row.name:
            return False
        self.renamed.emit(row.index, name)
        return True

    def mimeTypes(self) -> list[str]:  # noqa: N802
        """What a dragged row carries."""
        return [LAYER_MIME]

    def mimeData(self, indexes: Sequence[QModelIndex]) -> QMimeData:  # noqa: N802
        """Take a row along."""
        data = QMimeData()
        data.setData(LAYER_MIME, str(self._rows[indexes[0].row()].index).encode())
        return data

    def supportedDragActions(self) -> Qt.DropAction:  # noqa: N802
        """Rows are dragged to another place."""
        return Qt.DropAction.MoveAction

    # --- Rows -----------------------------------------------------------------------------------------------

    def _refresh(self) -> None:
        before, visible = self._rows, self.visible_layers
        rows = [self._row(summary) for summary in self._summaries]
        if len(rows) != len(before):
            self.beginResetModel()
            self._rows = rows
            self.endResetModel()
        else:
            self._rows = rows
            for place, (old, new) in enumerate(zip(before, rows, strict=True)):
                if old != new:
                    self.dataChanged.emit(self.index(place), self.index(place))
        if self.visible_layers != visible:
            self.visibility_changed.emit()

    def _row(self, summary: LayerSummary) -> LayerRow:
        index = summary.index
        style = self._styles.get(index) or LayerStyle(index=max(index, 0))
        is_shown = self._is_rest_shown if index == UNASSIGNED else style.visible
        return LayerRow(
            summary=summary,
            name=style.name or summary.name,
            colour=style.color or layer_colour(index),
            is_visible=is_shown if self._solo is None else index == self._solo,
            is_active=index == self._active,
            is_solo=index == self._solo,
            is_locked=style.locked and index != UNASSIGNED,
            selected=self._selected.get(index, 0),
            notice=self._notice[1] if self._notice and self._notice[0] == index else None,
        )


def _image(pixels: NDArray[np.uint8]) -> QImage:
    """Copy a small picture into one of Qt's."""
    rows, columns = pixels.shape[:2]
    whole = np.ascontiguousarray(pixels)
    return QImage(whole.data, columns, rows, 4 * columns, QImage.Format.Format_RGBA8888).copy()
