"""The line a profile is cut along: two ends to drag, and a band of adjustable width."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from stepfield_app.theme import Theme, rgb

Place = tuple[float, float]
Part = Literal["start", "end", "whole"]

#: Radius of an end, and how near the cursor must come, logical pixels.
RADIUS, REACH = 5.0, 9.0
#: Opacity of the band, 0 to 255.
BAND = 56


@dataclass(frozen=True)
class ProfileLine:
    """A line on the map and the width of the band whose points count, metres."""

    start: Place
    end: Place
    width: float

    @property
    def length(self) -> float:
        """Distance between the ends, metres."""
        return math.dist(self.start, self.end)

    def moved(self, part: Part, right: float, up: float) -> ProfileLine:
        """Return the line with an end, or all of it, moved."""
        start, end = self.start, self.end
        if part != "end":
            start = start[0] + right, start[1] + up
        if part != "start":
            end = end[0] + right, end[1] + up
        return replace(self, start=start, end=end)

    def corners(self) -> list[Place]:
        """Return the corners of the band."""
        if not self.length:
            return [self.start] * 4
        half = self.width / 2 / self.length
        across = (self.start[1] - self.end[1]) * half, (self.end[0] - self.start[0]) * half
        (x0, y0), (x1, y1), (dx, dy) = self.start, self.end, across
        return [(x0 + dx, y0 + dy), (x1 + dx, y1 + dy), (x1 - dx, y1 - dy), (x0 - dx, y0 - dy)]


def part_at(start: QPointF, end: QPointF, at: QPointF) -> Part | None:
    """Return what a press takes hold of, given the pixels of the ends and of the cursor."""
    ends: tuple[tuple[Part, QPointF], ...] = (("end", end), ("start", start))
    for part, place in ends:
        if math.hypot(*(at - place).toTuple()) <= REACH:
            return part
    return "whole" if _distance(start, end, at) <= REACH / 2 else None


def _distance(start: QPointF, end: QPointF, at: QPointF) -> float:
    along = end - start
    squared = QPointF.dotProduct(along, along)
    share = QPointF.dotProduct(at - start, along) / squared if squared else 0.0
    return math.hypot(*(at - start - along * min(1.0, max(0.0, share))).toTuple())


def paint_line(painter: QPainter, ends: tuple[QPointF, QPointF], band: QPolygonF, theme: Theme) -> None:
    """Paint the line over the map so that it shows on every colour; everything in pixels."""
    accent = QColor(theme.accent)
    painter.setPen(QPen(accent, 1))
    painter.setBrush(QColor(*rgb(theme.accent), BAND))
    painter.drawPolygon(band)
    for colour, thickness in ((QColor(theme.window), 4.0), (accent, 2.0)):
        painter.setPen(QPen(colour, thickness))
        painter.drawLine(*ends)
    painter.setPen(QPen(QColor(theme.window), 1.5))
    painter.setBrush(accent)
    for end, letter in zip(ends, "AB", strict=True):
        painter.drawEllipse(end, RADIUS, RADIUS)
        _paint_letter(painter, end, letter, theme)


def paint_mark(painter: QPainter, at: QPointF, theme: Theme) -> None:
    """Mark a place on the line."""
    painter.setBrush(QColor(theme.window))
    painter.setPen(QPen(QColor(theme.accent), 2))
    painter.drawEllipse(at, RADIUS - 1, RADIUS - 1)


def _paint_letter(painter: QPainter, end: QPointF, letter: str, theme: Theme) -> None:
    """Name an end as the profile's axis does, on a plate that any map leaves readable."""
    painter.save()
    room = painter.fontMetrics().boundingRect("MM").toRectF()
    room.moveCenter(end + QPointF(0, -2.2 * RADIUS - 4))
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(*rgb(theme.window), 190))
    painter.drawRoundedRect(room, 3, 3)
    painter.setPen(QColor(theme.text))
    painter.drawText(room, Qt.AlignmentFlag.AlignCenter, letter)
    painter.restore()
