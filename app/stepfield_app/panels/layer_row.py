"""How a row of the layers panel is painted, and what becomes of clicks in it."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QModelIndex, QPersistentModelIndex, QRect, QSize, Qt, Signal
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
from stepfield_app.panels.layers_model import LayerRow, Notice, Role
from stepfield_app.panels.row_layout import BAR, SMALL, Part, RowLayout, row_height
from stepfield_app.style_sheet import mixed
from stepfield_app.theme import DARK, Theme
from stepfield_app.wording import grouped, metres, short

AnyIndex = QModelIndex | QPersistentModelIndex


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
            for name in ("visible", "hidden", "locked", "unlocked")
            for colour in (theme.text, theme.muted)
        }

    def sizeHint(self, option: QStyleOptionViewItem, index: AnyIndex) -> QSize:  # noqa: N802
        """Every row is as high as its picture, which is smaller in a low list."""
        view = option.widget
        assert isinstance(view, QAbstractItemView)
        return QSize(240, row_height(view.viewport().height()))

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
        painter.setFont(numbers_font(option.font))
        self._paint_name(painter, layout.name(), row)
        if row.notice is None:
            self._paint_figures(painter, layout.figures(), row)
            self._paint_buttons(painter, layout, row, is_hovered)
        else:
            self._paint_notice(painter, layout.notice(), row.notice)
        self._paint_thumbnail(painter, layout.thumbnail(), index.data(Role.THUMBNAIL), row)
        painter.restore()

    def _paint_ground(
        self, painter: QPainter, layout: RowLayout, row: LayerRow, is_hovered: bool, has_focus: bool
    ) -> None:
        room, theme = layout.room, self._theme
        ground = mixed(theme.panel, theme.accent, 0.22 if row.is_active else 0.0)
        if is_hovered and row.notice is None:
            ground = mixed(ground, theme.text, 0.06)
        edge = theme.accent if has_focus else ""
        if row.notice is not None:
            edge = theme.error if row.notice.is_refusal else theme.accent
            ground = mixed(theme.panel, edge, 0.3)
        painter.fillRect(room, QColor(ground))
        painter.setPen(QPen(QColor(theme.line), 1))
        painter.drawLine(room.bottomLeft(), room.bottomRight())
        if row.is_active:
            painter.fillRect(QRect(room.left(), room.top(), BAR, room.height()), QColor(theme.accent))
        if edge:
            painter.setPen(QPen(QColor(edge), 1 if row.notice is None else 2))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(room.adjusted(1, 1, -1, -1) if row.notice else room.adjusted(0, 0, -1, -1))

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

    def _paint_name(self, painter: QPainter, room: QRect, row: LayerRow) -> None:
        theme, font = self._theme, painter.font()
        font.setBold(row.is_active)
        painter.setFont(font)
        painter.setPen(QColor(theme.text if row.is_visible else theme.muted))
        _draw(painter, room, row.name)
        font.setBold(False)
        font.setPixelSize(SMALL)
        painter.setFont(font)

    def _paint_figures(self, painter: QPainter, room: QRect, row: LayerRow) -> None:
        """Write how many pillars there are and are selected, and the elevation where that leaves room."""
        theme, right, advance = (
            self._theme,
            Qt.AlignmentFlag.AlignRight,
            painter.fontMetrics().horizontalAdvance,
        )
        total, selected = _counts(row, lambda text: advance(text) <= room.width())
        before = room.adjusted(0, 0, -advance(total), 0)
        painter.setPen(QColor(theme.muted))
        _draw(painter, room, total, right)
        elevation = metres(row.summary.elevation) if row.index != UNASSIGNED else ""
        if advance(f"{elevation}  {selected}") <= before.width():
            _draw(painter, room, elevation)
        painter.setPen(QColor(theme.accent))
        _draw(painter, before, selected, right)

    def _paint_notice(self, painter: QPainter, room: QRect, notice: Notice) -> None:
        painter.setPen(QColor(self._theme.text))
        _draw(painter, room, notice.text)

    def _paint_buttons(self, painter: QPainter, layout: RowLayout, row: LayerRow, is_hovered: bool) -> None:
        theme = self._theme
        if is_hovered or row.is_solo:
            self._paint_solo(painter, layout.solo(), row.is_solo)
        if row.index != UNASSIGNED and (is_hovered or row.is_locked):
            name = "locked" if row.is_locked else "unlocked"
            colour = theme.text if row.is_locked else theme.muted
            self._icons[name, colour].paint(painter, layout.lock().adjusted(5, 5, -5, -5))

    def _paint_solo(self, painter: QPainter, room: QRect, is_on: bool) -> None:
        theme, plate = self._theme, room.adjusted(4, 4, -4, -4)
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


def _counts(row: LayerRow, fits: Callable[[str], bool]) -> tuple[str, str]:
    """How many pillars there are, and how many of them are selected; in few figures where they must be."""
    if not row.selected:
        return grouped(row.summary.pillars), ""
    total, selected = f" of {grouped(row.summary.pillars)}", grouped(row.selected)
    if fits(selected + total):
        return total, selected
    return f" of {short(row.summary.pillars)}", short(row.selected)


def _draw(
    painter: QPainter, room: QRect, text: str, side: Qt.AlignmentFlag = Qt.AlignmentFlag.AlignLeft
) -> None:
    """Write a line, shortened where it does not fit."""
    fitting = painter.fontMetrics().elidedText(text, Qt.TextElideMode.ElideRight, room.width())
    painter.drawText(room, side | Qt.AlignmentFlag.AlignVCenter, fitting)
