"""The selection: which pillars the next edit is about. It follows the document through every new result.

Whatever looks at pillars happens on a worker. What has been asked for and not yet been answered is kept as
steps, so that a newer wish, or a newer result, takes the place of one under way without losing what it meant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from PySide6.QtCore import QObject, Signal

from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield.selecting import Mask, Reach, carried, grown, inverted, nothing, of_layer, shrunk
from stepfield_app.document import Document
from stepfield_app.newest import NewestWins
from stepfield_app.requests import Answer
from stepfield_app.scenes.arrays import frozen
from stepfield_app.scenes.picking import Pick, picked
from stepfield_app.scenes.selected import Selected

Change = Callable[[Reconstruction, Mask], Mask]
How = Literal["replace", "add", "subtract"]
ReachKind = Literal["layer", "range", "everything"]


@dataclass(frozen=True, eq=False)
class _Step:
    """Something the operator did to the selection; a later one of the same gesture takes its place."""

    change: Change
    gesture: object | None = None


@dataclass(frozen=True, eq=False)
class _Wish:
    """Steps to take from a selection, which may be of an older result."""

    start: Selected
    result: Reconstruction
    steps: tuple[_Step, ...]


class Selection(QObject):
    """Which pillars are selected, and what the tools may take hold of.

    The mask belongs to ``result``, which is older than the document's answer until a worker has carried the
    selection over: whoever uses them together takes both from here.

    Parameters
    ----------
    document : Document
    parent : QObject, optional
    threaded : bool
        False answers every call at once: for tests of what stands around it.
    """

    changed = Signal()
    reach_changed = Signal()
    busy_changed = Signal(bool)
    failed = Signal(object)  # exception

    def __init__(self, document: Document, parent: QObject | None = None, *, threaded: bool = True) -> None:
        super().__init__(parent)
        self._document = document
        self._shown: Selected | None = None
        self._start: Selected | None = None  # what the steps begin with
        self._steps: list[_Step] = []
        self._reach_kind: ReachKind = "layer"
        self._z_range: tuple[float, float] | None = None
        self._worker = NewestWins[_Wish, Selected](_selected, "selection", self, threaded=threaded)
        self._worker.answered.connect(self._show)
        self._worker.failed.connect(self._fail)
        self._worker.busy_changed.connect(self.busy_changed)
        document.answer_changed.connect(self._follow)
        document.opened.connect(self._start_afresh)
        document.active_layer_changed.connect(self._follow_active_layer)
        self._follow(document.answer)

    @property
    def mask(self) -> Mask | None:
        """Which pillars of ``result`` are selected, shape (P,), read-only; None without a scan."""
        return self._shown.mask if self._shown else None

    @property
    def result(self) -> Reconstruction | None:
        """What the mask belongs to."""
        return self._shown.result if self._shown else None

    @property
    def count(self) -> int:
        """How many pillars are selected."""
        return self._shown.count if self._shown else 0

    @property
    def by_layer(self) -> dict[int, int]:
        """How many are selected of each layer that has any, -1 for Unassigned."""
        return dict(self._shown.by_layer) if self._shown else {}

    @property
    def busy(self) -> bool:
        """Whether a worker is still at it."""
        return self._worker.busy

    @property
    def reach_kind(self) -> ReachKind:
        """Whether the tools reach the active layer, a range of elevations or everything."""
        return self._reach_kind

    @property
    def z_range(self) -> tuple[float, float]:
        """The range of elevations, scan coordinates, metres: all of the scan until somebody sets another."""
        if self._z_range is not None or self._document.answer is None:
            return self._z_range or (0.0, 0.0)
        return self._document.answer.result.scan.z.bounds()

    @property
    def reach(self) -> Reach:
        """What the tools take hold of now."""
        if self._reach_kind == "layer":
            return Reach(layer=self._document.active_layer)
        return Reach(None, *self.z_range) if self._reach_kind == "range" else Reach()

    def set_reach(self, kind: ReachKind, low: float | None = None, high: float | None = None) -> None:
        """Say what the tools take hold of from now on; ends of the range that are not given stay."""
        before, (bottom, top) = (self._reach_kind, self._z_range), self.z_range
        self._reach_kind = kind
        if low is not None or high is not None:
            bottom, top = (bottom if low is None else low), (top if high is None else high)
            self._z_range = min(bottom, top), max(bottom, top)
        if before != (self._reach_kind, self._z_range):
            self.reach_changed.emit()

    def pick(self, pick: Pick, how: How = "replace", gesture: object | None = None) -> None:
        """Select what a shape takes within reach.

        Parameters
        ----------
        pick : InView, OnMap or InSection
        how : str
            Whether that replaces the selection, is added to it or taken from it.
        gesture : object, optional
            Picks in a row with the same one all begin with the selection as it was before the first.
        """
        reach = self.reach

        def change(result: Reconstruction, mask: Mask) -> Mask:
            taken = picked(result, pick, reach)
            if how == "replace":
                return taken
            return mask | taken if how == "add" else mask & ~taken

        self._do(change, gesture)

    def take_back(self, gesture: object) -> None:
        """Go back to what was selected before the first pick of a gesture, if that is the last one."""
        if self._steps and self._steps[-1].gesture is gesture:
            self._steps.pop()
            self._ask()

    def clear(self) -> None:
        """Select nothing, at once."""
        self._worker.cancel()
        self._show_nothing()

    def invert(self) -> None:
        """Select what is not selected within reach, and the reverse; beyond it nothing changes."""
        reach = self.reach
        self._do(lambda result, mask: inverted(result, mask, reach))

    def grow(self) -> None:
        """Add the pillars within reach that continue selected ones."""
        reach = self.reach
        self._do(lambda result, mask: grown(result, mask, reach))

    def shrink(self) -> None:
        """Leave out the pillars that are not surrounded by selected ones."""
        self._do(shrunk)

    def all_of(self, layer: int) -> None:
        """Select all pillars of a layer, -1 for those in none, and nothing else."""
        self._do(lambda result, mask: of_layer(result, layer))

    def set(self, mask: Mask, of: Reconstruction | None = None) -> None:
        """Select pillars by a mask of shape (P,) over a result, by default the one the selection is of."""
        result, mask = of or self.result, frozen(np.array(mask, bool))
        if result is not None:
            self._do(lambda newest, _: carried(result, newest, mask))

    def close(self) -> None:
        """End the worker."""
        self._worker.close()

    def _do(self, change: Change, gesture: object | None = None) -> None:
        """Take a step from what is selected, and from what is still being made of it."""
        again = gesture is not None and self._steps and self._steps[-1].gesture is gesture
        if again:
            self._steps.pop()
        elif not self._worker.busy:
            self._settle()
        self._steps.append(_Step(change, gesture))
        self._ask()

    def _settle(self) -> None:
        """Let the steps begin anew with what is shown."""
        self._start, self._steps = self._shown, []

    def _ask(self) -> None:
        answer = self._document.answer
        if answer is not None and self._start is not None:
            self._worker.ask(_Wish(self._start, answer.result, tuple(self._steps)))

    def _show(self, wish: _Wish, selected: Selected) -> None:
        self._shown = selected
        left = [step for step in self._steps if step not in wish.steps]
        last = wish.steps[-1] if wish.steps else None
        # The last step of a gesture may yet be replaced, or has been: what it began with is still needed.
        if last is None or last.gesture is None or (left and last in self._steps):
            self._start, self._steps = selected, left
        self.changed.emit()

    def _show_nothing(self) -> None:
        answer = self._document.answer
        self._shown = Selected.of(answer.result, nothing(answer.result)) if answer else None
        self._settle()
        self.changed.emit()

    def _follow(self, answer: Answer | None) -> None:
        """Carry the selection over to another answer."""
        has_other_range = self._z_range is None and answer is not None and not self._is_of(answer)
        if not self._worker.busy:
            self._settle()
        if answer is None or self._start is None or (self._start.is_empty and not self._steps):
            self.clear()
        else:
            self._ask()
        if has_other_range:
            self.reach_changed.emit()

    def _is_of(self, answer: Answer) -> bool:
        """Whether the selection is of the same points as an answer."""
        return self._shown is not None and self._shown.result.scan is answer.result.scan

    def _start_afresh(self) -> None:
        """Forget what was selected in another scan."""
        self._z_range = None
        self.clear()
        self.reach_changed.emit()

    def _follow_active_layer(self) -> None:
        if self._reach_kind == "layer":
            self.reach_changed.emit()

    def _fail(self, wish: _Wish, error: Exception) -> None:
        """Stay with what is shown."""
        self._settle()
        self.failed.emit(error)


def _selected(wish: _Wish, progress: Progress) -> Selected:
    """Take the steps of a wish; the body of the worker."""
    selected = wish.start.over(wish.result)
    mask = selected.mask
    for number, step in enumerate(wish.steps):
        progress(number / len(wish.steps), "selecting")
        mask = step.change(wish.result, mask)
    return Selected.of(wish.result, mask) if wish.steps else selected
