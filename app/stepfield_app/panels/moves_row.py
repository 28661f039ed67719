"""How a row of the list of edits is painted: its text, and below it what became of it."""

from __future__ import annotations

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from stepfield_app.appearance import numbers_font
from stepfield_app.icons import icon
from stepfield_app.panels.moves_model import MoveRole, MoveRow
from stepfield_app.style_sheet import mixed
from stepfield_app.theme import DARK, Theme

#: Height of a row and of a line of it, distance from the edges, side of the warning, size of small text.
ROW_HEIGHT, LINE, INSET, MARK, SMALL = 44, 18, 8, 16, 11


class MoveDelegate(QStyledItemDelegate):
    """Paints edits; those that no longer fit carry a warning."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = DARK

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self._theme = theme

    def sizeHint(self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex) -> QSize:  # noqa: N802
        """Every row has two lines."""
        return QSize(200, ROW_HEIGHT)

    def paint(
        self, painter: QPainter, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> None:
        """Paint one row."""
        row: MoveRow = index.data(MoveRole.ROW)
        theme, room = self._theme, option.rect.adjusted(INSET, 4, -INSET, -4)
        painter.save()
        self._paint_ground(painter, option)
        if not row.fits:
            place = QRect(room.left(), room.top() + (room.height() - MARK) // 2, MARK, MARK)
            icon("warning", theme.warning).paint(painter, place)
            room.setLeft(place.right() + INSET)
        font = numbers_font(option.font)
        painter.setFont(font)
        painter.setPen(QColor(theme.text))
        _write(painter, QRect(room.left(), room.top(), room.width(), LINE), row.text)
        font.setPixelSize(SMALL)
        painter.setFont(font)
        painter.setPen(QColor(theme.muted if row.fits else theme.warning))
        _write(painter, QRect(room.left(), room.top() + LINE, room.width(), LINE), row.account)
        painter.restore()

    def _paint_ground(self, painter: QPainter, option: QStyleOptionViewItem) -> None:
        theme, state = self._theme, option.state
        share = 0.22 if state & QStyle.StateFlag.State_Selected else 0.0
        ground = mixed(theme.panel, theme.accent, share)
        if state & QStyle.StateFlag.State_MouseOver:
            ground = mixed(ground, theme.text, 0.06)
        painter.fillRect(option.rect, QColor(ground))
        painter.setPen(QPen(QColor(theme.line), 1))
        painter.drawLine(option.rect.bottomLeft(), option.rect.bottomRight())


def _write(painter: QPainter, room: QRect, text: str) -> None:
    fitting = painter.fontMetrics().elidedText(text, Qt.TextElideMode.ElideRight, room.width())
    painter.drawText(room, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, fitting)
