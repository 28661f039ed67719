"""Where the parts of a row of the layers panel are, and what a click on them means."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from PySide6.QtCore import QPoint, QRect

ROW_HEIGHT, GAP, SWATCH, BAR, SMALL = 56, 8, 14, 3, 11
#: Rows are so high where fewer than this many of the others would be seen.
LOW_ROW_HEIGHT, FEW_ROWS = 44, 5
#: Side of what can be clicked, height of name and figures.
BUTTON, TEXT = 24, 40


def row_height(room: int) -> int:
    """Return the height of all rows of a list that shows so many pixels of them."""
    return ROW_HEIGHT if room >= FEW_ROWS * ROW_HEIGHT else LOW_ROW_HEIGHT


class Part(Enum):
    """A part of a row that can be clicked, and the tooltip that explains it."""

    EYE = "Show or hide (Space); with Alt show only this layer"
    SWATCH = "Choose the colour"
    SOLO = "Show only this layer, or all as before (S)"
    LOCK = "Lock: nothing goes into or out of a locked layer (Ctrl+L)"
    REST = "Click to make it active, double-click to rename, drag to reorder; drop selected pillars here"


@dataclass(frozen=True)
class RowLayout:
    """Where the parts of a row are."""

    room: QRect

    def eye(self) -> QRect:
        """Room of the eye."""
        return self._square(self.room.left() + BAR + 5, BUTTON)

    def swatch(self) -> QRect:
        """Room of the colour."""
        return self._square(self.eye().right() + 5, SWATCH)

    def thumbnail(self) -> QRect:
        """Room of the picture."""
        side = self.room.height() - 8
        return self._square(self.room.right() - side - 3, side)

    def solo(self) -> QRect:
        """Room of the button that shows one layer alone: the upper one."""
        side = min(BUTTON, (self.room.height() - 4) // 2)
        return QRect(self.thumbnail().left() - side - 4, self.room.center().y() - side, side, side)

    def lock(self) -> QRect:
        """Room of the lock: the lower button."""
        return self.solo().translated(0, self.solo().height())

    def text(self) -> QRect:
        """Room of name, count and elevation."""
        left, right = self.swatch().right() + 1 + GAP, self.solo().left() - 4
        return QRect(left, self.room.top() + (self.room.height() - TEXT) // 2, right - left, TEXT)

    def name(self) -> QRect:
        """Room of the name: the upper line."""
        text = self.text()
        return QRect(text.left(), text.top(), text.width(), text.height() // 2)

    def figures(self) -> QRect:
        """Room of count and elevation: the lower line."""
        text, name = self.text(), self.name()
        return QRect(text.left(), name.bottom() + 1, text.width(), text.height() - name.height())

    def notice(self) -> QRect:
        """Room of what a drop would do: the lower line, over the buttons too."""
        figures = self.figures()
        return QRect(
            figures.left(), figures.top(), self.thumbnail().left() - 4 - figures.left(), figures.height()
        )

    def part_at(self, place: QPoint) -> Part:
        """Return what a click at a place means."""
        rooms = {
            Part.EYE: self.eye(),
            Part.SWATCH: self.swatch(),
            Part.SOLO: self.solo(),
            Part.LOCK: self.lock(),
        }
        return next((part for part, room in rooms.items() if room.contains(place)), Part.REST)

    def _square(self, left: int, side: int) -> QRect:
        return QRect(left, self.room.center().y() - side // 2 + 1, side, side)
