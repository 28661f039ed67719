"""Axes in metres: full numbers however large, and never two labels over each other."""

from __future__ import annotations

import math
from typing import Any

import pyqtgraph as pg
from PySide6.QtGui import QColor, QFont, QFontMetricsF

from stepfield_app.appearance import numbers_font
from stepfield_app.theme import Theme
from stepfield_app.wording import digits_for, number, round_step

#: Height of the text of axes and overlays, logical pixels.
SMALL = 11
#: Height of the axis below a plot: labels and title.
HEIGHT = 36
#: Room between two labels, along the axis.
BETWEEN_ACROSS, BETWEEN_UP = 24, 28
#: Zooming in this far below the first ticks still fits the width of the axis.
SPARE_DIGITS = 1


class MetreAxis(pg.AxisItem):  # type: ignore[misc]
    """An axis whose labels say the whole coordinate.

    Parameters
    ----------
    orientation : str
        ``left`` or ``bottom``.
    title : str
        What is measured; the unit is added.
    """

    def __init__(self, orientation: str, title: str) -> None:
        super().__init__(orientation, maxTickLength=-4)
        self.enableAutoSIPrefix(False)
        self.setStyle(tickTextOffset=4, autoExpandTextSpace=False, tickTextHeight=14)
        self._font = numbers_font(_small(QFont()))
        self.setTickFont(self._font)
        self._title = title

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self.setPen(QColor(theme.line))
        self.setTextPen(QColor(theme.muted))
        self.setLabel(f"{self._title} (m)", **{"font-size": f"{SMALL}px", "color": theme.muted})

    def make_room(self, low: float, high: float) -> None:
        """Take the room that the labels of a range and some zoom need, so that nothing moves later."""
        if self.orientation == "bottom":
            if self.height() != HEIGHT:  # or the axis would be made anew for every picture
                self.setHeight(HEIGHT)
            return
        digits = digits_for(round_step(max(high - low, 1e-6) / 8)) + SPARE_DIGITS
        widest = max(self._width(number(value, digits)) for value in (low, high))
        wide = math.ceil(widest) + 26
        if self.width() != wide:
            self.setWidth(wide)

    def tickValues(self, low: float, high: float, size: float) -> list[tuple[float, list[float]]]:  # noqa: N802
        """Place ticks at round coordinates, as many as there is room for labels."""
        if not (high > low and size > 0):
            return []
        step = self._step(low, high, size)
        first, last = math.ceil(low / step), math.floor(high / step)
        return [(step, [count * step for count in range(first, last + 1)])]

    def tickStrings(self, values: list[float], scale: float, spacing: float) -> list[str]:  # noqa: N802
        """Write the whole coordinate at each tick."""
        return [number(value, digits_for(spacing)) for value in values]

    def _step(self, low: float, high: float, size: float) -> float:
        per_pixel = (high - low) / size
        step = round_step(per_pixel * 40)
        if self.orientation == "left":
            return round_step(per_pixel * BETWEEN_UP)
        while self._label_room(low, high, step) > step / per_pixel:
            step = round_step(step * 1.5)
        return step

    def _label_room(self, low: float, high: float, step: float) -> float:
        digits = digits_for(step)
        return max(self._width(number(value, digits)) for value in (low, high)) + BETWEEN_ACROSS

    def _width(self, text: str) -> float:
        return QFontMetricsF(self._font).horizontalAdvance(text)

    def wheelEvent(self, event: Any) -> None:  # noqa: N802
        """Leave the wheel to the plot: zooming one axis alone would break equal scales."""
        event.ignore()

    def mouseDragEvent(self, event: Any) -> None:  # noqa: N802
        """Leave dragging to the plot."""
        event.ignore()


def _small(font: QFont) -> QFont:
    font.setPixelSize(SMALL)
    return font
