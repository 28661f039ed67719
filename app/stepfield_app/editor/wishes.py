"""Wishes, worked out one after the other on a worker, each once what it speaks of is on the screen."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield_app.document import Document
from stepfield_app.editor.situation import Situation
from stepfield_app.newest import NewestWins

if TYPE_CHECKING:
    from stepfield_app.selection import Selection

NOTHING_SELECTED = "Nothing is selected: choose pillars with a selection tool first"
CHANGED_MEANWHILE = "The layers have changed meanwhile: look again, then repeat it"
NO_RESULT = "The newest parameters have no result: undo them first"


@dataclass(frozen=True, eq=False)
class Wish:
    """Something to work out from the situation, and what to do with it then.

    Attributes
    ----------
    work : callable
        Makes something of a Situation, on the worker.
    then : callable
        Takes what was made, on the window's thread.
    layers : tuple of int
        Those it speaks of: they must be the same when its turn comes.
    of_selection : bool
        Whether there must be a selection.
    """

    work: Callable[[Situation], Any]
    then: Callable[[Any], object]
    layers: tuple[int, ...] = ()
    of_selection: bool = False


@dataclass(frozen=True, eq=False)
class _Turn:
    """A wish and what the operator looked at."""

    wish: Wish
    shown: Reconstruction


class Wishes(QObject):
    """A queue of wishes.

    Parameters
    ----------
    document : Document
    selection : Selection
    look : callable
        Returns the present Situation, or None while there is none.
    parent : QObject
    """

    refused = Signal(str)  # why a wish cannot be fulfilled

    def __init__(
        self,
        document: Document,
        selection: Selection,
        look: Callable[[], Situation | None],
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._document, self._selection, self._look = document, selection, look
        self._turns: deque[_Turn] = deque()
        self._worker = NewestWins[tuple[_Turn, Situation], Any](_worked_out, "edits", self)
        self._worker.answered.connect(self._take)
        self._worker.failed.connect(lambda _, error: self._fail(error))
        selection.busy_changed.connect(lambda _: self._go_on())
        selection.changed.connect(self._go_on)
        document.pending_changed.connect(lambda _: self._go_on())
        document.answer_changed.connect(lambda _: self._go_on())
        document.opening_changed.connect(lambda _: self._turns.clear())
        document.failed.connect(lambda _: self._turns.clear())

    @property
    def is_idle(self) -> bool:
        """Whether every wish has been fulfilled or refused."""
        return not self._turns and not self._worker.busy

    def want(self, wish: Wish) -> None:
        """Fulfil a wish as soon as possible, after those before it."""
        answer = self._document.answer
        if answer is None:
            return
        if self._document.pending and not self._document.busy:
            self.refused.emit(NO_RESULT)
            return
        self._document.edit_wished.emit()
        self._turns.append(_Turn(wish, answer.result))
        self._go_on()

    def close(self) -> None:
        """Forget what waits, and end the worker."""
        self._turns.clear()
        self._worker.close()

    def _go_on(self) -> None:
        """Let the next wish have its turn, unless one has it or what is shown is not the newest."""
        situation = self._look()
        if situation is None:
            self._turns.clear()
        if situation is None or not self._turns or self._worker.busy or self._document.pending:
            return
        turn = self._turns[0]
        if turn.wish.of_selection and not self._is_selected(situation.result):
            return
        if not _are_the_same(turn, situation.result):
            self._refuse(CHANGED_MEANWHILE)
        elif turn.wish.of_selection and not self._selection.count:
            self._refuse(NOTHING_SELECTED)
        else:
            self._worker.ask((self._turns.popleft(), situation))

    def _is_selected(self, shown: Reconstruction) -> bool:
        """Whether it is known what is selected in the result that is shown."""
        selection = self._selection
        return not selection.busy and (selection.result is shown or not selection.count)

    def _shown(self) -> Reconstruction | None:
        answer = self._document.answer
        return None if answer is None else answer.result

    def _refuse(self, reason: str) -> None:
        self._turns.popleft()
        self.refused.emit(reason)
        self._go_on()

    def _take(self, asked: tuple[_Turn, Situation], made: Any) -> None:
        """Do what a wish was for; let it wait again if the layers have changed while it was worked out."""
        turn, situation = asked
        if self._document.pending or self._shown() is not situation.result:
            self._turns.appendleft(turn)
        else:
            turn.wish.then(made)
        self._go_on()

    def _fail(self, error: object) -> None:
        self._document.failed.emit(error)
        self._go_on()


def _worked_out(asked: tuple[_Turn, Situation], progress: Progress) -> Any:
    turn, situation = asked
    return turn.wish.work(situation)


def _are_the_same(turn: _Turn, now: Reconstruction) -> bool:
    """Whether the layers a wish speaks of are those that were shown when it was uttered."""
    before = turn.shown
    if now is before or not turn.wish.layers:
        return True
    return len(now.layers) == len(before.layers) and all(
        now.layers[layer].name == before.layers[layer].name for layer in turn.wish.layers
    )
