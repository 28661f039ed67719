"""Finds suspicious places, marks them in the map, and goes from one to the next in all views."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QObject, Signal

from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield.suspects import KINDS, Place, Suspects, suspects
from stepfield_app.document import Document
from stepfield_app.feeds.courtesy import Courtesy, at_once
from stepfield_app.feeds.lead import Lead
from stepfield_app.newest import NewestWins
from stepfield_app.panels.suspects import SuspectsPanel
from stepfield_app.requests import Answer
from stepfield_app.scenes.suspects import Cells, cells
from stepfield_app.selection import Selection
from stepfield_app.views.map import MapView
from stepfield_app.views.marks import MarkBox, Marks

#: Milliseconds of quiet after a new result before anything is looked for: the views come first.
QUIET = 250


@dataclass(frozen=True, eq=False)
class Found:
    """What is suspicious in a result."""

    result: Reconstruction
    suspects: Suspects


@dataclass(frozen=True, eq=False)
class _MarkWish:
    """What to mark in the map of a layer."""

    found: Found
    kinds: tuple[str, ...]
    layer: int


class SuspectFeed(QObject):
    """Looks for suspicious places as long as somebody wants to know.

    Parameters
    ----------
    document : Document
    selection : Selection
    map_view : MapView
    marks : Marks
        In the map.
    box : MarkBox
        Chooses what is marked, and of which kind the places are that one goes to; all where nothing is.
    panel : SuspectsPanel
    lead : Lead
        Leads the views to a place.
    is_drawn : callable
        Whether the views show the newest result in full: they go first.
    """

    failed = Signal(object)  # exception
    #: What is suspicious at the place that is shown, one sentence without a full stop.
    told = Signal(str)

    def __init__(
        self,
        document: Document,
        selection: Selection,
        map_view: MapView,
        marks: Marks,
        box: MarkBox,
        panel: SuspectsPanel,
        lead: Lead,
        is_drawn: Callable[[], bool] = at_once,
    ) -> None:
        super().__init__(document)
        self._document, self._selection, self._map = document, selection, map_view
        self._marks, self._box, self._panel, self._lead = marks, box, panel, lead
        self._found: Found | None = None
        self._at: Place | None = None  # the place that is shown, or was in an older result
        self._number = 0
        self._owed_step = 0
        self._quiet = Courtesy(QUIET, is_drawn, self)
        self._quiet.passed.connect(self._look)
        self._search = NewestWins[Reconstruction, Found](_found, "suspicious places", self)
        self._search.answered.connect(self._take_found)
        self._cells = NewestWins[_MarkWish, Cells](_marked, "marks in the map", self)
        self._cells.answered.connect(self._show_cells)
        for worker in (self._search, self._cells):
            worker.failed.connect(lambda _, error: self.failed.emit(error))
        document.answer_changed.connect(self._follow)
        document.held_changed.connect(lambda is_held: None if is_held else self._want())
        map_view.picture_changed.connect(self._mark)
        box.chosen.connect(self._choose)
        panel.step_wanted.connect(self.step)
        panel.select_wanted.connect(self.select)
        panel.came_to_light.connect(self._want)

    @property
    def is_idle(self) -> bool:
        """Whether everything that is wanted is shown."""
        return not (self._quiet.is_active or self._search.busy or self._cells.busy)

    @property
    def place(self) -> Place | None:
        """The place that is shown, of the newest result."""
        return self._at if self._at in self._places else None

    def close(self) -> None:
        """End the workers."""
        self._search.close()
        self._cells.close()

    def step(self, by: int) -> None:
        """Go on by some places, 1 or -1; where they are not known yet, as soon as they are."""
        if self._document.answer is None:
            return
        if self._found is None:
            self._owed_step = by
            self._panel.show_busy()
            self._look()
        elif self._places:
            self._number = self._next_number(by)
            self._go()
        else:
            self._say_how_many()

    def select(self) -> None:
        """Select the pillars of the place that is shown."""
        if (
            self._found is not None
            and self.place is not None
            and self._selection.result is self._found.result
        ):
            mask = np.zeros(len(self._found.result.field), bool)
            mask[self.place.pillars] = True
            self._selection.set(mask)

    # --- Looking --------------------------------------------------------------------------------------------

    @property
    def _is_wanted(self) -> bool:
        return bool(self._box.kinds or self._owed_step or self._panel.isVisible())

    def _follow(self, answer: Answer | None) -> None:
        self._found = None
        if answer is None:
            self._at, self._number, self._owed_step = None, 0, 0
            self._search.cancel()
            self._quiet.stop()
            self._marks.set_cells(None)
            self._panel.clear()
        else:
            self._want()

    def _want(self) -> None:
        """Look after a moment of quiet, unless what is there is of the newest result."""
        answer = self._document.answer
        if answer is not None and self._found is None and self._is_wanted:
            self._panel.show_busy()
            self._quiet.start()

    def _look(self) -> None:
        answer = self._document.answer
        if answer is None or answer.request.quick or self._document.held or self._found is not None:
            return
        if self._search.running is not answer.result:
            self._search.ask(answer.result)

    def _take_found(self, result: Reconstruction, found: Found) -> None:
        answer = self._document.answer
        if answer is None or answer.result is not result:
            return
        self._found = found
        self._mark()
        if self._owed_step:
            by, self._owed_step = self._owed_step, 0
            self.step(by)
        else:
            self._stay()

    # --- Marking --------------------------------------------------------------------------------------------

    def _choose(self, kinds: tuple[str, ...]) -> None:
        self._at, self._number = None, 0
        self._want()
        self._mark()
        self._say_how_many()

    def _mark(self) -> None:
        """Mark what is known; marks of an older result stay until the newer ones are there."""
        if not self._box.kinds:
            self._cells.cancel()
            self._marks.set_cells(None)
        elif self._found is not None:
            self._cells.ask(_MarkWish(self._found, self._box.kinds, self._map.layer))

    def _show_cells(self, wish: _MarkWish, made: Cells) -> None:
        if self._box.kinds:
            self._marks.set_cells(made)

    # --- Going from one to the next -------------------------------------------------------------------------

    @property
    def _places(self) -> tuple[Place, ...]:
        if self._found is None:
            return ()
        kinds = self._box.kinds or KINDS
        return tuple(place for place in self._found.suspects.places if place.kind in kinds)

    def _next_number(self, by: int) -> int:
        """Go on from the place that was shown; where it is mended, what took its number is the next one."""
        places = self._places
        if self._at is None:
            return 0 if by > 0 else len(places) - 1
        still = [number for number, place in enumerate(places) if self._is_shown(place)]
        if not still:
            return min(self._number, len(places) - 1)
        return (still[0] + by) % len(places)

    def _go(self) -> None:
        assert self._found is not None
        self._at = place = self._places[self._number]
        self._say_place(place)
        self._lead.go_to(place, self._found.result)
        self.told.emit(place.sentence)

    def _stay(self) -> None:
        """Go on showing the same place of another result, if it is still there."""
        numbers = [number for number, place in enumerate(self._places) if self._is_shown(place)]
        if not numbers or self._found is None:
            self._say_how_many()
            return
        self._number = numbers[0]
        self._at = self._places[self._number]
        self._say_place(self._at)
        self._lead.point_out(self._at, self._found.result)

    def _is_shown(self, place: Place) -> bool:
        at = self._at
        return at is not None and at.kind == place.kind and at.box == place.box

    def _say_place(self, place: Place) -> None:
        self._panel.show_place(self._number + 1, len(self._places), self._found_count(), place.sentence)

    def _say_how_many(self) -> None:
        if self._found is not None:
            self._panel.show_count(len(self._places), self._found_count())

    def _found_count(self) -> int:
        assert self._found is not None
        return sum(self._found.suspects.found[kind] for kind in self._box.kinds or KINDS)


def _found(result: Reconstruction, progress: Progress) -> Found:
    return Found(result, suspects(result, progress))


def _marked(wish: _MarkWish, progress: Progress) -> Cells:
    return cells(wish.found.result, wish.found.suspects.masks, wish.kinds, wish.layer)
