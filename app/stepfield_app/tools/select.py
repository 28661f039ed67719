"""Selecting in every view: one hand, six tools, the strip that says what they reach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from PySide6.QtCore import QObject, QPointF, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QWidget

from stepfield_app.document import Document
from stepfield_app.editor import Editor
from stepfield_app.feeds.marked_feed import MarkedFeed
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.requests import Answer
from stepfield_app.selection import Selection
from stepfield_app.theme import DARK, Theme
from stepfield_app.tools.carrying import MapDrop, carry
from stepfield_app.tools.cell_cursor import MapSelectingTool
from stepfield_app.tools.choice import Choice, ToolName
from stepfield_app.tools.grounds import CanvasGround, MapGround, ProfileGround, Visible
from stepfield_app.tools.menu import open_menu
from stepfield_app.tools.selecting import SelectingTool
from stepfield_app.tools.strip import SelectStrip
from stepfield_app.tools.telling import selected
from stepfield_app.views.map import MapView
from stepfield_app.views.plane import Plane
from stepfield_app.views.profile import ProfileView
from stepfield_app.views.status import Status
from stepfield_app.views.trio import Trio
from stepfield_app.views.view3d import Canvas
from stepfield_app.wording import round_step

#: Steps of the elevations of the strip, as a share of what there is.
STEPS = 100


@dataclass(frozen=True)
class Views:
    """The views to select in, and the bar that says what is selected."""

    trio: Trio
    map: MapView
    profile: ProfileView
    status: Status


class SelectTools(QObject):
    """The selecting tools of a window.

    Parameters
    ----------
    document : Document
    selection : Selection
    editor : Editor
    views : Views
    scene_feed : SceneFeed
        Knows the local origin.
    visible : callable
        Returns the numbers of the layers that are shown, -1 for Unassigned.

    Attributes
    ----------
    strip : SelectStrip
        To be put above the views; shows itself while a tool is in use.
    """

    #: Name of the tool that is now in the hand.
    tool_changed = Signal(str)
    failed = Signal(object)  # exception

    def __init__(
        self,
        document: Document,
        selection: Selection,
        editor: Editor,
        views: Views,
        scene_feed: SceneFeed,
        visible: Visible,
    ) -> None:
        super().__init__(views.trio)
        self._document, self._selection, self._editor, self._views = document, selection, editor, views
        self._theme, self._commands = DARK, list[QAction]()
        self._choice = Choice(self)
        self.strip = SelectStrip(selection, self._choice, editor.name_of)
        self.strip.hide()
        self._marked = MarkedFeed(selection, views.map, views.profile)
        self._tools = self._make_tools(scene_feed, visible)
        views.map.plot.set_drop_site(MapDrop(editor, views.map))
        self._connect()
        self._take(document.answer)

    def _make_tools(self, scene_feed: SceneFeed, visible: Visible) -> dict[Canvas | Plane, SelectingTool]:
        views, selection = self._views, self._selection
        hand = self._choice, selection, self._carry
        of_map = MapSelectingTool(MapGround(views.map), *hand, self._document)
        of_profile = SelectingTool(ProfileGround(views.profile, selection, visible), *hand)
        tools: dict[Canvas | Plane, SelectingTool] = {views.map.plot: of_map, views.profile.plot: of_profile}
        for canvas in views.trio.canvases.values():
            tools[canvas] = SelectingTool(CanvasGround(canvas, selection, scene_feed, visible), *hand)
        return tools

    def _connect(self) -> None:
        document, selection = self._document, self._selection
        self._choice.tool_changed.connect(self._hand_out)
        self._marked.failed.connect(self.failed)
        selection.changed.connect(self._tell)
        document.answer_changed.connect(self._take)
        document.active_layer_changed.connect(self.strip.name_layer)
        document.project_changed.connect(lambda _: self.strip.name_layer(document.active_layer))
        for view, tool in self._tools.items():
            view.menu_wanted.connect(partial(self._open_menu, tool))

    # --- Which tool -----------------------------------------------------------------------------------------

    @property
    def tool(self) -> ToolName:
        """The tool in the hand; ``navigate`` is none."""
        return self._choice.tool

    @property
    def is_idle(self) -> bool:
        """Whether the outlines in map and profile are those of the selection."""
        return self._marked.is_idle

    def choose(self, tool: ToolName) -> None:
        """Take another tool; whoever calls it puts those of others away before."""
        self.cancel()
        self._choice.take(tool)

    def cancel(self) -> bool:
        """Give up what is being drawn; False when nothing is."""
        return sum(tool.cancel() for tool in self._tools.values()) > 0

    def leave(self) -> bool:
        """Give up what is being drawn, else put the tool away; False when there was neither."""
        if self.cancel():
            return True
        was_used = self.tool != "navigate"
        self._choice.take("navigate")
        return was_used

    def widen(self, notches: float) -> None:
        """Make the brush wider, or narrower by negative notches."""
        self._choice.widen(notches)

    def _hand_out(self, name: str) -> None:
        """Give every view its tool, or take it away where it is this one."""
        is_used = name != "navigate"
        for view, tool in self._tools.items():
            if is_used:
                view.grip.tool = tool
            elif view.grip.tool is tool:
                view.grip.tool = None
            tool.ground.surface.unsetCursor()
            tool.ground.surface.update()
        self._forget_cursor()
        self.strip.setVisible(is_used)
        self.tool_changed.emit(name)

    # --- What it shows --------------------------------------------------------------------------------------

    def set_theme(self, theme: Theme) -> None:
        """Paint in the colours of a theme."""
        self._theme = theme
        for tool in self._tools.values():
            tool.theme = theme

    def set_commands(self, commands: Sequence[QAction]) -> None:
        """Put these into the menu of every view."""
        self._commands = list(commands)

    def _tell(self) -> None:
        self._views.status.show_selection(*selected(self._selection.by_layer, self._editor.name_of))

    def _take(self, answer: Answer | None) -> None:
        """Know another result: its elevations and names."""
        self._forget_cursor()
        if answer is not None:
            low, high = (float(corner[2]) for corner in answer.result.scan.bounds())
            self.strip.set_range(low, high, round_step(max(high - low, 0.01) / STEPS))
            self.strip.name_layer(self._document.active_layer)

    def _forget_cursor(self) -> None:
        of_map = self._tools[self._views.map.plot]
        assert isinstance(of_map, MapSelectingTool)
        of_map.forget()

    # --- What it does ---------------------------------------------------------------------------------------

    def _carry(self, source: QWidget) -> None:
        """Carry the selection until it is dropped, what it would do being planned meanwhile."""
        self._editor.plan_ahead()
        carry(source, self._selection.count, self._theme)

    def _open_menu(self, tool: SelectingTool, at: QPointF) -> None:
        if self._document.answer is not None:
            open_menu(tool, at, self._selection, self._editor, self._commands)

    def close(self) -> None:
        """End the worker."""
        self._marked.close()
