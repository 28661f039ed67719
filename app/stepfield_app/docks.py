"""Where the panels stand around the 3-D views, at first and after the operator has moved them."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow, QMenu, QWidget

from stepfield_app.settings import ARRANGEMENT, Settings

LEFT, RIGHT, BOTTOM = (
    Qt.DockWidgetArea.LeftDockWidgetArea,
    Qt.DockWidgetArea.RightDockWidgetArea,
    Qt.DockWidgetArea.BottomDockWidgetArea,
)
#: Widths of the side panels and share of the height that map and profile get.
LEFT_WIDTH, RIGHT_WIDTH, BOTTOM_SHARE = 296, 272, 0.36
#: A side panel is never narrower: numbers would be cut.
LEAST_WIDTH = 256


@dataclass(frozen=True)
class Docks:
    """The panels of the window, each in a dock of its own."""

    parameters: QDockWidget
    cleaning: QDockWidget
    elevations: QDockWidget
    layers: QDockWidget
    history: QDockWidget
    map: QDockWidget
    profile: QDockWidget

    @property
    def all(self) -> tuple[QDockWidget, ...]:
        """Every dock, in the order of the menu."""
        return (
            self.parameters,
            self.cleaning,
            self.elevations,
            self.layers,
            self.history,
            self.map,
            self.profile,
        )

    def fill(self, menu: QMenu) -> None:
        """Let a menu show and hide them."""
        for dock in self.all:
            menu.addAction(dock.toggleViewAction())

    def set_visible(self, are_visible: bool) -> None:
        """Show or hide all: an empty window has no use for them."""
        for dock in self.all:
            dock.setVisible(are_visible)


def docked(window: QMainWindow, title: str, panel: QWidget, area: Qt.DockWidgetArea) -> QDockWidget:
    """Put a panel into a dock and the dock into a window."""
    dock = QDockWidget(title, window)
    dock.setObjectName(f"dock {title}")
    panel.setMinimumWidth(LEAST_WIDTH if area != BOTTOM else LEAST_WIDTH // 2)
    dock.setWidget(panel)
    window.addDockWidget(area, dock)
    return dock


def arrange(window: QMainWindow, docks: Docks) -> None:
    """Put the docks where they are when the program is new."""
    window.setCorner(Qt.Corner.BottomLeftCorner, LEFT)
    window.setCorner(Qt.Corner.BottomRightCorner, RIGHT)
    for dock, area in zip(docks.all, (LEFT, LEFT, LEFT, RIGHT, RIGHT, BOTTOM, BOTTOM), strict=True):
        dock.setFloating(False)
        window.addDockWidget(area, dock)
        dock.show()
    window.splitDockWidget(docks.parameters, docks.elevations, Qt.Orientation.Vertical)
    window.tabifyDockWidget(
        docks.parameters, docks.cleaning
    )  # after the split, or it would take in all three
    docks.parameters.raise_()
    window.splitDockWidget(docks.layers, docks.history, Qt.Orientation.Vertical)
    window.splitDockWidget(docks.map, docks.profile, Qt.Orientation.Horizontal)
    height, width = window.height(), window.width()
    middle = max(width - LEFT_WIDTH - RIGHT_WIDTH, 2)
    window.resizeDocks([docks.parameters, docks.layers], [LEFT_WIDTH, RIGHT_WIDTH], Qt.Orientation.Horizontal)
    window.resizeDocks(
        [docks.map, docks.profile], [middle * 2 // 5, middle * 3 // 5], Qt.Orientation.Horizontal
    )
    window.resizeDocks([docks.map], [int(height * BOTTOM_SHARE)], Qt.Orientation.Vertical)
    window.resizeDocks(
        [docks.parameters, docks.elevations], [int(height * 0.6), int(height * 0.4)], Qt.Orientation.Vertical
    )
    window.resizeDocks(
        [docks.layers, docks.history], [int(height * 0.7), int(height * 0.3)], Qt.Orientation.Vertical
    )


def restore(window: QMainWindow, settings: Settings, *, with_size: bool) -> None:
    """Put everything where the operator left it."""
    if with_size and not settings.geometry.isEmpty():
        window.restoreGeometry(settings.geometry)
    if not settings.arrangement.isEmpty():
        window.restoreState(settings.arrangement, ARRANGEMENT)


def remember(window: QMainWindow, settings: Settings) -> None:
    """Keep where everything is for the next time."""
    settings.geometry = window.saveGeometry()
    settings.arrangement = window.saveState(ARRANGEMENT)
