"""How a row of the layers panel is painted, and what a click in it means."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from PySide6.QtCore import QEvent, QModelIndex, QPersistentModelIndex, QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import QBrush, QColor, QHelpEvent, QIcon, QImage, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import (
    QAbstractItemView,
    QLineEdit,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QToolTip,
    QWidget,
)

from stepfield.layers import UNASSIGNED
from stepfield_app.appearance import ICON_SIZE, icon, numbers_font
from stepfield_app.panels.layers_model import LayerRow, Role
from stepfield_app.style_sheet import mixed
from stepfield_app.theme import DARK, Theme
from stepfield_app.wording import grouped, metres

AnyIndex = QModelIndex | QPersistentModelIndex

ROW_HEIGHT, THUMBNAIL, GAP, SWATCH, BAR, SMALL = 56, 48, 8, 14, 3, 11
#: Side of what can be clicked.
BUTTON = 24


class Part(Enum):
    """A part of a row that can be clicked, and the tooltip that explains it."""

    EYE = "Show or hide (Space); with Alt show only this layer"
    SWATCH = "Choose the colour"
    SOLO = "Show only this layer, or all as before (S)"
    REST = "Click to make it the active layer; double-click or F2 to rename"


@dataclass(frozen=True)
class RowLayout:
    """Where the parts of a row are."""

    room: QRect

    def eye(self) -> QRect:
        """Room of the eye."""
        return self._square(self.room.left() + BAR + 5, BUTTON)

    def swatch(self) -> QRect:
        """Room of the colour."""
        return self._square(self.eye().right() + 5, SWATCH)

    def thumbnail(self) -> QRect:
        """Room of the picture."""
        return self._square(self.room.right() - THUMBNAIL - 3, THUMBNAIL)

    def solo(self) -> QRect:
        """Room of the button that shows one layer alone."""
        return self._square(self.thumbnail().left() - BUTTON - 4, BUTTON)

    def text(self) -> QRect:
        """Room of name, count and elevation."""
        left, right = self.swatch().right() + 1 + GAP, self.solo().left() - 4
        return QRect(left, self.room.top() + 8, right - left, self.room.height() - 16)

    def name(self) -> QRect:
        """Room of the name: the upper line."""
        text = self.text()
        return QRect(text.left(), text.top(), text.width(), text.height() // 2)

    def figures(self) -> QRect:
        """Room of count and elevation: the lower line."""
        text, name = self.text(), self.name()
        return QRect(text.left(), name.bottom() + 1, text.width(), text.height() - name.height())

    def part_at(self, place: QPoint) -> Part:
        """Return what a click at a place means."""
        for part, room in ((Part.EYE, self.eye()), (Part.SOLO, self.solo()), (Part.SWATCH, self.swatch())):
            if room.contains(place):
                return part
        return Part.REST

    def _square(self, left: int, side: int) -> QRect:
        return QRect(left, self.room.center().y() - side // 2 + 1, side, side)


class LayerDelegate(QStyledItemDelegate):
    """Paints rows and turns clicks on their parts into signals."""

    #: Row of the model, which part of it was clicked, and whether Alt was held.
    part_clicked = Signal(QPersistentModelIndex, Part, bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.set_theme(DARK)

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self._theme = theme
        self._icons = {
            (name, colour): icon(name, colour)
            for name in ("visible", "hidden")
            for colour in (theme.text, theme.muted)
        }

    def sizeHint(self, option: QStyleOptionViewItem, index: AnyIndex) -> QSize:  # noqa: N802
        """Every row is as high as its picture."""
        return QSize(240, ROW_HEIGHT)

    # --- Painting -------------------------------------------------------------------------------------------

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: AnyIndex) -> None:
        """Paint one row."""
        row: LayerRow = index.data(Role.ROW)
        layout = RowLayout(option.rect)
        is_hovered = bool(option.state & QStyle.StateFlag.State_MouseOver)
        has_focus = bool(option.state & QStyle.StateFlag.State_HasFocus)
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_ground(painter, layout, row, is_hovered, has_focus)
        self._eye(row).paint(painter, _inner(layout.eye()))
        self._paint_swatch(painter, layout.swatch(), row)
        self._paint_text(painter, layout, row, option)
        if is_hovered or row.is_solo:
            self._paint_solo(painter, layout.solo(), row.is_solo)
        self._paint_thumbnail(painter, layout.thumbnail(), index.data(Role.THUMBNAIL), row)
        painter.restore()

    def _paint_ground(
        self, painter: QPainter, layout: RowLayout, row: LayerRow, is_hovered: bool, has_focus: bool
    ) -> None:
        room, theme = layout.room, self._theme
        share = 0.22 if row.is_active else 0.0
        ground = mixed(theme.panel, theme.accent, share)
        if is_hovered:
            ground = mixed(ground, theme.text, 0.06)
        painter.fillRect(room, QColor(ground))
        painter.setPen(QPen(QColor(theme.line), 1))
        painter.drawLine(room.bottomLeft(), room.bottomRight())
        if row.is_active:
            painter.fillRect(QRect(room.left(), room.top(), BAR, room.height()), QColor(theme.accent))
        if has_focus:
            painter.setPen(QPen(QColor(theme.accent), 1))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(room.adjusted(0, 0, -1, -1))

    def _eye(self, row: LayerRow) -> QIcon:
        if row.is_visible:
            return self._icons["visible", self._theme.text]
        return self._icons["hidden", self._theme.muted]

    def _paint_swatch(self, painter: QPainter, room: QRect, row: LayerRow) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        colour = QColor(row.colour)
        if row.index == UNASSIGNED:
            painter.setPen(QPen(colour, 1))
            painter.setBrush(QBrush(colour, Qt.BrushStyle.BDiagPattern))
        else:
            painter.setBrush(colour)
        painter.drawRoundedRect(room, 3, 3)

    def _paint_text(
        self, painter: QPainter, layout: RowLayout, row: LayerRow, option: QStyleOptionViewItem
    ) -> None:
        theme, middle = self._theme, Qt.AlignmentFlag.AlignVCenter
        font = numbers_font(option.font)
        font.setBold(row.is_active)
        painter.setFont(font)
        painter.setPen(QColor(theme.text if row.is_visible else theme.muted))
        room = layout.name()
        name = painter.fontMetrics().elidedText(row.name, Qt.TextElideMode.ElideRight, room.width())
        painter.drawText(room, Qt.AlignmentFlag.AlignLeft | middle, name)
        font.setBold(False)
        font.setPixelSize(SMALL)
        painter.setFont(font)
        painter.setPen(QColor(theme.muted))
        room = layout.figures()
        painter.drawText(room, Qt.AlignmentFlag.AlignRight | middle, grouped(row.summary.pillars))
        if row.index != UNASSIGNED:
            painter.drawText(room, Qt.AlignmentFlag.AlignLeft | middle, metres(row.summary.elevation))

    def _paint_solo(self, painter: QPainter, room: QRect, is_on: bool) -> None:
        theme, plate = self._theme, room.adjusted(3, 3, -3, -3)
        painter.setPen(QPen(QColor(theme.accent if is_on else theme.muted), 1))
        painter.setBrush(QColor(theme.accent) if is_on else Qt.BrushStyle.NoBrush)
        painter.drawRoundedRect(plate, 3, 3)
        painter.setPen(QColor(theme.panel if is_on else theme.muted))
        painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, "S")

    def _paint_thumbnail(self, painter: QPainter, room: QRect, image: QImage | None, row: LayerRow) -> None:
        painter.fillRect(room, QColor(self._theme.window))
        if image is None:
            return
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.setOpacity(1.0 if row.is_visible else 0.4)
        size = image.size().scaled(room.size(), Qt.AspectRatioMode.KeepAspectRatio)
        place = QRect(room.topLeft(), size)
        place.moveCenter(room.center())
        painter.drawImage(place, image)
        painter.setOpacity(1.0)

    # --- Clicks ---------------------------------------------------------------------------------------------

    def editorEvent(  # noqa: N802
        self, event: QEvent, model: object, option: QStyleOptionViewItem, index: AnyIndex
    ) -> bool:
        """Tell which part was pressed; the rest of a row is the view's."""
        if not isinstance(event, QMouseEvent) or event.button() != Qt.MouseButton.LeftButton:
            return False
        part = RowLayout(option.rect).part_at(event.position().toPoint())
        if part is Part.REST:
            return False
        if event.type() == QEvent.Type.MouseButtonPress or event.type() == QEvent.Type.MouseButtonDblClick:
            is_alt = bool(event.modifiers() & Qt.KeyboardModifier.AltModifier)
            self.part_clicked.emit(QPersistentModelIndex(index), part, is_alt)
        return True

    def helpEvent(  # noqa: N802
        self, event: QHelpEvent, view: QAbstractItemView, option: QStyleOptionViewItem, index: AnyIndex
    ) -> bool:
        """Explain the part under the cursor."""
        if event.type() != QEvent.Type.ToolTip or not index.isValid():
            return super().helpEvent(event, view, option, index)
        part = RowLayout(option.rect).part_at(event.pos())
        QToolTip.showText(event.globalPos(), f"{index.data(Role.ROW).sentence}\n{part.value}", view)
        return True

    def createEditor(  # noqa: N802
        self, parent: QWidget, option: QStyleOptionViewItem, index: AnyIndex
    ) -> QWidget:
        """Edit the name in its place."""
        editor = QLineEdit(parent, maxLength=80)
        editor.setAccessibleName("Name of the layer")
        return editor

    def updateEditorGeometry(  # noqa: N802
        self, editor: QWidget, option: QStyleOptionViewItem, index: AnyIndex
    ) -> None:
        """Lay the editor over the name."""
        room = RowLayout(option.rect).text()
        editor.setGeometry(room.adjusted(-7, 4, 0, -4))


def _inner(room: QRect) -> QRect:
    """Return the middle of a button, where its icon goes."""
    spare = (room.width() - ICON_SIZE) // 2
    return room.adjusted(spare, spare, -spare, -spare)
