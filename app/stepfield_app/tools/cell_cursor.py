"""Selecting in the map by keys: a cursor that goes from compartment to compartment."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QKeyEvent, QPainter, QPainterPath

from stepfield.grid import Grid
from stepfield_app.document import Document
from stepfield_app.selection import Selection
from stepfield_app.tools.choice import Choice
from stepfield_app.tools.grounds import MapGround
from stepfield_app.tools.selecting import Carry, SelectingTool
from stepfield_app.tools.strokes import how_of, paint_line
from stepfield_app.views.tool import Hand

#: Compartments of one step with Ctrl.
FAR = 10

_STEPS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}
_PICKS = (Qt.Key.Key_Return, Qt.Key.Key_Enter)


@dataclass(frozen=True)
class CellCursor:
    """A compartment, and the one from which a rectangle is drawn to it: columns and rows."""

    column: int
    row: int
    from_column: int
    from_row: int

    def moved(self, right: int, down: int, grid: Grid, *, extends: bool) -> CellCursor:
        """Return it further on, within the grid; without ``extends`` the rectangle begins anew."""
        column = min(grid.columns - 1, max(0, self.column + right))
        row = min(grid.rows - 1, max(0, self.row + down))
        return replace(self, column=column, row=row) if extends else CellCursor(column, row, column, row)

    @property
    def is_single(self) -> bool:
        """Whether the rectangle is of one compartment."""
        return (self.column, self.row) == (self.from_column, self.from_row)

    def middles(self, grid: Grid) -> list[tuple[float, float]]:
        """Return the middles of the compartments at both ends, x and y in metres."""
        return [_middle(grid, self.from_column, self.from_row), _middle(grid, self.column, self.row)]

    def edges(self, grid: Grid) -> list[tuple[float, float]]:
        """Return two opposite corners of the rectangle, x and y in metres."""
        (x0, y0), (x1, y1) = self.middles(grid)
        half = grid.cell_size / 2
        return [(min(x0, x1) - half, min(y0, y1) - half), (max(x0, x1) + half, max(y0, y1) + half)]


class MapSelectingTool(SelectingTool):
    """Selects in the map, by mouse and by keys: arrows, Shift+arrows for a rectangle, Enter or Space."""

    def __init__(
        self, ground: MapGround, choice: Choice, selection: Selection, carry: Carry, document: Document
    ) -> None:
        super().__init__(ground, choice, selection, carry)
        self._view, self._document = ground.view, document
        self._cursor: CellCursor | None = None
        self._space_is_used = False

    @property
    def cursor(self) -> CellCursor | None:
        """Where the keys are."""
        return self._cursor

    def forget(self) -> None:
        """Take the cursor away: another tool, another scan."""
        self._cursor = None
        self._repaint()

    def press(self, view: Any, hand: Hand) -> bool:
        """Begin a stroke: the mouse has the word now."""
        self._space_is_used = True
        if super().press(view, hand):
            self._cursor = None
            return True
        return False

    def key(self, view: Any, event: QKeyEvent, is_down: bool) -> bool:
        """Move the cursor, or take what it is on."""
        if self._choice.tool == "navigate" or self._grid is None:
            return False
        if event.key() == Qt.Key.Key_Space and not event.isAutoRepeat():
            self._tap(event, is_down)
        elif is_down and event.key() in _STEPS and self.stroke is None:
            self._step(event)
            return True
        elif is_down and event.key() in _PICKS and self._cursor is not None:
            self._pick(event.modifiers())
            return True
        return super().key(view, event, is_down)

    def keeps(self, view: Any, event: QKeyEvent) -> bool:
        """Keep the arrows: with Ctrl the window would move a layer."""
        return event.key() in _STEPS and self._choice.tool != "navigate" and self._grid is not None

    @property
    def _grid(self) -> Grid | None:
        answer = self._document.answer
        return None if answer is None else answer.result.field.compartments.grid

    def _tap(self, event: QKeyEvent, is_down: bool) -> None:
        """Take by Space what Enter takes, unless the mouse has navigated in between."""
        if is_down:
            self._space_is_used = False
        elif not self._space_is_used and self._cursor is not None:
            self._pick(event.modifiers())

    def _step(self, event: QKeyEvent) -> None:
        grid = self._grid
        assert grid is not None
        keys = event.modifiers()
        far = FAR if keys & Qt.KeyboardModifier.ControlModifier else 1
        right, down = _STEPS[Qt.Key(event.key())]
        extends = bool(keys & Qt.KeyboardModifier.ShiftModifier)
        if self._cursor is None:
            self._cursor = self._first(grid)
        else:
            self._cursor = self._cursor.moved(right * far, down * far, grid, extends=extends)
        self._keep_in_sight(grid)
        self._repaint()

    def _first(self, grid: Grid) -> CellCursor:
        """Begin in the middle of what is visible."""
        seen = self._view.plot.visible
        across = ((seen.left + seen.right) / 2 - grid.west) / grid.cell_size
        up = ((seen.bottom + seen.top) / 2 - grid.south) / grid.cell_size
        return CellCursor(0, 0, 0, 0).moved(int(across), grid.rows - 1 - int(up), grid, extends=False)

    def _keep_in_sight(self, grid: Grid) -> None:
        assert self._cursor is not None
        x, y = _middle(grid, self._cursor.column, self._cursor.row)
        seen, side = self._view.plot.visible, 2 * grid.cell_size
        right = max(0.0, x + side - seen.right) - max(0.0, seen.left - x + side)
        up = max(0.0, y + side - seen.top) - max(0.0, seen.bottom - y + side)
        if right or up:
            self._view.plot.pane.shift(right, up)

    def _pick(self, keys: Qt.KeyboardModifier) -> None:
        """Take the compartment, what is connected to it, what the brush covers, or the rectangle."""
        grid, cursor = self._grid, self._cursor
        assert grid is not None
        assert cursor is not None
        how = how_of(keys)
        if not cursor.is_single:
            self._take("rectangle", [self._pixel(*corner) for corner in cursor.edges(grid)], how)
            return
        at = self._pixel(*cursor.middles(grid)[0])
        if self._choice.tool == "brush":
            self._take("brush", [at], how)
        else:
            self.point(at, how)

    def _pixel(self, x: float, y: float) -> QPointF:
        return self._view.plot.pixel_of(x, y)

    def paint(self, view: Any, painter: QPainter) -> None:
        """Paint the cursor, or the rectangle it has drawn."""
        super().paint(view, painter)
        grid = self._grid
        if self._cursor is None or grid is None:
            return
        outline = QPainterPath()
        outline.addRect(QRectF(*(self._pixel(*corner) for corner in self._cursor.edges(grid))).normalized())
        paint_line(painter, outline, self.theme)
        at = self._pixel(*_middle(grid, self._cursor.column, self._cursor.row))
        cross = QPainterPath()
        for way in (QPointF(7, 0), QPointF(0, 7)):
            cross.moveTo(at - way)
            cross.lineTo(at + way)
        paint_line(painter, cross, self.theme)


def _middle(grid: Grid, column: int, row: int) -> tuple[float, float]:
    x = grid.west + (column + 0.5) * grid.cell_size
    return x, grid.south + (grid.rows - row - 0.5) * grid.cell_size
