"""What the status bar says: where the cursor is, what stands there, what the result holds."""

from __future__ import annotations

from PySide6.QtCore import QElapsedTimer, QObject

from stepfield_app.document import Document
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.requests import Answer
from stepfield_app.scenes.readout import compartment_at, filled_at, pillars_at
from stepfield_app.views.map import MapView
from stepfield_app.views.status import Status
from stepfield_app.views.trio import Trio

#: Milliseconds of work that need no progress bar.
BLINK = 250


class StatusFeed(QObject):
    """Connects the status bar with everything it reports."""

    def __init__(
        self, document: Document, status: Status, trio: Trio, map_view: MapView, scene_feed: SceneFeed
    ) -> None:
        super().__init__(status)
        self._document, self._status, self._scene_feed = document, status, scene_feed
        self._since = QElapsedTimer()
        document.answer_changed.connect(self._take)
        document.progressed.connect(self._show_progress)
        document.busy_changed.connect(self._note_busy)
        trio.hovered.connect(self._over_scene)
        map_view.cursor_moved.connect(self._over_map)
        map_view.cursor_left.connect(status.clear_position)

    def _take(self, answer: Answer | None) -> None:
        if answer is None:
            self._status.clear_result()
            self._status.clear_position()
            return
        result, facts = answer.result, self._document.facts
        points = len(result.scan) if facts is None or not answer.request.quick else facts.points
        pillars = sum(len(layer.pillars) for layer in result.layers)
        self._status.show_result(pillars, len(result.layers), points, answer.seconds)

    def _show_progress(self, share: float, what: str) -> None:
        """Show it unless a hand moves: a bar that comes and goes would lay the window out at every step."""
        if not self._document.held and self._since.hasExpired(BLINK):
            self._status.show_progress(share, what)

    def _note_busy(self, is_busy: bool) -> None:
        if is_busy:
            self._since.start()
        else:
            self._status.clear_progress()

    def _over_scene(self, place: tuple[float, float, float] | None) -> None:
        if place is None:
            self._status.clear_position()
            return
        x, y, z = (float(local + shift) for local, shift in zip(place, self._scene_feed.origin, strict=True))
        self._tell(x, y, z)

    def _over_map(self, x: float, y: float) -> None:
        answer = self._document.answer
        if answer is None:
            return
        layer, filled = self._document.active_layer, filled_at(answer.result, x, y)
        here = [each.elevation for each in pillars_at(answer.result, x, y) if each.layer == layer]
        self._tell(x, y, here[0] if here else filled.get(layer))

    def _tell(self, x: float, y: float, z: float | None) -> None:
        self._status.show_position(x, y, z)
        answer = self._document.answer
        if answer is None:
            return
        place = compartment_at(answer.result, x, y)
        if place is not None:
            here = pillars_at(answer.result, x, y)
            walls = sum(each.is_vertical for each in here)
            filled = len(filled_at(answer.result, x, y))
            self._status.show_cell(*place, len(here) - walls, walls, filled)
