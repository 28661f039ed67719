"""Cursors of the selecting tools: a cross, with a plus or a minus where it adds or subtracts."""

from __future__ import annotations

from functools import cache

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QCursor, QGuiApplication, QPainter, QPen, QPixmap

from stepfield_app.theme import HALO, OUTLINES
from stepfield_app.tools.strokes import How

#: Side of the picture and its hot spot, logical pixels.
SIDE, MIDDLE = 32, 12.5
#: From the middle to the ends of the cross, and the gap around the middle.
ARM, GAP = 9.0, 3.0
#: Middle of the sign and half its length.
SIGN, HALF = QPointF(23.5, 22.5), 4.0


def cursor_for(how: How) -> QCursor:
    """Return the cursor for what a stroke would do."""
    return _drawn(how, QGuiApplication.primaryScreen().devicePixelRatio())


@cache
def _drawn(how: How, ratio: float) -> QCursor:
    picture = QPixmap(round(SIDE * ratio), round(SIDE * ratio))
    picture.setDevicePixelRatio(ratio)
    picture.fill(Qt.GlobalColor.transparent)
    painter = QPainter(picture)
    for colour, thickness in ((HALO, 3.0), (OUTLINES["selection"], 1.0)):
        painter.setPen(QPen(QColor(colour), thickness))
        for start, end in _lines(how):
            painter.drawLine(start, end)
    painter.end()
    return QCursor(picture, int(MIDDLE), int(MIDDLE))


def _lines(how: How) -> list[tuple[QPointF, QPointF]]:
    middle = QPointF(MIDDLE, MIDDLE)
    ways = [QPointF(1, 0), QPointF(-1, 0), QPointF(0, 1), QPointF(0, -1)]
    lines = [(middle + way * GAP, middle + way * ARM) for way in ways]
    if how != "replace":
        lines.append((SIGN - QPointF(HALF, 0), SIGN + QPointF(HALF, 0)))
    if how == "add":
        lines.append((SIGN - QPointF(0, HALF), SIGN + QPointF(0, HALF)))
    return lines
