"""Where the panels stand around the 3-D views, at first and after the operator has moved them."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QSize, Qt, QTimer
from PySide6.QtWidgets import QDockWidget, QMainWindow, QMenu, QTabWidget, QWidget

from stepfield_app.settings import ARRANGEMENT, Settings
from stepfield_app.views.strip import Strip, tool_button

LEFT, RIGHT, BOTTOM = (
    Qt.DockWidgetArea.LeftDockWidgetArea,
    Qt.DockWidgetArea.RightDockWidgetArea,
    Qt.DockWidgetArea.BottomDockWidgetArea,
)
#: Widths of the side panels and share of the height that map and profile get.
LEFT_WIDTH, RIGHT_WIDTH, BOTTOM_SHARE = 296, 272, 0.36
#: Windows narrower than this leave more of their width to the views.
WIDE = 1400
#: Map and profile share a place where there are fewer pixels for both.
SIDE_BY_SIDE = 600
#: Height of the figures of fidelity with their strip, all of them to be seen, and of those of filled holes.
FIDELITY_HEIGHT, FILLED_HEIGHT = 204, 36
#: Windows lower than this keep that room for rows of layers while nothing is filled: figures can be scrolled.
HIGH = 800
#: Height of menu, tools, tabs, status and what parts the panels: of docks that are promised more than there
#: is, each gets less.
BARS_HEIGHT = 128
#: Height of the panels below it at least.
LEAST_HISTORY = 104
#: Side of the icon of the button that hides a panel.
HIDE_SIZE = 14
#: A side panel is never narrower: numbers would be cut.
LEAST_WIDTH = 256
#: Those on the left scroll in low windows, and their bar takes so much.
BAR_WIDTH = 12


@dataclass(frozen=True)
class Docks:
    """The panels of the window, each in a dock of its own."""

    parameters: QDockWidget
    cleaning: QDockWidget
    elevations: QDockWidget
    layers: QDockWidget
    fidelity: QDockWidget
    history: QDockWidget
    edits: QDockWidget
    suspects: QDockWidget
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
            self.fidelity,
            self.history,
            self.edits,
            self.suspects,
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


def make(window: QMainWindow) -> Docks:
    """Put all docks into a window, where they stand when the program is new; their panels are still blank."""
    made = Docks(
        parameters=_made(window, "Parameters", LEFT, (0, 72)),
        cleaning=_made(window, "Cleaning", LEFT, (0, 72)),
        elevations=_made(window, "Elevations", LEFT, (0, 120), is_plot=True),
        layers=_made(window, "Layers", RIGHT, (0, 142)),
        fidelity=_made(window, "Fidelity", RIGHT, (0, 72), keeps_title=True),
        history=_made(window, "History", RIGHT, (0, 72), begins_as_tab=True),
        edits=_made(window, "Edits", RIGHT, (0, 105), begins_as_tab=True),
        suspects=_made(window, "Suspicious places", RIGHT, (0, 61), begins_as_tab=True),
        map=_made(window, "Map", BOTTOM, (380, 100), keeps_title=True, is_plot=True),
        profile=_made(window, "Profile", BOTTOM, (334, 100), keeps_title=True, is_plot=True),
    )
    arrange(window, made)
    return made


def _made(
    window: QMainWindow,
    title: str,
    area: Qt.DockWidgetArea,
    least: tuple[int, int],
    *,
    keeps_title: bool = False,
    begins_as_tab: bool = False,
    is_plot: bool = False,
) -> QDockWidget:
    """Put a dock into a window; where a tab says the same its title is left out, unless it has controls."""
    dock = QDockWidget(title, window)
    dock.setObjectName(f"dock {title}")
    blank = _Blank(area, least)
    put(dock, blank)
    if is_plot:  # these have the ground of the window
        blank.setAttribute(Qt.WidgetAttribute.WA_StyledBackground, False)
        blank.setAutoFillBackground(True)
    strip = _titled(dock, Strip(title))
    dock.setTitleBarWidget(strip)
    if not keeps_title:
        _save_title(window, dock, strip, none := QWidget())
        if begins_as_tab:  # at once, or the room of its title would be taken from the panels above
            dock.setTitleBarWidget(none)
    window.addDockWidget(area, dock)
    return dock


def put(dock: QDockWidget, panel: QWidget) -> None:
    """Put a panel into a dock, in place of the one before; a panel's own strip becomes the dock's title."""
    before, title, strip = dock.widget(), dock.titleBarWidget(), getattr(panel, "strip", None)
    if isinstance(before, _Blank):
        panel.setMinimumWidth(before.narrowest)
        before.deleteLater()
    panel.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
    if strip is not None:  # first, or for a moment the panel would need the room of both
        dock.setTitleBarWidget(_titled(dock, strip))
        title.deleteLater()
    dock.setWidget(panel)


class _Blank(QWidget):
    """Keeps the place of a panel, and takes the room that it will need: nothing moves when it comes.

    Parameters
    ----------
    area : Qt.DockWidgetArea
    least : tuple of int
        Width and height that the panel and its title will ask for at least.
    """

    def __init__(self, area: Qt.DockWidgetArea, least: tuple[int, int]) -> None:
        super().__init__()
        self.narrowest = {LEFT: LEAST_WIDTH + BAR_WIDTH, RIGHT: LEAST_WIDTH}.get(area, LEAST_WIDTH // 2)
        self._least = QSize(max(least[0], self.narrowest), least[1])

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """Return what the panel will ask for."""
        return self._least


def _titled(dock: QDockWidget, strip: Strip) -> Strip:
    """Give a strip the button that hides its dock; the dock is dragged by the rest of it."""
    hide = tool_button("close", f"Hide {dock.windowTitle()}", "Hide; View > Panels shows it again")
    hide.setIconSize(QSize(HIDE_SIZE, HIDE_SIZE))
    hide.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    hide.clicked.connect(dock.close)
    strip.title.setToolTip("Drag to move this panel, double-click to float it")
    strip.add(hide)
    strip.setMinimumWidth(LEAST_WIDTH // 2)
    return strip


def _save_title(window: QMainWindow, dock: QDockWidget, strip: Strip, blank: QWidget) -> None:
    """Leave the title out where a tab says the same."""

    def choose() -> None:
        beside = [other for other in window.tabifiedDockWidgets(dock) if not other.isHidden()]
        wanted = blank if beside and not dock.isFloating() else strip
        if dock.titleBarWidget() is not wanted:
            dock.setTitleBarWidget(wanted)

    watch = QTimer(dock, interval=0, singleShot=True)
    watch.timeout.connect(choose)
    window.tabifiedDockWidgetActivated.connect(watch.start)
    for other in (dock, *window.findChildren(QDockWidget)):
        for signal in (other.visibilityChanged, other.topLevelChanged, other.dockLocationChanged):
            signal.connect(lambda _: watch.start())


def arrange(window: QMainWindow, docks: Docks) -> None:
    """Put the docks where they are when the program is new."""
    window.setTabPosition(Qt.DockWidgetArea.AllDockWidgetAreas, QTabWidget.TabPosition.North)
    window.setCorner(Qt.Corner.BottomLeftCorner, LEFT)
    window.setCorner(Qt.Corner.BottomRightCorner, RIGHT)
    for dock, area in zip(docks.all, (LEFT, LEFT, LEFT, *5 * [RIGHT], BOTTOM, BOTTOM), strict=True):
        dock.setFloating(False)
        window.addDockWidget(area, dock)
        dock.show()
    window.splitDockWidget(docks.parameters, docks.elevations, Qt.Orientation.Vertical)
    window.tabifyDockWidget(
        docks.parameters, docks.cleaning
    )  # after the split, or it would take in all three
    docks.parameters.raise_()
    window.splitDockWidget(docks.layers, docks.fidelity, Qt.Orientation.Vertical)
    window.splitDockWidget(docks.fidelity, docks.history, Qt.Orientation.Vertical)
    for other in (docks.edits, docks.suspects):
        window.tabifyDockWidget(docks.history, other)
    docks.history.raise_()
    window.splitDockWidget(docks.map, docks.profile, Qt.Orientation.Horizontal)
    height, width = window.height(), window.width()
    left, right = (LEFT_WIDTH, RIGHT_WIDTH) if width >= WIDE else (LEAST_WIDTH + BAR_WIDTH, LEAST_WIDTH)
    middle = max(width - left - right, 2)
    window.resizeDocks([docks.parameters, docks.layers], [left, right], Qt.Orientation.Horizontal)
    window.resizeDocks(
        [docks.map, docks.profile], [middle * 9 // 20, middle * 11 // 20], Qt.Orientation.Horizontal
    )
    if middle < SIDE_BY_SIDE:
        window.tabifyDockWidget(docks.map, docks.profile)
        docks.map.raise_()
    window.resizeDocks([docks.map], [int(height * BOTTOM_SHARE)], Qt.Orientation.Vertical)
    window.resizeDocks(
        [docks.parameters, docks.elevations], [int(height * 0.6), int(height * 0.4)], Qt.Orientation.Vertical
    )
    figures = FIDELITY_HEIGHT + (FILLED_HEIGHT if height >= HIGH else 0)
    below = max(int(height * 0.3) - figures // 2, LEAST_HISTORY)
    shares = [height - BARS_HEIGHT - figures - below, figures, below]
    window.resizeDocks([docks.layers, docks.fidelity, docks.history], shares, Qt.Orientation.Vertical)


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
