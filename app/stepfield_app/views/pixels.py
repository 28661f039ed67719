"""Items of a plot that write their own pixels: Qt takes ten times as long for as many small shapes."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QRect, QRectF
from PySide6.QtGui import QImage, QPainter, QTransform

Floats = NDArray[np.float64]
Pixels = NDArray[np.uint32]


class PixelItem(pg.GraphicsObject):  # type: ignore[misc]
    """An item whose image is written anew when the view or what it shows has changed."""

    def __init__(self) -> None:
        super().__init__()
        self._bounds = QRectF()
        self._drawn: tuple[Any, QImage] | None = None
        self._pixels: Pixels = np.zeros((0, 0), np.uint32)

    @abstractmethod
    def write(self, pixels: Pixels, place: Place) -> None:
        """Write into ``pixels``, shape (height, width), premultiplied alpha, red, green and blue."""

    def changed(self, bounds: QRectF) -> None:
        """Draw anew; ``bounds`` is the room it takes in coordinates of the plot."""
        self.prepareGeometryChange()
        self._bounds, self._drawn = bounds, None
        self.update()

    def boundingRect(self) -> QRectF:  # noqa: N802
        """Return the room it takes."""
        return self._bounds

    @property
    def is_blank(self) -> bool:
        """Whether there is nothing to write."""
        return False

    def paint(self, painter: QPainter, *_: Any) -> None:
        """Paint the image over the whole plot."""
        if self.is_blank:
            return
        to_scene = self.sceneTransform()
        area = self.getViewBox().sceneBoundingRect().toAlignedRect()
        ratio = painter.device().devicePixelRatioF()
        key = (to_scene, area, ratio)
        if self._drawn is None or self._drawn[0] != key:
            self._drawn = key, self._image(Place(to_scene, area, ratio), area, ratio)
        painter.setTransform(to_scene.inverted()[0], True)
        painter.drawImage(QRectF(area), self._drawn[1])

    def _image(self, place: Place, area: QRect, ratio: float) -> QImage:
        """Write the image, into the memory of the last one where that has its size."""
        width, height = round(area.width() * ratio), round(area.height() * ratio)
        if self._pixels.shape != (height, width):
            self._pixels = np.zeros((height, width), np.uint32)
        else:
            self._pixels.fill(0)
        self.write(self._pixels, place)
        return QImage(self._pixels.data, width, height, 4 * width, QImage.Format.Format_ARGB32_Premultiplied)


class Place:
    """Turns coordinates of the plot into columns and rows of the image."""

    def __init__(self, to_scene: QTransform, area: QRect, ratio: float) -> None:
        self.ratio = ratio
        self._across, self._down = to_scene.m11() * ratio, to_scene.m22() * ratio
        self._left = (to_scene.dx() - area.left()) * ratio
        self._top = (to_scene.dy() - area.top()) * ratio

    def columns(self, x: Floats) -> Floats:
        """Columns of x, with parts of a pixel."""
        return x * self._across + self._left

    def rows(self, y: Floats) -> Floats:
        """Rows of y, with parts of a pixel."""
        return y * self._down + self._top


class Boxes(PixelItem):
    """Rectangles, and level lines over them."""

    def __init__(self) -> None:
        super().__init__()
        none = np.zeros(0, np.uint32)
        self._boxes, self._lines = np.zeros((0, 4)), np.zeros((0, 3))
        self._insides: Pixels = none
        self._edges: Pixels = none
        self._strokes: Pixels = none

    def set_boxes(self, boxes: Floats, insides: Pixels, edges: Pixels | None = None) -> None:
        """Show rectangles: left, right, bottom and top of shape (n, 4), colours of shape (n,)."""
        self._boxes, self._insides, self._edges = boxes, insides, insides if edges is None else edges
        bounds = QRectF()
        if len(boxes):
            (left, _, bottom, _), (_, right, _, top) = boxes.min(axis=0), boxes.max(axis=0)
            bounds = QRectF(left, bottom, right - left, top - bottom)
        self.changed(bounds)

    def set_lines(self, lines: Floats, colours: Pixels) -> None:
        """Show level lines: left, right and height of shape (m, 3), two pixels thick."""
        self._lines, self._strokes = lines, colours
        self.update()

    def write(self, pixels: Pixels, place: Place) -> None:
        """Write the rectangles, then the lines."""
        height, width = pixels.shape
        columns = np.clip(np.rint(place.columns(self._boxes[:, :2])), 0, width).astype(int).tolist()
        rows = np.clip(np.rint(place.rows(self._boxes[:, 2:])), 0, height).astype(int).tolist()
        for (left, right), (bottom, top), inside, edge in zip(
            columns, rows, self._insides, self._edges, strict=True
        ):
            right = max(right, left + 1)
            pixels[top:bottom, left:right] = inside
            if edge != inside:
                pixels[top:bottom, left] = pixels[top : top + 1, left:right] = edge
        self._write_lines(pixels, place)

    def _write_lines(self, pixels: Pixels, place: Place) -> None:
        height, width = pixels.shape
        columns = np.clip(np.rint(place.columns(self._lines[:, :2])), 0, width).astype(int).tolist()
        rows = np.clip(np.rint(place.rows(self._lines[:, 2])) - 1, 0, height).astype(int).tolist()
        thick = max(1, round(2 * place.ratio))
        for (left, right), row, colour in zip(columns, rows, self._strokes, strict=True):
            pixels[row : row + thick, left : max(right, left + 1)] = colour


def packed(colours: NDArray[np.uint8], opacity: int = 255) -> Pixels:
    """Pack colours of shape (n, 3) into pixels of an opacity, 0 to 255, shape (n,)."""
    red, green, blue = (colours.astype(np.uint32) * opacity // 255).T
    pixels: Pixels = np.uint32(opacity << 24) | red << np.uint32(16) | green << np.uint32(8) | blue
    return pixels
