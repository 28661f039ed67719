"""A place where something can be dropped, that says before what would come of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from PySide6.QtCore import QMimeData, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from stepfield_app.theme import Theme
from stepfield_app.views.overlay import Overlay


@dataclass(frozen=True)
class Offer:
    """What a drop would do, or why it can do nothing."""

    sentence: str
    is_possible: bool


class DropSite(Protocol):
    """Takes drops on behalf of a view."""

    #: A signal: the offer is another one.
    offer_changed: Any

    def knows(self, data: QMimeData) -> bool:
        """Whether what is dragged concerns it at all."""

    def offer(self) -> Offer:
        """Say what a drop would do now."""

    def drop(self) -> None:
        """Do it."""


def paint_offer(painter: QPainter, area: QRectF, offer: Offer, theme: Theme) -> None:
    """Frame a view and say what a drop on it would do."""
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(QColor(theme.accent if offer.is_possible else theme.error), 3))
    painter.drawRect(area.adjusted(1.5, 1.5, -1.5, -1.5))
    Overlay(painter, area, theme).note(offer.sentence, theme.text if offer.is_possible else theme.error)
