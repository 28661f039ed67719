"""What a hand draws over a view while it selects: the shape, what it does to the selection, how it looks."""

from __future__ import annotations

import math
from typing import Literal

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen, QPolygonF

from stepfield_app.scenes.lens import Lens
from stepfield_app.scenes.shapes import Kind
from stepfield_app.theme import HALO, Theme, rgb
from stepfield_app.views.tool import Hand

How = Literal["replace", "add", "subtract"]

#: A path is not followed more finely than this, logical pixels.
FINENESS = 2.0
#: Parts of its radius that a brush must go on to be somewhere else.
PARTS = 6
#: Shapes smaller than this are clicks, logical pixels.
LEAST = 3.0
#: Thickness of the line and of the dark one under it, logical pixels.
LINE, UNDER = 1.5, 3.5
#: Opacity of what is inside a shape, and of where a brush has been, 0 to 255.
INSIDE, TRAIL = 32, 72


def how_of(keys: Qt.KeyboardModifier) -> How:
    """What a stroke does: Shift adds; Alt subtracts, and so does Ctrl where desktops keep Alt."""
    if keys & (Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.ControlModifier):
        return "subtract"
    return "add" if keys & Qt.KeyboardModifier.ShiftModifier else "replace"


class Stroke:
    """A shape from press to release; also the token of its gesture.

    Parameters
    ----------
    kind : str
    how : str
    hand : Hand
        Where it begins.
    radius : float
        Of a brush, logical pixels.
    """

    def __init__(self, kind: Kind, how: How, hand: Hand, radius: float) -> None:
        self.kind: Kind = kind
        self.how, self.radius = how, radius
        self.path = [hand.at]
        self.lens = Lens()

    @property
    def grows(self) -> bool:
        """Whether it takes what it passes at once."""
        return self.kind == "brush"

    @property
    def _fineness(self) -> float:
        return max(FINENESS, self.radius / PARTS) if self.grows else FINENESS

    @property
    def is_small(self) -> bool:
        """Whether it covers nothing to speak of."""
        room = QPolygonF(self.path).boundingRect()
        return max(room.width(), room.height()) < LEAST

    def reach(self, at: QPointF) -> bool:
        """Go on to a place; False where that is hardly another one."""
        if self.kind == "rectangle":
            self.path[1:] = [at]
        elif math.hypot(*(at - self.path[-1]).toTuple()) < self._fineness:
            return False
        elif self.kind in ("lasso", "brush"):
            self.path.append(at)
        return True

    def paint(self, painter: QPainter, theme: Theme) -> None:
        """Paint it in the accent over a dark halo, so that it shows on everything."""
        if self.kind in ("click", "surface"):
            return
        outline = self._outline()
        if self.grows:
            width = QPen(QColor(*rgb(theme.accent), TRAIL), 2 * self.radius)
            width.setCapStyle(Qt.PenCapStyle.RoundCap)
            width.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
            painter.strokePath(outline, width)
            paint_brush(painter, self.path[-1], self.radius, theme)
        else:
            painter.fillPath(outline, QColor(*rgb(theme.accent), INSIDE))
            paint_line(painter, outline, theme)

    def _outline(self) -> QPainterPath:
        outline = QPainterPath(self.path[0])
        if self.kind == "rectangle":
            outline.addRect(QRectF(self.path[0], self.path[-1]).normalized())
        else:
            for at in self.path[1:]:
                outline.lineTo(at)
            if self.grows:
                outline.lineTo(self.path[-1] + QPointF(0.01, 0))  # a path of one place has no width
            else:
                outline.closeSubpath()
        return outline


def paint_brush(painter: QPainter, at: QPointF, radius: float, theme: Theme) -> None:
    """Paint the circle that says what a brush would touch."""
    circle = QPainterPath()
    circle.addEllipse(at, radius, radius)
    paint_line(painter, circle, theme)


def paint_line(painter: QPainter, outline: QPainterPath, theme: Theme) -> None:
    """Paint a line in the accent over a dark halo."""
    for colour, thickness in ((HALO, UNDER), (theme.accent, LINE)):
        painter.strokePath(outline, QPen(QColor(colour), thickness))
