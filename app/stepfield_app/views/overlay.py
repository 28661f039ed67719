"""What is painted over a 3-D picture: legend, scale bar, axes, and a sentence where there is no picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QImage, QPainter, QPen

from stepfield_app.render.camera import Camera
from stepfield_app.scenes.legend import Legend
from stepfield_app.scenes.units import scale_bar
from stepfield_app.theme import Theme, rgb
from stepfield_app.wording import digits_for, number, round_step

#: Distance of everything from the edges, pixels.
MARGIN = 12
#: Size of a ramp, the most of a view's height that it takes, and its ticks.
RAMP_WIDTH, RAMP_HEIGHT, RAMP_SHARE, TICKS = 10, 120, 0.3, 5
SWATCH, LINE_HEIGHT = 10, 16
AXIS_LENGTH = 26
#: Room above the scale bar for its label.
LABEL_ROOM = 18
#: Views lower or narrower than this show no legend: it would cover the data.
LEAST_WIDTH, LEAST_HEIGHT = 220, 190
AXES = (
    ("x", (1.0, 0.0, 0.0), "#e5534b"),
    ("y", (0.0, 1.0, 0.0), "#57ab5a"),
    ("z", (0.0, 0.0, 1.0), "#4c9aff"),
)


@dataclass(frozen=True)
class Overlay:
    """Paints over one view; ``area`` is the view's rectangle in logical pixels."""

    painter: QPainter
    area: QRectF
    theme: Theme

    def legend(self, legend: Legend, least_height: int = LEAST_HEIGHT) -> None:
        """Say what the colours mean, at the right edge; where it covers nothing a lower view will do."""
        if self.area.width() < LEAST_WIDTH or self.area.height() < least_height:
            return
        if legend.ramp is not None:
            self._ramp(legend)
        else:
            self._entries(legend)

    def _ramp(self, legend: Legend) -> None:
        ticks, digits = _ticks(legend.low, legend.high)
        labels = [number(tick, digits) for tick in ticks]
        title = f"{legend.title} ({legend.unit})" if legend.unit else legend.title
        below = max(self._metrics.horizontalAdvance(label) for label in labels)
        wide = max(below + 6, self._metrics.horizontalAdvance(title) - RAMP_WIDTH)
        left = self.area.right() - MARGIN - RAMP_WIDTH
        top = self.area.top() + MARGIN + LINE_HEIGHT
        high = min(RAMP_HEIGHT, RAMP_SHARE * self.area.height())
        notes = legend.note.split(", ") if legend.note else []
        noted = LINE_HEIGHT * len(notes)
        wide = max([wide, *(self._metrics.horizontalAdvance(note) - RAMP_WIDTH for note in notes)])
        self._plate(QRectF(left - wide - 8, top - LINE_HEIGHT - 6, wide + RAMP_WIDTH + 16, high + 32 + noted))
        for row, note in enumerate(notes):
            line = QRectF(0, top + high + 12 + LINE_HEIGHT * row, left + RAMP_WIDTH, LINE_HEIGHT)
            self._text(line, note, self.theme.muted)
        self._text(QRectF(0, top - LINE_HEIGHT - 4, left + RAMP_WIDTH, LINE_HEIGHT), title, self.theme.muted)
        assert legend.ramp is not None
        colours = np.ascontiguousarray(legend.ramp[::-1, np.newaxis])
        image = QImage(colours.data, 1, len(colours), 3, QImage.Format.Format_RGB888)
        self.painter.drawImage(QRectF(left, top + 4, RAMP_WIDTH, high), image)
        span = legend.high - legend.low
        for tick, label in zip(ticks, labels, strict=True):
            place = ((legend.high - tick) / span if span > 0 else 0.5) * high
            self._text(QRectF(0, top + 4 + place - LINE_HEIGHT / 2, left - 6, LINE_HEIGHT), label)

    def _entries(self, legend: Legend) -> None:
        most = int((self.area.height() - 4 * MARGIN) / LINE_HEIGHT) - 2
        shown = list(legend.entries)[:most]
        names = [name for _, name in shown]
        if len(legend.entries) > most:
            names[-1] = f"{len(legend.entries) - most + 1} more"
        wide = max((self._metrics.horizontalAdvance(name) for name in [*names, legend.title]), default=0)
        left = self.area.right() - MARGIN - SWATCH
        top = self.area.top() + MARGIN
        self._plate(
            QRectF(left - wide - 14, top - 6, wide + SWATCH + 22, LINE_HEIGHT * (len(names) + 1) + 12)
        )
        self._text(QRectF(0, top, left + SWATCH, LINE_HEIGHT), legend.title, self.theme.muted)
        for line, ((colour, _), name) in enumerate(zip(shown, names, strict=True), 1):
            at = top + line * LINE_HEIGHT
            self._text(QRectF(0, at, left - 6, LINE_HEIGHT), name)
            self.painter.fillRect(QRectF(left, at + 3, SWATCH, SWATCH), QColor(*colour))

    def scale(self, camera: Camera, size: tuple[int, int], ratio: float) -> None:
        """Draw a bar of a round length, true at the rotation centre."""
        _, pixels, label = scale_bar(camera.metres_per_pixel(size) * ratio)
        left, bottom = self.area.left() + MARGIN, self.area.bottom() - MARGIN
        self.painter.setPen(QPen(QColor(self.theme.text), 1.5))
        ends = [QPointF(left, bottom), QPointF(left + pixels, bottom)]
        self.painter.drawLine(*ends)
        for end in ends:
            self.painter.drawLine(end - QPointF(0, 4), end)
        room = QRectF(left, bottom - LABEL_ROOM - 2, max(pixels, 60), LABEL_ROOM)
        self._text(room, label, flags=Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)

    def axes(self, camera: Camera) -> None:
        """Draw the directions of x, y and z, the farthest first."""
        centre = QPointF(self.area.right() - MARGIN - AXIS_LENGTH, self.area.bottom() - MARGIN - AXIS_LENGTH)
        towards = sorted(AXES, key=lambda axis: -float(np.dot(axis[1], camera.forward)))
        for name, direction, colour in towards:
            right = float(np.dot(direction, camera.right)) * AXIS_LENGTH
            up = float(np.dot(direction, camera.up)) * AXIS_LENGTH
            tip = centre + QPointF(right, -up)
            self.painter.setPen(QPen(QColor(colour), 2))
            self.painter.drawLine(centre, tip)
            beyond = centre + QPointF(right, -up) * 1.3
            if (right * right + up * up) > 36:  # an axis seen end on has no room for its name
                room = QRectF(beyond.x() - 8, beyond.y() - 8, 16, 16)
                self._text(room, name, colour, Qt.AlignmentFlag.AlignCenter)

    def sentence(self, text: str) -> None:
        """Say in the middle why there is no picture."""
        self.painter.setPen(QColor(self.theme.muted))
        room = self.area.adjusted(24, 24, -24, -24)
        self.painter.drawText(room, Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, text)

    def note(self, text: str, colour: str) -> None:
        """Put a short note at the top left, on a plate of its own."""
        room = QRectF(
            self.area.left() + MARGIN,
            self.area.top() + MARGIN,
            self._metrics.horizontalAdvance(text) + 16,
            22,
        )
        self._plate(room)
        self._text(room, text, colour, Qt.AlignmentFlag.AlignCenter)

    @property
    def _metrics(self) -> QFontMetricsF:
        return QFontMetricsF(self.painter.font())

    def _plate(self, room: QRectF) -> None:
        """Lay a plate of the window's colour under text, so that it can be read on any data."""
        ratio = self.painter.device().devicePixelRatio()
        size = math.ceil(room.width() * ratio), math.ceil(room.height() * ratio)
        self.painter.drawImage(room, _plate(*size, ratio, self.theme.window))

    def _text(
        self,
        room: QRectF,
        text: str,
        colour: str | None = None,
        flags: Qt.AlignmentFlag = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter,
    ) -> None:
        self.painter.setPen(QColor(colour or self.theme.text))
        self.painter.drawText(room, flags, text)


@lru_cache(maxsize=64)
def _plate(width: int, height: int, ratio: float, colour: str) -> QImage:
    """Draw a plate once: rounded corners cost as much as all the rest of an overlay."""
    plate = QImage(width, height, QImage.Format.Format_ARGB32_Premultiplied)
    plate.fill(Qt.GlobalColor.transparent)
    painter = QPainter(plate)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(*rgb(colour), 190))
    painter.drawRoundedRect(0, 0, width, height, 4 * ratio, 4 * ratio)
    painter.end()
    return plate


def small_font(font: QFont) -> QFont:
    """Return the font of everything painted over a picture."""
    small = QFont(font)
    small.setPixelSize(11)
    return small


def _ticks(low: float, high: float) -> tuple[NDArray[np.float64], int]:
    """Round numbers from low to high, and the digits after the point that tell them apart.

    A range of one number only has that for its tick, in centimetres.
    """
    if not high > low:
        return np.array([low]), 2
    step = round_step((high - low) / TICKS)
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return np.arange(first, last + 1) * step, digits_for(step)
