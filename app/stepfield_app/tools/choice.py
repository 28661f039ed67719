"""Which selecting tool is in the hand, how wide its brush is, and whether it is put aside for a moment."""

from __future__ import annotations

from typing import Literal, get_args

from PySide6.QtCore import QObject, Signal

from stepfield_app.scenes.shapes import Kind

ToolName = Literal["navigate", "click", "rectangle", "lasso", "brush", "surface"]
TOOLS: tuple[ToolName, ...] = get_args(ToolName)

#: Radius of the brush, logical pixels: at first, at least, at most; how much a notch of the wheel changes it.
RADIUS, LEAST, MOST, NOTCH = 16.0, 2.0, 256.0, 1.2


class Choice(QObject):
    """What the operator holds; every view asks it."""

    tool_changed = Signal(str)
    radius_changed = Signal(float)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._tool: ToolName = "navigate"
        self._radius = RADIUS
        self.is_aside = False

    @property
    def tool(self) -> ToolName:
        """One of :data:`TOOLS`."""
        return self._tool

    @property
    def kind(self) -> Kind | None:
        """The shape that the tool draws; None while one navigates, be it only as long as Space is held."""
        return None if self._tool == "navigate" or self.is_aside else self._tool

    @property
    def radius(self) -> float:
        """Of the brush, logical pixels."""
        return self._radius

    def take(self, tool: ToolName) -> None:
        """Take another tool."""
        if tool != self._tool:
            self._tool, self.is_aside = tool, False
            self.tool_changed.emit(tool)

    def widen(self, notches: float) -> None:
        """Make the brush wider, or narrower by negative notches."""
        self.set_radius(self._radius * NOTCH**notches)

    def set_radius(self, radius: float) -> None:
        """Make the brush so wide, as far as that makes sense."""
        radius = min(MOST, max(LEAST, radius))
        if radius != self._radius:
            self._radius = radius
            self.radius_changed.emit(radius)
