"""Finds out how true a result is: at once from an even draw of its points, from all or very many at rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from PySide6.QtCore import QObject, QTimer, Signal

from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield_app.document import Document
from stepfield_app.feeds.courtesy import Courtesy, at_once
from stepfield_app.newest import NewestWins
from stepfield_app.panels.fidelity import FidelityPanel
from stepfield_app.requests import Answer
from stepfield_app.scenes.complex_parts import Meshed
from stepfield_app.scenes.fidelity import FidelityFacts, fidelity_facts

#: Points compared while a hand moves, and of larger scans before all are.
DRAWN = 30_000
#: Scans up to this size are compared whole at rest, without a draw first.
FEW = 250_000
#: Points compared at rest at most: more would keep the processors from the views for tens of seconds.
MOST = 2_000_000
#: Results of more pillars, and previews, wait until the hand rests: figures would keep the views waiting.
FOLLOWED = 150_000
#: Milliseconds of quiet before all points of a larger scan are compared: the views come first.
QUIET = 700
#: Milliseconds more for every million points: there is more to be drawn, and who edits is not to wait.
QUIET_A_MILLION = 1500
#: Milliseconds by which the pictures of a result go before its first figures at least.
COURTESY = 250
#: Seconds between two comparisons: the views of a moving hand come first.
PACE = 0.3


@dataclass(frozen=True, eq=False)
class _Wish:
    """A result, and how many of its points to compare at most; None for all."""

    result: Reconstruction
    most: int | None
    meshed: Meshed | None = None

    @property
    def is_long(self) -> bool:
        """Whether more than a draw is compared."""
        return self.most is None or self.most > DRAWN


class FidelityFeed(QObject):
    """Keeps the fidelity panel, and whoever else wants to know, true to the document.

    Parameters
    ----------
    document : Document
    panel : FidelityPanel
    is_drawn : callable
        Whether the views show the newest result in full: they go first.
    """

    failed = Signal(object)  # exception
    #: FidelityFacts, or None once there is no result.
    changed = Signal(object)

    def __init__(
        self, document: Document, panel: FidelityPanel, is_drawn: Callable[[], bool] = at_once
    ) -> None:
        super().__init__(document)
        self._document, self._panel = document, panel
        self._facts: FidelityFacts | None = None
        self._meshed: Meshed | None = None
        self._worker = NewestWins[_Wish, FidelityFacts](_found, "fidelity", self, pace=PACE)
        self._worker.answered.connect(lambda _, facts: self._take(facts))
        self._worker.failed.connect(lambda _, error: self.failed.emit(error))
        self._quiet = QTimer(self, singleShot=True, interval=QUIET)
        self._quiet.timeout.connect(self._compare_all)
        self._courtesy = Courtesy(COURTESY, is_drawn, self)
        self._courtesy.passed.connect(self._begin)
        document.answer_changed.connect(self._follow)
        document.held_changed.connect(self._rest)
        document.pending_changed.connect(self._give_way)
        document.edit_wished.connect(self._make_room)

    @property
    def is_idle(self) -> bool:
        """Whether the newest result's figures are shown, be they of an even draw of a large scan's points."""
        is_busy = self._worker.busy or self._courtesy.is_active
        return self._document.answer is None or self._is_newest or not is_busy

    def close(self) -> None:
        """End the worker."""
        self._quiet.stop()
        self._courtesy.stop()
        self._worker.close()

    def set_meshed(self, meshed: Meshed | None) -> None:
        """Count in the mesh of complex parts, or leave it out again."""
        self._meshed = meshed
        answer = self._document.answer
        if answer is not None and not self._is_newest:
            self._follow(answer)

    @property
    def _is_newest(self) -> bool:
        answer, facts = self._document.answer, self._facts
        if facts is None or answer is None or facts.result is not answer.result:
            return False
        return facts.meshed is self._mesh_of(answer.result)

    def _mesh_of(self, result: Reconstruction) -> Meshed | None:
        return self._meshed if self._meshed is not None and self._meshed.belongs_to(result) else None

    def _follow(self, answer: Answer | None) -> None:
        self._quiet.stop()
        self._courtesy.stop()
        if answer is None:
            self._facts = None
            self._worker.cancel()
            self._panel.set_facts(None)
            self.changed.emit(None)
            return
        running = self._worker.running
        if running is not None and running.is_long:
            self._worker.cancel()  # it would take too long
        if not self._document.held:
            self._courtesy.start()
        elif len(answer.result.field) <= FOLLOWED and not answer.request.quick:
            self._begin()
        self._mark()

    def _rest(self, is_held: bool) -> None:
        """Compare what was passed over while a hand moved, or all points of what was not."""
        answer = self._document.answer
        if is_held or answer is None or self._is_newest or self._document.pending:
            self._settle()
        else:
            self._follow(answer)

    def _begin(self) -> None:
        answer = self._document.answer
        assert answer is not None
        is_small = len(answer.result.scan) <= FEW and not self._document.held
        self._ask(answer.result, None if is_small else DRAWN)

    def _give_way(self, is_pending: bool) -> None:
        """Stop a long comparison as soon as another result is wanted; go on if none comes."""
        running = self._worker.running
        if is_pending and running is not None and running.is_long:
            self._worker.cancel()
        elif not is_pending and self._document.answer is not None and self.is_idle and not self._is_newest:
            self._follow(self._document.answer)  # what was stopped begins again
        elif not is_pending:
            self._settle()
        self._mark()

    def _make_room(self) -> None:
        """Put a long comparison off while an edit is worked out, even if nothing comes of it."""
        running = self._worker.running
        if running is not None and running.is_long and self._is_newest:
            self._worker.cancel()
            self._settle()

    def _take(self, facts: FidelityFacts) -> None:
        """Show figures; while a hand moves also those of a result that is no longer the newest."""
        self._facts = facts
        self._panel.set_facts(facts)
        self._mark()
        self.changed.emit(facts)
        self._settle()

    def _settle(self) -> None:
        """Compare all points after a moment of quiet, once no newer result is on its way."""
        if not self._document.held and self._is_newest and self._is_drawn:
            points = min(self._facts.comparison.fidelity.of, MOST) if self._facts else 0
            more = points * QUIET_A_MILLION // 1_000_000
            self._quiet.start(QUIET + more)

    def _compare_all(self) -> None:
        answer = self._document.answer
        busy = self._document.held or self._document.pending or self._worker.busy
        if (
            answer is not None
            and not answer.request.quick
            and not busy
            and self._is_newest
            and self._is_drawn
        ):
            self._ask(answer.result, MOST if len(answer.result.scan) > MOST else None)

    def _ask(self, result: Reconstruction, most: int | None) -> None:
        self._worker.ask(_Wish(result, most, self._mesh_of(result)))

    @property
    def _is_drawn(self) -> bool:
        """Whether more points are to be compared; an even draw may have half as many as wished."""
        if self._facts is None:
            return False
        fidelity = self._facts.comparison.fidelity
        return fidelity.is_drawn and (fidelity.of <= MOST or fidelity.points < MOST // 2)

    def _mark(self) -> None:
        self._panel.set_pending(self._document.pending or not self._is_newest)


def _found(wish: _Wish, progress: Progress) -> FidelityFacts:
    return fidelity_facts(wish.result, wish.most, progress, wish.meshed)
