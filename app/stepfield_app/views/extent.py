"""A rectangle in the plane of a plot."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QRectF


@dataclass(frozen=True)
class Extent:
    """A rectangle in the plane of a plot, metres."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def width(self) -> float:
        """Width in metres."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Height in metres."""
        return self.top - self.bottom

    def rectangle(self) -> QRectF:
        """Return it as Qt has it."""
        return QRectF(self.left, self.bottom, self.width, self.height)

    def is_level_with(self, other: Extent | None) -> bool:
        """Whether both reach from the same bottom to the same top."""
        return other is not None and (self.bottom, self.top) == (other.bottom, other.top)
