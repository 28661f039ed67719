"""Meshes the complex parts of a result once everything is at rest, and shows them in map and scene."""

from __future__ import annotations

from PySide6.QtCore import QObject, QTimer, Signal

from stepfield.complex_parts import build_complex_parts
from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield_app.document import Document
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.newest import NewestWins
from stepfield_app.requests import Answer
from stepfield_app.scenes.complex_parts import Meshed, complex_cells
from stepfield_app.views.map import MapView
from stepfield_app.views.marks import Marks
from stepfield_app.wording import counted

#: Milliseconds of quiet after a new result before anything is meshed: it takes seconds.
QUIET = 400


class ComplexFeed(QObject):
    """Keeps the mesh of complex parts true to the document, where its parameters ask for one.

    Parameters
    ----------
    document : Document
    scene_feed : SceneFeed
    map_view : MapView
    marks : Marks
        In the map.
    threaded : bool
        False meshes at once: for tests.
    """

    failed = Signal(object)  # exception
    progressed = Signal(float, str)
    rested = Signal()
    #: Meshed, or None once it no longer belongs to what is shown.
    shown = Signal(object)
    #: What was meshed, one sentence without a full stop.
    told = Signal(str)

    def __init__(
        self,
        document: Document,
        scene_feed: SceneFeed,
        map_view: MapView,
        marks: Marks,
        *,
        threaded: bool = True,
    ) -> None:
        super().__init__(document)
        self._document, self._scenes, self._map, self._marks = document, scene_feed, map_view, marks
        self.meshed: Meshed | None = None
        self._quiet = QTimer(self, singleShot=True, interval=QUIET)
        self._quiet.timeout.connect(self._look)
        self._meshing = NewestWins[Reconstruction, Meshed](_meshed, "complex parts", self, threaded=threaded)
        self._meshing.answered.connect(self._take)
        self._meshing.failed.connect(lambda _, error: self.failed.emit(error))
        self._meshing.progressed.connect(self.progressed)
        self._meshing.busy_changed.connect(lambda is_busy: None if is_busy else self.rested.emit())
        document.answer_changed.connect(self._follow)
        document.held_changed.connect(lambda is_held: None if is_held else self._want())
        map_view.picture_changed.connect(self._mark)

    @property
    def is_idle(self) -> bool:
        """Whether everything that is wanted is shown."""
        return not (self._quiet.isActive() or self._meshing.busy)

    def cancel(self) -> None:
        """Stop meshing; the next result begins anew."""
        self._quiet.stop()
        self._meshing.cancel()

    def close(self) -> None:
        """End the worker."""
        self._meshing.close()

    def _follow(self, answer: Answer | None) -> None:
        """Drop what belongs to another result, and stop making more of it."""
        running = self._meshing.running
        if self.meshed is not None and (answer is None or not self.meshed.belongs_to(answer.result)):
            self._show(None)
        if running is not None and (answer is None or answer.result is not running):
            self.cancel()
        self._want()

    def _want(self) -> None:
        answer = self._document.answer
        is_wanted = answer is not None and answer.result.parameters.complex_parts == "mesh"
        if is_wanted and self.meshed is None:
            self._quiet.start()
        else:
            self._quiet.stop()

    def _look(self) -> None:
        answer = self._document.answer
        if answer is None or answer.request.quick or self._document.held or self._document.busy:
            return  # another answer will follow, or a hand that comes to rest
        if self._meshing.running is not answer.result:
            self._meshing.ask(answer.result)

    def _take(self, result: Reconstruction, meshed: Meshed) -> None:
        answer = self._document.answer
        if answer is not None and meshed.belongs_to(answer.result):
            self._show(meshed)
            parts = meshed.parts
            self.told.emit(
                f"{counted(len(parts.mesh.triangles), 'triangle')} in place of "
                f"{counted(parts.count, 'complex pillar')}"
            )

    def _show(self, meshed: Meshed | None) -> None:
        self.meshed = meshed
        self._scenes.set_meshed(meshed)
        self.shown.emit(meshed)
        self._mark()

    def _mark(self) -> None:
        meshed, layer = self.meshed, self._map.layer
        cells = complex_cells(meshed, layer) if meshed is not None and layer >= 0 else None
        self._marks.set_cells(cells)
        self._map.set_note("lime: meshed" if cells is not None and len(cells.kind) else "")


def _meshed(result: Reconstruction, progress: Progress) -> Meshed:
    return Meshed(result, build_complex_parts(result, progress))
