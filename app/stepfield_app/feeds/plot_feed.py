"""Keeps map, profile, histogram and layers panel true to the document."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from stepfield_app.document import Document
from stepfield_app.feeds.hurry import Hurry
from stepfield_app.feeds.panel_pictures import PanelDrawing, PanelPictures, PanelWish
from stepfield_app.feeds.plots import (
    Cutting,
    MapWish,
    SectionWish,
    map_picture,
)
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.newest import NewestWins
from stepfield_app.panels.layers import LayersPanel
from stepfield_app.requests import Answer
from stepfield_app.scenes.fidelity import FidelityFacts
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.views.histogram import HistogramView
from stepfield_app.views.line import ProfileLine
from stepfield_app.views.map import MapView
from stepfield_app.views.pictures import MapPicture, Section
from stepfield_app.views.profile import ProfileView

#: Seconds between two profiles: the map and the panel of a new result come first.
PROFILE_PACE = 0.25
#: Milliseconds by which they go before the profile of an edit, which takes long to be painted.
COURTESY = 120


class PlotFeed(QObject):
    """Asks for pictures of an answer as soon as it is there, and hands them on."""

    failed = Signal(object)  # exception

    def __init__(
        self,
        document: Document,
        scene_feed: SceneFeed,
        map_view: MapView,
        profile: ProfileView,
        histogram: HistogramView,
        layers: LayersPanel,
    ) -> None:
        super().__init__(document)
        self._document, self._scene_feed = document, scene_feed
        self._map, self._profile, self._histogram, self._layers = map_view, profile, histogram, layers
        self._facts: FidelityFacts | None = None
        self._maps = self._worker(map_picture, "map", self._show_map)
        self._panels = self._worker(PanelDrawing(), "layers panel", self._show_panel)
        self._sections = self._worker(Cutting(), "profile", self._show_section, PROFILE_PACE)
        self._courtesy = QTimer(self, singleShot=True, interval=COURTESY)
        self._courtesy.timeout.connect(self._cut)
        document.answer_changed.connect(self._take)
        document.opened.connect(self._begin)
        self._hurry = Hurry(document, self)
        self._hurry.changed.connect(self._hold)
        document.active_layer_changed.connect(map_view.set_layer)
        document.project_changed.connect(lambda _: self._recolour())
        scene_feed.cloud_changed.connect(self._cut)
        map_view.picture_wanted.connect(self._draw)
        map_view.section_wanted.connect(lambda start, end, width: self._cut())
        map_view.section_ended.connect(lambda: profile.set_section(None))
        profile.width_changed.connect(map_view.set_line_width)

    def _worker(self, make: Any, name: str, show: Any, pace: float = 0.0) -> NewestWins[Any, Any]:
        worker = NewestWins[Any, Any](make, name, self, pace=pace)
        worker.answered.connect(lambda _, made: show(made))
        worker.failed.connect(lambda _, error: self.failed.emit(error))
        return worker

    @property
    def is_idle(self) -> bool:
        """Whether everything asked for has been handed over."""
        return not self._courtesy.isActive() and not any(worker.busy for worker in self._workers)

    @property
    def _workers(self) -> tuple[NewestWins[Any, Any], ...]:
        return self._maps, self._panels, self._sections

    def close(self) -> None:
        """End the workers."""
        for worker in self._workers:
            worker.close()

    def set_facts(self, facts: FidelityFacts | None) -> None:
        """Take what is newly known of how true a result is."""
        self._facts = facts
        if facts is not None and self._map.mode == "error":
            self._draw(self._map.layer, "error")

    # --- Asking ---------------------------------------------------------------------------------------------

    def _take(self, answer: Answer | None) -> None:
        self._courtesy.stop()
        if answer is None:
            for worker in self._workers:
                worker.forget()
            self._map.clear()
            self._profile.set_section(None)
            self._histogram.set_histogram(None)
            return
        self._draw(self._map.layer, self._map.mode)
        self._draw_panel(answer)
        if self._document.held:
            self._cut()
        else:
            self._courtesy.start()

    def _hold(self, hurries: bool) -> None:
        """Draw all there is once a hand has stopped; of what is still pending an answer comes in a moment."""
        answer = self._document.answer
        if not hurries and answer is not None and (answer.request.quick or not self._document.pending):
            self._draw(self._map.layer, self._map.mode)
            self._draw_panel(answer)

    def _begin(self) -> None:
        """Draw a first profile through the middle, so that the panel shows what it is for."""
        answer = self._document.answer
        assert answer is not None
        low, high = answer.result.scan.bounds()
        middle = float(low[1] + high[1]) / 2
        grid = answer.result.field.compartments.grid
        self._map.clear()
        self._profile.set_cell_size(grid.cell_size)
        self._draw(self._document.active_layer, self._map.mode)
        self._map.set_line(ProfileLine((float(low[0]), middle), (float(high[0]), middle), 2 * grid.cell_size))

    def _recolour(self) -> None:
        """Show new colours and names at once; a change of parameters comes with an answer of its own."""
        answer = self._document.answer
        if answer is not None and not self._document.pending:
            self._draw(self._map.layer, self._map.mode)
            self._draw_panel(answer)

    def _draw_panel(self, answer: Answer) -> None:
        self._panels.ask(PanelWish(answer, self._colours(answer), bool(self._hurry)))

    def _draw(self, layer: int, mode: str) -> None:
        answer = self._document.answer
        if answer is not None and layer < len(answer.result.layers):
            hurries = bool(self._hurry)
            self._maps.ask(MapWish(answer, layer, mode, self._colours(answer), hurries, self._facts))

    def _cut(self) -> None:
        self._courtesy.stop()
        answer, cloud, line = self._document.answer, self._scene_feed.cloud, self._map.line
        if answer is not None and cloud is not None and line is not None:
            self._sections.ask(SectionWish(answer, cloud, line, self._colours(answer)))

    def _colours(self, answer: Answer) -> Any:
        return layer_colours(len(answer.result.layers), self._document.project.layers)

    # --- Showing --------------------------------------------------------------------------------------------

    def _show_map(self, picture: MapPicture) -> None:
        self._map.set_picture(picture)

    def _show_panel(self, pictures: PanelPictures) -> None:
        self._layers.set_thumbnails(pictures.thumbnails)
        self._histogram.set_histogram(pictures.histogram)

    def _show_section(self, section: Section) -> None:
        if self._map.line is not None:
            self._profile.set_section(section)
