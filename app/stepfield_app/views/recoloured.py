"""The picture of a 3-D view in other colours than it was drawn in, until it is drawn in them."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject, Signal

from stepfield_app.render.scene import Bytes, Frame


class Recoloured(QObject):
    """What to show in place of a picture that was drawn."""

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._pair: tuple[Frame, Frame] | None = None

    def set(self, drawn: Frame, pixels: Bytes) -> None:
        """Show a picture in other colours: it, and while these are found any other one like it."""
        self._pair = drawn, replace(drawn, pixels=pixels)
        self.changed.emit()

    def clear(self) -> None:
        """Show every picture as it was drawn."""
        if self._pair is not None:
            self._pair = None
            self.changed.emit()

    def of(self, newest: Frame | None) -> Frame | None:
        """Return what to show of the newest picture."""
        if newest is None or self._pair is None:
            return newest
        drawn, shown = self._pair
        return shown if newest is drawn or _is_like(newest, shown) else newest


def _is_like(one: Frame, other: Frame) -> bool:
    """Whether pictures have the same detail and are seen from the same place."""
    return (
        (one.depth is None) == (other.depth is None)
        and one.camera == other.camera
        and one.pixels.shape == other.pixels.shape
    )
