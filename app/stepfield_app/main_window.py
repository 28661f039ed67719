"""The window: what is painted first, and what can be done with all of it; holds no data."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from PySide6.QtCore import QSize
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QDialog, QMainWindow

from stepfield.errors import StepfieldError
from stepfield.parameters import Parameters
from stepfield_app import docks, toolbars
from stepfield_app.afterwards import Afterwards
from stepfield_app.appearance import Appearance
from stepfield_app.dropping import DropTarget
from stepfield_app.first_paint import FirstPaint
from stepfield_app.settings import Settings
from stepfield_app.theme import Theme
from stepfield_app.views.centre import Centre
from stepfield_app.views.message_bar import MessageBar
from stepfield_app.views.status import Status
from stepfield_app.views.welcome import WelcomePage
from stepfield_app.wording import advice

if TYPE_CHECKING:
    from stepfield_app.actions import Actions
    from stepfield_app.commands.filing import Filing
    from stepfield_app.document import Document
    from stepfield_app.editor import Editor
    from stepfield_app.feeds.feeds import Feeds
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
    from stepfield_app.tools.crop import CropTool
    from stepfield_app.tools.select import SelectTools
    from stepfield_app.views.histogram import HistogramView
    from stepfield_app.views.map import MapView
    from stepfield_app.views.marks import MarkBox, Marks
    from stepfield_app.views.profile import ProfileView
    from stepfield_app.views.trio import Trio

#: Size of the window when nothing else is said and the screen is large enough.
USUAL_SIZE = QSize(1440, 900)


class MainWindow(QMainWindow):
    """Stepfield's window, painted with menus, toolbars, docks and a page that says what can be opened.

    What fills it comes then, see :mod:`stepfield_app.workbench`; nothing here may import any of that.

    Parameters
    ----------
    appearance : Appearance
    settings : Settings
    size : tuple of int, optional
        Width and height in pixels; as the operator left it by default.
    remembers : bool
        False leaves the operator's arrangement and recent files alone.
    in_pieces : bool
        Whether it is filled after its first paint, and not at once.

    Attributes
    ----------
    ready : Signal
        All is there.
    """

    status: Status
    document: Document
    selection: Selection
    editor: Editor
    client: RenderClient
    trio: Trio
    map: MapView
    profile: ProfileView
    histogram: HistogramView
    parameters: ParametersPanel
    cleaning: CleaningPanel
    layers: LayersPanel
    layer_editing: LayersEditing
    fidelity: FidelityPanel
    history: HistoryPanel
    moves: MovesPanel
    suspects: SuspectsPanel
    marks: Marks
    complex_marks: Marks
    mark_box: MarkBox
    feeds: Feeds
    crop_tool: CropTool
    select_tools: SelectTools
    filing: Filing
    actions_: Actions

    def __init__(
        self,
        appearance: Appearance,
        settings: Settings,
        *,
        size: tuple[int, int] | None = None,
        remembers: bool = True,
        in_pieces: bool = False,
    ) -> None:
        super().__init__()
        self.setWindowTitle("Stepfield")
        self.resize(QSize(*size) if size else USUAL_SIZE.boundedTo(self.screen().availableSize()))
        self.setDockOptions(QMainWindow.DockOption.AllowTabbedDocks | QMainWindow.DockOption.AllowNestedDocks)
        self.appearance, self.settings, self.remembers = appearance, settings, remembers
        self.trouble: StepfieldError | None = None
        self.first_paint = FirstPaint(self)
        self._afterwards = Afterwards(_workbench, lambda: _workbench().furnish(self), self)
        self.ready = self._afterwards.done
        self._make_centre()
        toolbars.sketch(self, self.welcome.open_wanted.emit)
        self.docks = docks.make(self)
        if remembers:
            docks.restore(self, settings, with_size=size is None)
        if in_pieces:
            self.first_paint.then(self._afterwards.begin)
        else:
            self._afterwards.finish()

    # --- Making ---------------------------------------------------------------------------------------------

    def _make_centre(self) -> None:
        self.welcome = WelcomePage(self.settings.recent)
        self.welcome.open_wanted.connect(partial(self.when_ready, lambda: self.filing.choose_files()))
        self.welcome.demo_wanted.connect(partial(self.when_ready, lambda: self.feeds.demo.start()))
        self.welcome.files_chosen.connect(self.open_scans)
        self.message_bar = MessageBar(self.appearance.theme)
        self.centre = Centre(self.message_bar, self.welcome)
        self.setCentralWidget(self.centre)
        self.status = Status(self)
        self.setStatusBar(self.status)
        DropTarget(self).dropped.connect(self.open_scans)

    @property
    def is_ready(self) -> bool:
        """Whether everything is there."""
        return self._afterwards.is_done

    def when_ready(self, call: Callable[[], object]) -> None:
        """Call when everything is there."""
        if self.is_ready:
            call()
        else:
            self.ready.connect(call)

    # --- Doing ----------------------------------------------------------------------------------------------

    def open_scans(self, files: Sequence[Path], parameters: Parameters | None = None) -> None:
        """Open the files of one scan, or a project; the present one stays until the new one has been read."""
        self.when_ready(lambda: self.filing.open(files, parameters))

    def show_map(self, mode: str) -> None:
        """Show the map, drawn in one of its ways."""
        self.docks.map.show()
        self.docks.map.raise_()
        self.map.set_mode(mode)

    def close_at_once(self) -> None:
        """Close, and ask nothing: edits are kept for the next time."""
        if self.is_ready:
            self.filing.close_at_once()
        else:
            self.close()

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
        if not self.is_ready:
            return False
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

    def note_opened(self) -> None:
        """Pass on what is strange about a scan that was just opened."""
        self.trouble = None
        assert self.document.answer is not None
        for warning in self.document.answer.result.scan.warnings:
            self.message_bar.tell("warning", advice(warning))

    def show_whether_open(self) -> None:
        """Show the views while a scan is open, and what can be opened while there is none."""
        is_open = self.document.answer is not None
        if self.is_ready and is_open == self.centre.shows_views:
            return
        self.centre.show_views(is_open)
        self.actions_.enable(is_open)
        self.mark_box.setEnabled(is_open)
        if is_open:
            self.trio.setFocus()

    def show_layers(self) -> None:
        """Show the layers in the 3-D views that are to be seen."""
        visible = self.layers.visible_layers()
        self.feeds.scene.set_visible(visible)
        self.feeds.selection.set_visible(visible)

    def show_cleaning(self, is_wanted: bool) -> None:
        """Bring the numbers of the crop box to the front while it is worked on."""
        if is_wanted and not self.docks.cleaning.isHidden():
            self.docks.cleaning.raise_()

    def dress(self, theme: Theme) -> None:
        """Put on the colours of a theme."""
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
        self._afterwards.stop()
        if not self.is_ready:
            return
        if not self.filing.may_close():
            event.ignore()
            return
        if self.remembers:
            docks.remember(self, self.settings)
        for dialog in self.findChildren(QDialog):
            dialog.done(QDialog.DialogCode.Rejected)  # a signal closes the window under an open dialog
        for part in (self.feeds, self.select_tools, self.editor, self.selection):
            part.close()
        self.filing.close()
        self.document.close()
        self.client.close()
        super().closeEvent(event)


def _workbench() -> ModuleType:
    from stepfield_app import workbench  # takes longer to load than all before the first paint

    return workbench
