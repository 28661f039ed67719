"""What fills the window: makes everything there is to work with and connects it, piece by piece."""

from __future__ import annotations

from collections.abc import Iterator

from stepfield_app import docks
from stepfield_app.document import Document
from stepfield_app.editor import Editor
from stepfield_app.feeds.complex_feed import ComplexFeed
from stepfield_app.feeds.demo_feed import DemoFeed
from stepfield_app.feeds.feeds import Feeds
from stepfield_app.feeds.fidelity_feed import FidelityFeed
from stepfield_app.feeds.lead import Lead
from stepfield_app.feeds.plot_feed import PlotFeed
from stepfield_app.feeds.recolour_feed import RecolourFeed
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.feeds.selection_feed import SelectionFeed
from stepfield_app.feeds.status_feed import StatusFeed
from stepfield_app.feeds.stray_feed import StrayFeed
from stepfield_app.feeds.suspect_feed import SuspectFeed
from stepfield_app.frame import Frame
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
from stepfield_app.theme import COMPLEX_COLOUR, Theme
from stepfield_app.tools.crop import CropTool
from stepfield_app.tools.select import SelectTools, Views
from stepfield_app.views.histogram import HistogramView
from stepfield_app.views.map import MapView
from stepfield_app.views.marks import MarkBox, Marks
from stepfield_app.views.profile import ProfileView
from stepfield_app.views.strip import Strip
from stepfield_app.views.trio import Trio
from stepfield_app.wording import advice


class Workbench:
    """The document and all that shows and changes it: views, panels, feeds and tools.

    Parameters
    ----------
    frame : Frame
        Where they stand.

    Attributes
    ----------
    frame : Frame
    """

    document: Document
    selection: Selection
    editor: Editor
    client: RenderClient
    trio: Trio
    map: MapView
    profile: ProfileView
    histogram: HistogramView
    marks: Marks
    complex_marks: Marks
    mark_box: MarkBox
    parameters: ParametersPanel
    cleaning: CleaningPanel
    layers: LayersPanel
    layer_editing: LayersEditing
    fidelity: FidelityPanel
    history: HistoryPanel
    moves: MovesPanel
    suspects: SuspectsPanel
    feeds: Feeds
    crop_tool: CropTool
    select_tools: SelectTools

    def __init__(self, frame: Frame) -> None:
        self.frame = frame

    # --- Making ---------------------------------------------------------------------------------------------

    def fill(self) -> Iterator[None]:
        """Make everything and put it into the frame; each piece takes less than an eye notices."""
        self._make_document()
        yield
        yield from self._make_plots()
        yield from self._make_panels()
        yield from self._put_into_docks()
        self._make_feeds()
        self._make_tools()
        yield
        self._connect()

    def _make_document(self) -> None:
        frame = self.frame
        self.client = RenderClient(frame)
        frame.first_paint.then(self.client.start)  # takes seconds, and nobody has to wait
        self.document = Document(parent=frame)
        self.selection = Selection(self.document, frame)
        self.editor = Editor(self.document, self.selection, frame)
        self.trio = Trio(self.client)

    def _make_plots(self) -> Iterator[None]:
        self.map = MapView()
        self.marks, self.mark_box = Marks(), MarkBox()
        self.complex_marks = Marks(lambda _: (COMPLEX_COLOUR,))
        for marks in (self.complex_marks, self.marks):
            self.map.plot.addItem(marks, ignoreBounds=True)
        self.map.strip.add(self.mark_box)
        yield
        self.profile = ProfileView()
        yield
        self.histogram = HistogramView()
        yield

    def _make_panels(self) -> Iterator[None]:
        document = self.document
        self.parameters = ParametersPanel(document)
        yield
        self.cleaning = CleaningPanel(document)
        yield
        self.layers, self.history = LayersPanel(document), HistoryPanel(document)
        self.fidelity = FidelityPanel(Strip("Fidelity"))
        self.layer_editing = LayersEditing(document, self.layers, self.editor)
        yield
        self.moves, self.suspects = MovesPanel(document, self.editor), SuspectsPanel()
        yield

    def _put_into_docks(self) -> Iterator[None]:
        places = self.frame.docks
        for dock, panel in (
            (places.parameters, self.parameters),
            (places.cleaning, self.cleaning),
            (places.elevations, self.histogram),
            (places.layers, self.layers),
            (places.fidelity, self.fidelity),
            (places.history, self.history),
            (places.edits, self.moves),
            (places.suspects, self.suspects),
            (places.map, self.map),
            (places.profile, self.profile),
        ):
            docks.put(dock, panel)
            yield

    def _make_feeds(self) -> None:
        document, trio, client, map_view = self.document, self.trio, self.client, self.map
        scene = SceneFeed(document, trio, client)
        selection = SelectionFeed(document, self.selection, scene, client)
        self.feeds = Feeds(
            scene=scene,
            recolour=RecolourFeed(document, trio, client, scene),
            plot=PlotFeed(document, scene, map_view, self.profile, self.histogram, self.layers),
            fidelity=FidelityFeed(document, self.fidelity, scene.is_drawn),
            status=StatusFeed(document, self.frame.status, trio, map_view, scene),
            stray=StrayFeed(document, self.cleaning, scene),
            demo=DemoFeed(self.frame),
            selection=selection,
            complex=ComplexFeed(document, scene, map_view, self.complex_marks),
            suspect=SuspectFeed(
                document,
                self.selection,
                map_view,
                self.marks,
                self.mark_box,
                self.suspects,
                Lead(document, map_view, trio, scene, selection),
                scene.is_drawn,
            ),
        )

    def _make_tools(self) -> None:
        scene = self.feeds.scene
        self.crop_tool = CropTool(self.document, self.trio, scene)
        views = Views(self.trio, self.map, self.profile, self.frame.status)
        self.select_tools = SelectTools(
            self.document, self.selection, self.editor, views, scene, self.layers.visible_layers
        )
        self.frame.centre.add(self.trio, self.select_tools.strip)

    # --- Connecting -----------------------------------------------------------------------------------------

    def _connect(self) -> None:
        document, feeds, frame = self.document, self.feeds, self.frame
        for source in (document, *feeds, feeds.demo, self.selection, self.select_tools):
            source.failed.connect(frame.tell)
        document.opened.connect(self._note_opened)
        for view in (self.trio, self.map, self.profile, self.histogram):
            document.pending_changed.connect(view.set_pending)
        self.profile.place_hovered.connect(lambda x, y: self.map.set_mark((x, y)))
        self.profile.cursor_left.connect(lambda: self.map.set_mark(None))
        feeds.fidelity.changed.connect(feeds.plot.set_facts)
        feeds.complex.shown.connect(feeds.fidelity.set_meshed)
        self.layers.visibility_changed.connect(self._show_layers)
        self.fidelity.map_wanted.connect(self.show_map)
        self.moves.places_shown.connect(feeds.selection.show_places)
        self.cleaning.crop_tool_requested.connect(self.crop_tool.set_active)
        self.cleaning.crop_tool_requested.connect(self._show_cleaning)
        self._connect_status()

    def _connect_status(self) -> None:
        status, feeds = self.frame.status, self.feeds
        for says in (self.editor.told, feeds.suspect.told, feeds.complex.told):
            says.connect(status.say)
        self.document.undo_stack.indexChanged.connect(status.clearMessage)  # undone, perhaps
        for works in (feeds.demo, feeds.complex):
            works.progressed.connect(status.show_progress)
        feeds.complex.rested.connect(status.clear_progress)

    # --- Doing ----------------------------------------------------------------------------------------------

    def show_map(self, mode: str) -> None:
        """Show the map, drawn in one of its ways."""
        self.raise_map()
        self.map.set_mode(mode)

    def raise_map(self) -> None:
        """Bring the map to the front."""
        dock = self.frame.docks.map
        dock.show()
        dock.raise_()

    def cancel(self) -> None:
        """Stop what is being made."""
        self.feeds.cancel()
        self.document.cancel()

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
            self.crop_tool,
            self.select_tools,
        ):
            part.set_theme(theme)
        self.feeds.scene.set_theme(theme)

    def is_settled(self) -> bool:
        """Whether everything that was asked for is on the screen."""
        document = self.document
        if document.busy or document.pending or self.selection.busy:
            return False
        return all(part.is_idle for part in (self.editor, self.select_tools, self.feeds)) and self._is_drawn()

    def _is_drawn(self) -> bool:
        return self.document.answer is None or (
            not self.trio.viewpoint.is_moving and self.client.is_at_rest()
        )

    def close(self) -> None:
        """End every thread and the drawing process."""
        for part in (self.feeds, self.select_tools, self.editor, self.selection, self.document, self.client):
            part.close()

    # --- Following ------------------------------------------------------------------------------------------

    def _note_opened(self) -> None:
        """Pass on what is strange about a scan that was just opened."""
        self.frame.trouble = None
        assert self.document.answer is not None
        for warning in self.document.answer.result.scan.warnings:
            self.frame.message_bar.tell("warning", advice(warning))

    def _show_layers(self) -> None:
        """Show the layers in the 3-D views that are to be seen."""
        visible = self.layers.visible_layers()
        self.feeds.scene.set_visible(visible)
        self.feeds.selection.set_visible(visible)

    def _show_cleaning(self, is_wanted: bool) -> None:
        """Bring the numbers of the crop box to the front while it is worked on."""
        if is_wanted and not self.frame.docks.cleaning.isHidden():
            self.frame.docks.cleaning.raise_()
