"""The list of layers itself: its keys, and what it paints while something is dragged over it."""

from __future__ import annotations

from PySide6.QtCore import QRect, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QCursor,
    QDrag,
    QKeyEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QPixmap,
    QResizeEvent,
)
from PySide6.QtWidgets import QAbstractItemView, QFrame, QListView, QWidget

from stepfield_app.panels.layers_model import Notice
from stepfield_app.panels.row_layout import FEW_ROWS, ROW_HEIGHT, row_height
from stepfield_app.theme import DARK, Theme

#: Height of what is said below the rows, its distance from the edges, and width of the line between rows.
FOOT, INSET, LINE = 40, 8, 2
#: Opacity of a row on its way: what it covers must be seen.
CARRIED = 0.5


class LayersList(QListView):
    """Rows of one height; Space and S act on the row under the keyboard."""

    key_pressed = Signal(Qt.Key)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = DARK
        self._gap: int | None = None
        self._foot: Notice | None = None
        self.setAccessibleName("Layers, the highest first")
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setUniformItemSizes(True)
        self.setMouseTracking(True)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        trigger = QAbstractItemView.EditTrigger
        self.setEditTriggers(trigger.DoubleClicked | trigger.EditKeyPressed)

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self._theme = theme
        self.viewport().update()

    @property
    def gap(self) -> int | None:
        """Row above which a dragged row would go, None while none is dragged."""
        return self._gap

    def set_gap(self, gap: int | None) -> None:
        """Show where a dragged row would go: above the row of this number."""
        self._gap = gap
        self.viewport().update()

    @property
    def foot(self) -> Notice | None:
        """What it says below the rows."""
        return self._foot

    def set_foot(self, notice: Notice | None) -> None:
        """Say below the rows what a drop there would do."""
        self._foot = notice
        self.viewport().update()

    def below_rows(self) -> int:
        """Where the rows end, pixels from the top of what is seen."""
        count = self.model().rowCount() if self.model() else 0
        return self.visualRect(self.model().index(count - 1, 0)).bottom() + 1 if count else 0

    def sizeHint(self) -> QSize:  # noqa: N802
        """Return a size that shows five layers."""
        return QSize(300, FEW_ROWS * ROW_HEIGHT)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Make all rows lower where few would be seen, so that the layers of most scans are."""
        super().resizeEvent(event)
        if row_height(event.oldSize().height()) != row_height(event.size().height()):
            self.scheduleDelayedItemsLayout()

    def startDrag(self, supported: Qt.DropAction) -> None:  # noqa: N802
        """Carry the row under the hand, so that one sees through it where it would go."""
        index = self.currentIndex()
        room = self.visualRect(index)
        drag = QDrag(self)
        drag.setMimeData(self.model().mimeData([index]))
        drag.setPixmap(_faded(self.viewport().grab(room)))
        drag.setHotSpot(self.viewport().mapFromGlobal(QCursor.pos()) - room.topLeft())
        drag.exec(supported)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Take Space and S; the rest moves through the rows."""
        if event.key() in (Qt.Key.Key_Space, Qt.Key.Key_S) and not event.modifiers():
            self.key_pressed.emit(Qt.Key(event.key()))
        else:
            super().keyPressEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint the rows, and over them what a drop would do."""
        super().paintEvent(event)
        if self._gap is None and self._foot is None:
            return
        painter = QPainter(self.viewport())
        if self._gap is not None:
            self._paint_gap(painter, self._gap)
        if self._foot is not None:
            self._paint_foot(painter, self._foot)

    def _paint_gap(self, painter: QPainter, gap: int) -> None:
        first = self.visualRect(self.model().index(0, 0))
        place = max(first.top() + gap * first.height(), LINE)
        painter.fillRect(QRect(0, place - LINE, self.viewport().width(), LINE), QColor(self._theme.accent))

    def _paint_foot(self, painter: QPainter, notice: Notice) -> None:
        view = self.viewport().rect()
        room = QRect(INSET, self.below_rows() + INSET, view.width() - 2 * INSET, FOOT)
        room.moveBottom(min(room.bottom(), view.bottom() - LINE))
        colour = QColor(self._theme.error if notice.is_refusal else self._theme.accent)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(colour, 1, Qt.PenStyle.DashLine))
        painter.setBrush(QColor(self._theme.panel))
        painter.drawRoundedRect(room, 4, 4)
        painter.setPen(QColor(self._theme.text))
        text = painter.fontMetrics().elidedText(
            notice.text, Qt.TextElideMode.ElideRight, room.width() - 2 * INSET
        )
        painter.drawText(room, Qt.AlignmentFlag.AlignCenter, text)


def _faded(picture: QPixmap) -> QPixmap:
    """Return a picture that can be seen through."""
    faded = QPixmap(picture.size())
    faded.setDevicePixelRatio(picture.devicePixelRatio())
    faded.fill(Qt.GlobalColor.transparent)
    painter = QPainter(faded)
    painter.setOpacity(CARRIED)
    painter.drawPixmap(0, 0, picture)
    painter.end()
    return faded
