"""What moving the selection would do, planned ahead for every target."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from PySide6.QtCore import QObject, QTimer, Signal

from stepfield.layers import UNASSIGNED
from stepfield.moving import Plan
from stepfield.progress import Progress
from stepfield_app.editor.situation import Situation
from stepfield_app.newest import NewestWins

#: Milliseconds of quiet after which plans are made: a brush changes the selection all the time.
QUIET = 120


@dataclass(frozen=True, eq=False)
class _Planning:
    """A situation and the plans made for it so far; the worker adds one after the other."""

    situation: Situation
    plans: dict[int | str, Plan] = field(default_factory=dict)


class Previews(QObject):
    """Plans of the present situation, once they are made.

    Parameters
    ----------
    look : callable
        Returns the present Situation, or None while nothing is selected.
    parent : QObject
    """

    changed = Signal()
    failed = Signal(object)  # exception

    def __init__(self, look: Callable[[], Situation | None], parent: QObject) -> None:
        super().__init__(parent)
        self._look = look
        self._planning: _Planning | None = None
        self._worker = NewestWins[_Planning, None](_plan_all_moves, "move previews", self)
        self._worker.progressed.connect(self.changed)
        self._worker.answered.connect(self.changed)
        self._worker.failed.connect(lambda _, error: self.failed.emit(error))
        self._quiet = QTimer(self, singleShot=True, interval=QUIET)
        self._quiet.timeout.connect(self.make)

    def of(self, target: int | str) -> Plan | None:
        """Plan for a target, None until it is made; any text stands for a new layer."""
        now = self._look()
        if now is None:
            return None
        planning = self._planning
        if planning is None or not now.is_as(planning.situation):
            return None
        return planning.plans.get(target if isinstance(target, int) else now.new_name)

    def make_soon(self) -> None:
        """Make plans once the selection rests."""
        self._quiet.start()

    def make(self) -> None:
        """Make plans now, unless they are made or on their way."""
        self._quiet.stop()
        now, planning = self._look(), self._planning
        if now is None and planning is not None:
            self._worker.cancel()
            self._planning = None
            self.changed.emit()
        elif now is not None and (planning is None or not now.is_as(planning.situation)):
            self._planning = _Planning(now)
            self._worker.ask(self._planning)
            self.changed.emit()

    def close(self) -> None:
        """End the worker."""
        self._quiet.stop()
        self._worker.close()


def _plan_all_moves(planning: _Planning, progress: Progress) -> None:
    """Plan the selection's move to every target."""
    situation, plans = planning.situation, planning.plans
    layers = range(len(situation.result.layers))
    for target in (*layers, UNASSIGNED, situation.new_name):
        plans[target] = situation.forecast(target)
        progress(len(plans) / (len(layers) + 2), "planning moves")
