"""The method on a thread of its own, quick while a hand moves and exact once it rests.

What depends on sorted points only (tolerance, alpha, layering, moves) is quick by itself and exact at once.
What needs a large scan sorted anew (cell size, cleaning) is made from fewer points first, and where layering
by surface would take long, layers are made by elevation first; when the hand has stopped, the exact result
follows.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from PySide6.QtCore import QObject, Signal

from stepfield.errors import ParameterError
from stepfield.pipeline import Pipeline
from stepfield.progress import Progress
from stepfield_app.facts import ScanFacts, facts_of
from stepfield_app.newest import NewestWins
from stepfield_app.requests import Answer, Request

#: Points of a preview.
PREVIEW_POINTS = 350_000
#: Scans up to this size are always made exactly: that takes no longer than a blink.
SMALL_SCAN = 1_000_000
#: Up to so much labour layers are always made as wished: no longer than a quarter of a second.
LITTLE_LABOUR = 150_000
#: A seam takes as long to find as so many pillars take that need none.
SEAM_LABOUR = 100
#: Seconds between two answers: as many as the window can show beside following the hand.
PACE = 0.1


@dataclass(frozen=True)
class Outcome:
    """An answer, and the facts of the scan it was made from."""

    answer: Answer
    facts: ScanFacts

    @cached_property
    def labour(self) -> int:
        """What its layering takes by surface, counted in pillars that need no seam."""
        result = self.answer.result
        pillars = len(result.field)
        if pillars > LITTLE_LABOUR or not is_by_surface(self.answer.request):
            return pillars
        return pillars + SEAM_LABOUR * len(result.seams)


class _Work:
    """What the worker remembers between requests; only its thread touches it."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Give the memory of the last scan back."""
        self._scans: Any = None
        self._pipeline = Pipeline()
        self._facts: ScanFacts | None = None
        self._sorted: Any = None  # foundation of the points that are sorted, all of them
        self._labour = 0  # of the last exact result: a hand sees one way of layering until it rests

    def __call__(self, request: Request, progress: Progress) -> Outcome:
        """Run the method; a scan that cannot be opened leaves the stages of the present one as they are."""
        start = time.perf_counter()
        is_new = request.scans != self._scans
        pipeline = Pipeline() if is_new else self._pipeline
        is_sorted = not is_new and foundation(request) == self._sorted
        hasty = request.quick and not is_new and self._labour > LITTLE_LABOUR and is_by_surface(request)
        result = pipeline.run(
            request.scans,
            request.parameters.model_copy(update={"layering": "elevation"}) if hasty else request.parameters,
            request.moves,
            request.styles,
            progress,
            most_points=PREVIEW_POINTS if request.quick and not is_sorted else None,
        )
        self._scans, self._pipeline = request.scans, pipeline
        if self._facts is None or self._facts.scan is not pipeline.raw:
            self._facts = facts_of(pipeline.raw)
        # A preview of a scan that has no more points than that is exact.
        is_thinned = len(result.field.compartments.ticks) < len(result.scan)
        if not is_thinned:
            self._sorted = foundation(request)
        quick = is_thinned or hasty
        answer = Answer(replace(request, quick=quick), result, time.perf_counter() - start)
        answer.summaries()  # found here, so that the window need not wait for them
        outcome = Outcome(answer, self._facts)
        if not quick:
            self._labour = outcome.labour
        return outcome


class Runner(QObject):
    """Turns requests into answers, the newest first.

    Parameters
    ----------
    parent : QObject, optional
    threaded : bool
        False answers within ``ask``.
    """

    answered = Signal(object, object)  # Answer, ScanFacts
    failed = Signal(object, object)  # request, exception
    progressed = Signal(float, str)
    busy_changed = Signal(bool)

    def __init__(self, parent: QObject | None = None, *, threaded: bool = True) -> None:
        super().__init__(parent)
        self._newest: Request | None = None
        self._settled = True
        self._previewed: Request | None = None  # whose preview has arrived
        self._sorted: Any = None  # foundation of the points that are sorted, all of them
        self._points = self._labour = 0  # of the last result, and of the last exact one
        self._layered: Any = None  # what the layers depended on that are there, exactly
        pace = PACE if threaded else 0.0
        self._worker = NewestWins[Request, Outcome](_Work(), "runner", self, pace=pace, threaded=threaded)
        self._worker.answered.connect(self._receive)
        self._worker.failed.connect(self._fail)
        self._worker.progressed.connect(self.progressed)
        self._worker.busy_changed.connect(self.busy_changed)

    @property
    def busy(self) -> bool:
        """Whether anything runs."""
        return self._worker.busy

    def ask(self, request: Request, *, settled: bool = True) -> None:
        """Ask for the answer to a request.

        Parameters
        ----------
        request : Request
            With ``quick`` False; whether a preview comes first is decided here.
        settled : bool
            False while a hand still moves: then a preview is all there will be.
        """
        self._newest, self._settled = request, settled
        if self._makes_worthless(request):
            self._stop()
        self._send(replace(request, quick=self._is_costly(request)))

    def settle(self) -> None:
        """Say that the hand has stopped: the exact answer follows the preview.

        A preview of what the hand has left behind is not waited for: nobody would see it.
        """
        self._settled = True
        if self._previewed is not None and self._previewed == self._newest:
            self._send(self._previewed, at_once=True)
        elif self._newest is not None and self._is_behind():
            self._stop()
            self._send(replace(self._newest, quick=True), at_once=True)

    def cancel(self) -> None:
        """Stop; the last request gets no answer."""
        self._newest = self._previewed = None
        self._stop()

    def forget(self) -> None:
        """Stop, and give the memory of the last scan back."""
        self.cancel()
        self._sorted = self._layered = None
        self._points = self._labour = 0
        self._worker.forget()

    def close(self) -> None:
        """Stop, and wait until the thread has ended."""
        self._newest = self._previewed = None
        self._worker.close()

    def _send(self, request: Request, *, at_once: bool = False) -> None:
        self._previewed = None
        self._worker.ask(request, at_once=at_once)

    def _stop(self) -> None:
        if self._worker.running is not None:
            self._forget(self._worker.running)
        self._worker.cancel()

    def _forget(self, unfinished: Request) -> None:
        """An exact run that came to no end has left nothing sorted."""
        if not unfinished.quick and self._scan_is_that_of(unfinished):
            self._sorted = None

    def _scan_is_that_of(self, request: Request) -> bool:
        return self._sorted is not None and self._sorted[0] == request.scans

    def _is_costly(self, request: Request) -> bool:
        """Whether all points of a large scan would have to be sorted anew, or layers take long."""
        running, wanted = self._worker.running, foundation(request)
        if wanted == self._sorted or (running and not running.quick and foundation(running) == wanted):
            takes_long = self._labour > LITTLE_LABOUR and is_by_surface(request)
            return takes_long and layers_depend_on(request) != self._layered
        return self._points > SMALL_SCAN or not self._scan_is_that_of(request)

    def _makes_worthless(self, request: Request) -> bool:
        """Whether nobody will want the answer that is being made once ``request`` is asked."""
        running = self._worker.running
        if running is None or foundation(running) == foundation(request):
            return False
        return running.scans != request.scans or (not running.quick and self._points > SMALL_SCAN)

    def _is_behind(self) -> bool:
        """Whether a preview still waits, be it for its turn or for one of something else."""
        running, waiting = self._worker.running, self._worker.waiting
        return waiting is not None and waiting.quick and (running is None or running.quick)

    def _receive(self, request: Request, outcome: Outcome) -> None:
        answer, self._points = outcome.answer, len(outcome.answer.result.scan)
        if not answer.request.quick:
            self._labour = outcome.labour
            self._sorted, self._layered = foundation(request), layers_depend_on(request)
        self.answered.emit(answer, outcome.facts)
        if answer.request.quick:
            self._follow(replace(request, quick=False))

    def _follow(self, request: Request) -> None:
        """Let the exact answer follow a preview, now or once the hand has stopped."""
        if request != self._newest:
            return
        self._previewed = request
        if self._settled:
            self._send(request, at_once=True)

    def _fail(self, request: Request, error: BaseException) -> None:
        self._forget(request)
        asked = replace(request, quick=False)
        if request.quick and isinstance(error, ParameterError):
            self._follow(asked)  # what asks too much of fewer points may be right for all of them
        else:
            self.failed.emit(asked, error)


def foundation(request: Request) -> tuple[Any, ...]:
    """Return what the sorting of points depends on: requests that share it are cheap one after another."""
    chosen = request.parameters
    cleaning = (chosen.unit, chosen.up, chosen.crop, chosen.classes, chosen.outliers)
    return request.scans, chosen.cell_size, *cleaning


def is_by_surface(request: Request) -> bool:
    """Whether a request wants the layering that takes long where pillars are many."""
    return request.parameters.layering == "surface"


def layers_depend_on(request: Request) -> tuple[Any, ...]:
    """Return what the layering depends on, moves apart: requests that share it need no other."""
    chosen = request.parameters
    pillars = chosen.layer_tolerance, chosen.pillar_height, chosen.walls
    layers = chosen.layering, chosen.min_points, chosen.max_layers, chosen.link_step
    return foundation(request), pillars, layers
