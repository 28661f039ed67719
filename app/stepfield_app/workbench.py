"""What fills the window after its first paint: makes everything and connects everything, piece by piece."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from stepfield_app import commands, docks
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
from stepfield_app.theme import COMPLEX_COLOUR
from stepfield_app.tools.crop import CropTool
from stepfield_app.tools.select import SelectTools, Views
from stepfield_app.views.histogram import HistogramView
from stepfield_app.views.map import MapView
from stepfield_app.views.marks import MarkBox, Marks
from stepfield_app.views.profile import ProfileView
from stepfield_app.views.strip import Strip
from stepfield_app.views.trio import Trio

if TYPE_CHECKING:
    from stepfield_app.main_window import MainWindow


def furnish(window: MainWindow) -> Iterator[None]:
    """Make all that a window lacks that was just painted; each piece takes less than an eye notices."""
    with _as_painted(window):
        _make_document(window)
        yield
        yield from _make_plots(window)
        yield from _make_panels(window)
        yield from _put_into_docks(window)
        _make_feeds_and_tools(window)
        yield
        window.filing = Filing(window, remembers=window.remembers)
        window.actions_ = commands.make(window)
        yield
        _connect(window)
        window.dress(window.appearance.theme)
        window.show_whether_open()


@contextmanager
def _as_painted(window: MainWindow) -> Iterator[None]:
    """Leave a window on the screen as it is: all that is new comes into sight at once."""
    window.setUpdatesEnabled(False)
    try:
        yield
    finally:
        window.setUpdatesEnabled(True)


# --- Making -------------------------------------------------------------------------------------------------


def _make_document(window: MainWindow) -> None:
    window.client = RenderClient(window)
    window.first_paint.then(window.client.start)  # takes seconds, and nobody has to wait
    window.document = Document(parent=window)
    window.selection = Selection(window.document, window)
    window.editor = Editor(window.document, window.selection, window)
    window.trio = Trio(window.client)


def _make_plots(window: MainWindow) -> Iterator[None]:
    window.map = MapView()
    window.marks, window.mark_box = Marks(), MarkBox()
    window.complex_marks = Marks(lambda _: (COMPLEX_COLOUR,))
    for marks in (window.complex_marks, window.marks):
        window.map.plot.addItem(marks, ignoreBounds=True)
    window.map.strip.add(window.mark_box)
    yield
    window.profile = ProfileView()
    yield
    window.histogram = HistogramView()
    yield


def _make_panels(window: MainWindow) -> Iterator[None]:
    document = window.document
    window.parameters = ParametersPanel(document)
    yield
    window.cleaning = CleaningPanel(document)
    yield
    window.layers, window.history = LayersPanel(document), HistoryPanel(document)
    window.fidelity = FidelityPanel(Strip("Fidelity"))
    window.layer_editing = LayersEditing(document, window.layers, window.editor)
    yield
    window.moves, window.suspects = MovesPanel(document, window.editor), SuspectsPanel()
    yield


def _put_into_docks(window: MainWindow) -> Iterator[None]:
    for dock, panel in (
        (window.docks.parameters, window.parameters),
        (window.docks.cleaning, window.cleaning),
        (window.docks.elevations, window.histogram),
        (window.docks.layers, window.layers),
        (window.docks.fidelity, window.fidelity),
        (window.docks.history, window.history),
        (window.docks.edits, window.moves),
        (window.docks.suspects, window.suspects),
        (window.docks.map, window.map),
        (window.docks.profile, window.profile),
    ):
        docks.put(dock, panel)
        yield


def _make_feeds_and_tools(window: MainWindow) -> None:
    window.feeds = feeds = Feeds(window)
    window.crop_tool = CropTool(window.document, window.trio, feeds.scene)
    views = Views(window.trio, window.map, window.profile, window.status)
    window.select_tools = SelectTools(
        window.document, window.selection, window.editor, views, feeds.scene, window.layers.visible_layers
    )
    window.centre.add(window.trio, window.select_tools.strip)


# --- Connecting ---------------------------------------------------------------------------------------------


def _connect(window: MainWindow) -> None:
    document, feeds = window.document, window.feeds
    document.failed.connect(window.tell)
    document.opened.connect(window.note_opened)
    document.answer_changed.connect(lambda _: window.show_whether_open())
    for view in (window.trio, window.map, window.profile, window.histogram):
        document.pending_changed.connect(view.set_pending)
    window.profile.place_hovered.connect(lambda x, y: window.map.set_mark((x, y)))
    window.profile.cursor_left.connect(lambda: window.map.set_mark(None))
    for source in (*feeds, feeds.demo, window.selection, window.select_tools):
        source.failed.connect(window.tell)
    for says in (window.editor.told, feeds.suspect.told, feeds.complex.told):
        says.connect(window.status.say)
    document.undo_stack.indexChanged.connect(window.status.clearMessage)  # undone, perhaps
    window.layers.visibility_changed.connect(window.show_layers)
    window.fidelity.map_wanted.connect(window.show_map)
    window.moves.places_shown.connect(feeds.selection.show_places)
    window.cleaning.crop_tool_requested.connect(window.crop_tool.set_active)
    window.cleaning.crop_tool_requested.connect(window.show_cleaning)
    _connect_files(window)
    window.appearance.changed.connect(window.dress)


def _connect_files(window: MainWindow) -> None:
    feeds = window.feeds
    feeds.demo.progressed.connect(window.status.show_progress)
    feeds.complex.progressed.connect(window.status.show_progress)
    feeds.complex.rested.connect(window.status.clear_progress)
    feeds.demo.made.connect(window.open_scans)
    window.status.cancel_wanted.connect(window.cancel)
