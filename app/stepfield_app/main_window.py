"""The window: makes everything, connects everything, holds no data."""

from __future__ import annotations

import traceback
from collections.abc import Sequence
from pathlib import Path

from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QDialog, QMainWindow, QStackedWidget, QVBoxLayout, QWidget

from stepfield.errors import StepfieldError
from stepfield.parameters import Parameters
from stepfield_app import commands, docks
from stepfield_app.appearance import Appearance
from stepfield_app.commands.filing import Filing
from stepfield_app.document import Document
from stepfield_app.editor import Editor
from stepfield_app.feeds.feeds import Feeds
from stepfield_app.first_paint import FirstPaint
from stepfield_app.opening import DropTarget
from stepfield_app.panels.cleaning import CleaningPanel
from stepfield_app.panels.fidelity import FidelityPanel
from stepfield_app.panels.history import HistoryPanel
from stepfield_app.panels.layers import LayersPanel
from stepfield_app.panels.layers_editing import LayersEditing
from stepfield_app.panels.moves import MovesPanel
from stepfield_app.panels.parameters import ParametersPanel
from stepfield_app.panels.suspects import SuspectsPanel
from stepfield_app.render.client import RenderClient
from stepfield_app.selection import Selection
from stepfield_app.settings import Settings
from stepfield_app.theme import COMPLEX_COLOUR, Theme
from stepfield_app.tools.crop import CropTool
from stepfield_app.tools.select import SelectTools, Views
from stepfield_app.views.histogram import HistogramView
from stepfield_app.views.map import MapView
from stepfield_app.views.marks import MarkBox, Marks
from stepfield_app.views.message_bar import MessageBar
from stepfield_app.views.profile import ProfileView
from stepfield_app.views.status import Status
from stepfield_app.views.strip import Strip
from stepfield_app.views.trio import Trio
from stepfield_app.views.welcome import WelcomePage
from stepfield_app.wording import advice

#: Size of the window when nothing else is said.
USUAL_SIZE = (1440, 900)


class MainWindow(QMainWindow):
    """Stepfield's window.

    Parameters
    ----------
    appearance : Appearance
    settings : Settings
    size : tuple of int, optional
        Width and height in pixels; as the operator left it by default.
    remembers : bool
        False leaves the operator's arrangement and recent files alone.
    """

    def __init__(
        self,
        appearance: Appearance,
        settings: Settings,
        *,
        size: tuple[int, int] | None = None,
        remembers: bool = True,
    ) -> None:
        super().__init__()
        self.setWindowTitle("Stepfield")
        self.resize(*(size or USUAL_SIZE))
        self.setDockOptions(QMainWindow.DockOption.AllowTabbedDocks | QMainWindow.DockOption.AllowNestedDocks)
        self.appearance, self.settings, self._remembers = appearance, settings, remembers
        self.trouble: StepfieldError | None = None
        self.document = Document(parent=self)
        self.selection = Selection(self.document, self)
        self.editor = Editor(self.document, self.selection, self)
        self.client = RenderClient(self)
        self.first_paint = FirstPaint(self)
        self._make_views()
        self._make_panels()
        self.feeds = Feeds(self)
        self._make_tools()
        self.filing = Filing(self, remembers=remembers)
        self.actions_ = commands.make(self)
        self._connect()
        docks.arrange(self, self.docks)
        if remembers:
            docks.restore(self, settings, with_size=size is None)
        self._dress(appearance.theme)
        self._show_whether_open()

    # --- Making ---------------------------------------------------------------------------------------------

    def _make_views(self) -> None:
        self.trio = Trio(self.client)
        self.welcome = WelcomePage(self.settings.recent)
        self.message_bar = MessageBar(self.appearance.theme)
        self._middle = QStackedWidget()
        self._middle.addWidget(self.welcome)
        self._middle.addWidget(self.trio)
        centre = QWidget()
        self._centre = QVBoxLayout(centre)
        self._centre.setContentsMargins(0, 0, 0, 0)
        self._centre.setSpacing(0)
        self._centre.addWidget(self.message_bar)
        self._centre.addWidget(self._middle, 1)
        self.setCentralWidget(centre)
        self.status = Status(self)
        self.setStatusBar(self.status)

    def _make_panels(self) -> None:
        self.map, self.profile, self.histogram = MapView(), ProfileView(), HistogramView()
        self.parameters, self.cleaning = ParametersPanel(self.document), CleaningPanel(self.document)
        self.layers, self.history = LayersPanel(self.document), HistoryPanel(self.document)
        self.fidelity = FidelityPanel(Strip("Fidelity"))
        self.layer_editing = LayersEditing(self.document, self.layers, self.editor)
        self.moves, self.suspects = MovesPanel(self.document, self.editor), SuspectsPanel()
        self.marks, self.mark_box = Marks(), MarkBox()
        self.complex_marks = Marks(lambda _: (COMPLEX_COLOUR,))
        for marks in (self.complex_marks, self.marks):
            self.map.plot.addItem(marks, ignoreBounds=True)
        self.map.strip.add(self.mark_box)
        self.docks = docks.Docks(
            parameters=docks.docked(self, "Parameters", self.parameters, docks.LEFT),
            cleaning=docks.docked(self, "Cleaning", self.cleaning, docks.LEFT),
            elevations=docks.docked(self, "Elevations", self.histogram, docks.LEFT),
            layers=docks.docked(self, "Layers", self.layers, docks.RIGHT),
            fidelity=docks.docked(self, "Fidelity", self.fidelity, docks.RIGHT),
            history=docks.docked(self, "History", self.history, docks.RIGHT),
            edits=docks.docked(self, "Edits", self.moves, docks.RIGHT),
            suspects=docks.docked(self, "Suspicious places", self.suspects, docks.RIGHT),
            map=docks.docked(self, "Map", self.map, docks.BOTTOM),
            profile=docks.docked(self, "Profile", self.profile, docks.BOTTOM),
        )

    def _make_tools(self) -> None:
        self.crop_tool = CropTool(self.document, self.trio, self.feeds.scene)
        views = Views(self.trio, self.map, self.profile, self.status)
        self.select_tools = SelectTools(
            self.document, self.selection, self.editor, views, self.feeds.scene, self.layers.visible_layers
        )
        self._centre.insertWidget(1, self.select_tools.strip)

    def _connect(self) -> None:
        document, feeds = self.document, self.feeds
        self.first_paint.happened.connect(self.client.start)  # takes seconds, and nobody has to wait
        document.failed.connect(self.tell)
        document.opened.connect(self._note_opened)
        document.answer_changed.connect(lambda _: self._show_whether_open())
        for view in (self.trio, self.map, self.profile, self.histogram):
            document.pending_changed.connect(view.set_pending)
        self.profile.place_hovered.connect(lambda x, y: self.map.set_mark((x, y)))
        self.profile.cursor_left.connect(lambda: self.map.set_mark(None))
        for source in (*feeds, feeds.demo, self.selection, self.select_tools):
            source.failed.connect(self.tell)
        for says in (self.editor.told, feeds.suspect.told, feeds.complex.told):
            says.connect(self.status.say)
        document.undo_stack.indexChanged.connect(lambda _: self.status.clearMessage())  # undone, perhaps
        self.layers.visibility_changed.connect(self._show_layers)
        self.fidelity.map_wanted.connect(self.show_map)
        self.moves.places_shown.connect(feeds.selection.show_places)
        self.cleaning.crop_tool_requested.connect(self.crop_tool.set_active)
        self.cleaning.crop_tool_requested.connect(self._show_cleaning)
        self.welcome.open_wanted.connect(self.filing.choose_files)
        self.welcome.demo_wanted.connect(feeds.demo.start)
        self.welcome.files_chosen.connect(self.open_scans)
        feeds.demo.progressed.connect(self.status.show_progress)
        feeds.complex.progressed.connect(self.status.show_progress)
        feeds.complex.rested.connect(self.status.clear_progress)
        feeds.demo.made.connect(self.open_scans)
        self.status.cancel_wanted.connect(self.cancel)
        DropTarget(self).dropped.connect(self.open_scans)
        self.appearance.changed.connect(self._dress)

    # --- Doing ----------------------------------------------------------------------------------------------

    def open_scans(self, files: Sequence[Path], parameters: Parameters | None = None) -> None:
        """Open the files of one scan, or a project; the present one stays until the new one has been read."""
        self.filing.open(files, parameters)

    def show_map(self, mode: str) -> None:
        """Show the map, drawn in one of its ways."""
        self.docks.map.show()
        self.docks.map.raise_()
        self.map.set_mode(mode)

    def cancel(self) -> None:
        """Stop what is being made."""
        self.feeds.cancel()
        self.filing.cancel()
        self.document.cancel()

    def tell(self, error: BaseException) -> None:
        """Show a failure, in the one place that shows any."""
        if isinstance(error, StepfieldError):
            self.trouble = error
            self.message_bar.tell("error", str(error))
        else:
            self.tell_unexpected("".join(traceback.format_exception(error)))

    def tell_unexpected(self, details: str) -> None:
        """Show a fault of the program's own, with what helps to mend it."""
        self.trouble = StepfieldError("something unexpected went wrong in the window; the details say what")
        self.message_bar.tell(
            "error", f"{self.trouble}. Your scan and its parameters are as they were.", details
        )

    def is_settled(self) -> bool:
        """Whether everything that was asked for is on the screen."""
        document = self.document
        if document.busy or document.pending or self.selection.busy:
            return False
        parts = self.filing, self.editor, self.select_tools, self.feeds
        return all(part.is_idle for part in parts) and self._is_drawn()

    def _is_drawn(self) -> bool:
        return self.document.answer is None or (
            not self.trio.viewpoint.is_moving and self.client.is_at_rest()
        )

    # --- Following ------------------------------------------------------------------------------------------

    def _note_opened(self) -> None:
        self.trouble = None
        assert self.document.answer is not None
        for warning in self.document.answer.result.scan.warnings:
            self.message_bar.tell("warning", advice(warning))

    def _show_whether_open(self) -> None:
        is_open = self.document.answer is not None
        if is_open == (self._middle.currentWidget() is self.trio) and self.isVisible():
            return
        self._middle.setCurrentWidget(self.trio if is_open else self.welcome)
        self.actions_.enable(is_open)
        self.mark_box.setEnabled(is_open)
        if is_open:
            self.trio.setFocus()

    def _show_layers(self) -> None:
        visible = self.layers.visible_layers()
        self.feeds.scene.set_visible(visible)
        self.feeds.selection.set_visible(visible)

    def _show_cleaning(self, is_wanted: bool) -> None:
        """Bring the numbers of the crop box to the front while it is worked on."""
        if is_wanted and not self.docks.cleaning.isHidden():
            self.docks.cleaning.raise_()

    def _dress(self, theme: Theme) -> None:
        for part in (
            self.trio,
            self.map,
            self.profile,
            self.histogram,
            self.layers,
            self.moves,
            self.marks,
            self.complex_marks,
            self.mark_box,
            self.message_bar,
            self.crop_tool,
            self.select_tools,
        ):
            part.set_theme(theme)
        self.feeds.scene.set_theme(theme)

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Stop everything; no process and no thread is left."""
        if not self.filing.may_close():
            event.ignore()
            return
        if self._remembers:
            docks.remember(self, self.settings)
        for dialog in self.findChildren(QDialog):
            dialog.done(QDialog.DialogCode.Rejected)  # a signal closes the window under an open dialog
        for part in (self.feeds, self.select_tools, self.editor, self.selection):
            part.close()
        self.filing.close()
        self.document.close()
        self.client.close()
        super().closeEvent(event)
