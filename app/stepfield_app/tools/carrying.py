"""Carrying the selection from a view to a layer: the drag, and the drop on the map."""

from __future__ import annotations

from PySide6.QtCore import QMimeData, QObject, QPoint, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QDrag, QPainter, QPen, QPixmap
from PySide6.QtWidgets import QWidget

from stepfield_app.editor import PILLARS_MIME, Editor
from stepfield_app.theme import Theme
from stepfield_app.views.drop import Offer
from stepfield_app.views.map import MapView
from stepfield_app.wording import counted

#: Size of the label under the mouse: room around its text, height, rounding of its corners.
BESIDE, HEIGHT, CORNER = 10, 26, 4
#: Where the label is, seen from the mouse: below the row it is dragged over, which says what would happen.
AWAY = QPoint(-16, -28)


def carry(source: QWidget, count: int, theme: Theme) -> None:
    """Drag so many pillars from a widget until they are dropped."""
    data = QMimeData()
    data.setData(PILLARS_MIME, str(count).encode("ascii"))
    drag = QDrag(source)
    drag.setMimeData(data)
    drag.setPixmap(label(source, counted(count, "pillar"), theme))
    drag.setHotSpot(AWAY)
    drag.exec(Qt.DropAction.MoveAction)


def label(near: QWidget, text: str, theme: Theme) -> QPixmap:
    """Draw a text on a plate, sharp on the screen of a widget."""
    ratio, width = near.devicePixelRatioF(), near.fontMetrics().horizontalAdvance(text) + 2 * BESIDE
    picture = QPixmap(round(width * ratio), round(HEIGHT * ratio))
    picture.setDevicePixelRatio(ratio)
    picture.fill(Qt.GlobalColor.transparent)
    room = QRectF(0.5, 0.5, width - 1, HEIGHT - 1)
    painter = QPainter(picture)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setFont(near.font())
    painter.setPen(QPen(QColor(theme.accent), 1))
    painter.setBrush(QColor(theme.panel))
    painter.drawRoundedRect(room, CORNER, CORNER)
    painter.setPen(QColor(theme.text))
    painter.drawText(room, Qt.AlignmentFlag.AlignCenter, text)
    painter.end()
    return picture


class MapDrop(QObject):
    """Moves the selection to the layer that the map shows when it is dropped there."""

    offer_changed = Signal()

    def __init__(self, editor: Editor, view: MapView) -> None:
        super().__init__(view)
        self._editor, self._view = editor, view
        editor.previews_changed.connect(self.offer_changed)

    def knows(self, data: QMimeData) -> bool:
        """Whether pillars are dragged."""
        return data.hasFormat(PILLARS_MIME)

    def offer(self) -> Offer:
        """Say what moving them to the layer shown would do."""
        name, plan = self._editor.name_of(self._view.layer), self._editor.preview(self._view.layer)
        if plan is None:
            return Offer(f"{name}…", True)
        return Offer(f"{name}: {plan.sentence}", not plan.reason)

    def drop(self) -> None:
        """Move them."""
        self._editor.move_to(self._view.layer)
