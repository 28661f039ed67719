"""Points and pillars of a profile as items of a plot, quick enough to follow a hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QRectF
from PySide6.QtGui import QColor, QImage, QPainter, QPen

from stepfield_app.views.pictures import Section

Group = tuple[QColor, list[QRectF], list[QLineF]]

#: Side of a point, logical pixels.
POINT = 2
#: Opacity of a pillar, 0 to 255, and thickness of the line at its height.
FILL, TOP = 56, 2.0


class Dots(pg.GraphicsObject):  # type: ignore[misc]
    """Points as small squares, written into an image: Qt takes ten times as long to draw each of them."""

    def __init__(self) -> None:
        super().__init__()
        self._x = self._y = np.zeros(0)
        self._colours = np.zeros(0, np.uint32)
        self._bounds = QRectF()
        self._drawn: tuple[Any, QImage, NDArray[np.uint32]] | None = None

    def set_dots(self, section: Section) -> None:
        """Show the points of another section."""
        red, green, blue = section.colours.astype(np.uint32).T
        packed = np.uint32(0xFF000000) | red << np.uint32(16) | green << np.uint32(8) | blue
        x, y = section.distance, section.elevation
        self._x, self._y, self._colours, self._drawn = x, y, packed[section.codes], None
        self.prepareGeometryChange()
        self._bounds = QRectF(x.min(), y.min(), np.ptp(x), np.ptp(y)) if len(x) else QRectF()
        self.update()

    def boundingRect(self) -> QRectF:  # noqa: N802
        """Return the room the points take, with that of their squares."""
        across, up = self.pixelVectors()
        if across is None or up is None:
            return self._bounds
        right, top = POINT * abs(across.x()), POINT * abs(up.y())
        return self._bounds.adjusted(-right, -top, right, top)

    def viewTransformChanged(self) -> None:  # noqa: N802
        """The squares take other room after zooming."""
        self.prepareGeometryChange()

    def paint(self, painter: QPainter, *_: Any) -> None:
        """Paint the points that are visible."""
        if not len(self._x):
            return
        to_scene = self.sceneTransform()
        area = self.getViewBox().sceneBoundingRect().toAlignedRect()
        ratio = painter.device().devicePixelRatioF()
        key = (to_scene, area, ratio)
        if self._drawn is None or self._drawn[0] != key:
            pixels = self._written(to_scene, area, ratio)
            height, width = pixels.shape
            image = QImage(pixels.data, width, height, 4 * width, QImage.Format.Format_ARGB32_Premultiplied)
            self._drawn = key, image, pixels
        painter.setTransform(to_scene.inverted()[0], True)
        painter.drawImage(QRectF(area), self._drawn[1])

    def _written(self, to_scene: Any, area: Any, ratio: float) -> NDArray[np.uint32]:
        """Write the points into an image of the device pixels of ``area``; later points over earlier ones."""
        width, height = round(area.width() * ratio), round(area.height() * ratio)
        side = max(1, round(POINT * ratio))
        column = (self._x * to_scene.m11() + (to_scene.dx() - area.left())) * ratio - (side - 1) / 2
        row = (self._y * to_scene.m22() + (to_scene.dy() - area.top())) * ratio - (side - 1) / 2
        seen = (column > 0) & (column < width - side) & (row > 0) & (row < height - side)
        place = row[seen].astype(np.int64) * width + column[seen].astype(np.int64)
        colours = self._colours[seen]
        pixels = np.zeros(width * height, np.uint32)
        for shift in (down * width + right for down in range(side) for right in range(side)):
            pixels[place + shift] = colours
        return pixels.reshape(height, width)


class Blocks(pg.GraphicsObject):  # type: ignore[misc]
    """Pillars in section: from the lowest to the highest point, with a line at their height."""

    def __init__(self) -> None:
        super().__init__()
        self._groups: list[Group] = []
        self._bounds = QRectF()

    def set_blocks(self, section: Section) -> None:
        """Show the pillars of another section."""
        self.prepareGeometryChange()
        self._groups = [_group(section, code) for code in np.unique(section.pillar_codes)]
        self._bounds = QRectF()
        if len(section.spans):
            low, high = section.spans.min(axis=0), section.spans.max(axis=0)
            self._bounds = QRectF(low[0], low[2], high[1] - low[0], high[3] - low[2])
        self.update()

    def boundingRect(self) -> QRectF:  # noqa: N802
        """Return the room the pillars take."""
        return self._bounds

    def paint(self, painter: QPainter, *_: Any) -> None:
        """Paint the pillars, then the lines at their heights over all of them."""
        for colour, rectangles, _lines in self._groups:
            edge = QPen(_faded(colour, 2 * FILL), 1)
            edge.setCosmetic(True)
            painter.setPen(edge)
            painter.setBrush(_faded(colour, FILL))
            painter.drawRects(rectangles)
        for colour, _rectangles, lines in self._groups:
            pen = QPen(colour, TOP)
            pen.setCosmetic(True)
            painter.setPen(pen)
            painter.drawLines(lines)


def _group(section: Section, code: int) -> Group:
    """Pillars of one colour, and the lines at their heights."""
    chosen = section.pillar_codes == code
    spans, tops = section.spans[chosen].tolist(), section.tops[chosen].tolist()
    rectangles = [QRectF(start, low, end - start, high - low) for start, end, low, high in spans]
    lines = [QLineF(start, top, end, top) for (start, end, _, _), top in zip(spans, tops, strict=True)]
    return QColor(*section.colours[code].tolist()), rectangles, lines


def _faded(colour: QColor, opacity: int) -> QColor:
    return QColor(colour.red(), colour.green(), colour.blue(), opacity)
