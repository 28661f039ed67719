"""The edits of a project as a list model: what each was for, and what became of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from PySide6.QtCore import (
    QAbstractItemModel,
    QAbstractListModel,
    QModelIndex,
    QPersistentModelIndex,
    QSortFilterProxyModel,
    Qt,
)

from stepfield.moves import Outcome
from stepfield.project import Move
from stepfield_app.wording import counted, grouped

AnyIndex = QModelIndex | QPersistentModelIndex

UNNAMED = "Move pillars"
WORKING = "not applied yet"
NOTHING = "changes no pillar"


class MoveRole(IntEnum):
    """What a row is asked for beyond Qt's own roles."""

    ROW = Qt.ItemDataRole.UserRole + 10


@dataclass(frozen=True)
class MoveRow:
    """An edit as it is painted; without an outcome while the result is being made."""

    text: str
    outcome: Outcome | None

    @property
    def account(self) -> str:
        """What became of it."""
        return WORKING if self.outcome is None else told(self.outcome)

    @property
    def fits(self) -> bool:
        """Whether it found its pillars and its layer, as far as is known."""
        return self.outcome is None or self.outcome.resolved


def told(outcome: Outcome) -> str:
    """Say what became of an edit."""
    if outcome.reason:
        return f"{outcome.reason[:1].upper()}{outcome.reason[1:]}"
    parts = (
        (outcome.moved, "moved"),
        (outcome.swapped, "swapped"),
        (outcome.left, "left"),
        (outcome.unassigned, "to Unassigned"),
    )
    first, *others = [(number, what) for number, what in parts if number] or [(0, "")]
    if not first[1]:
        return NOTHING
    more = "".join(f", {grouped(number)} {what}" for number, what in others)
    return f"{counted(first[0], 'pillar')} {first[1]}{more}"


class MovesModel(QAbstractListModel):
    """Rows of edits, the oldest first; tells only of those that changed."""

    def __init__(self, parent: Any = None) -> None:
        super().__init__(parent)
        self._moves: tuple[Move, ...] = ()
        self._outcomes: tuple[Outcome, ...] = ()
        self._told: int = 0  # rows from here on have no outcome yet

    @property
    def moves(self) -> tuple[Move, ...]:
        """The edits."""
        return self._moves

    @property
    def misfits(self) -> int:
        """How many no longer fit."""
        return sum(not outcome.resolved for outcome in self._outcomes[: self._told])

    def outcome(self, at: int) -> Outcome | None:
        """What became of an edit, None while that is not known."""
        return self._outcomes[at] if at < self._told else None

    def set_moves(self, moves: tuple[Move, ...]) -> None:
        """Take other edits; what they have in common with the present ones at the beginning stays."""
        kept = _common(self._moves, moves)
        self._told = min(self._told, kept)
        if kept < len(self._moves):
            self.beginRemoveRows(QModelIndex(), kept, len(self._moves) - 1)
            self._moves = self._moves[:kept]
            self.endRemoveRows()
        if kept < len(moves):
            self.beginInsertRows(QModelIndex(), kept, len(moves) - 1)
            self._moves = moves
            self.endInsertRows()
        self._moves = moves

    def set_outcomes(self, moves: tuple[Move, ...], outcomes: tuple[Outcome, ...]) -> None:
        """Take what became of some edits, which may not be the newest ones."""
        before, told_before = self._outcomes, self._told
        self._outcomes, self._told = outcomes, min(_common(self._moves, moves), len(outcomes))
        same = min(told_before, self._told)
        changed = [at for at in range(same) if before[at] is not outcomes[at] and before[at] != outcomes[at]]
        rows = [*changed, *range(same, max(told_before, self._told))]
        if rows:
            self.dataChanged.emit(self.index(rows[0]), self.index(rows[-1]))

    def rowCount(self, parent: AnyIndex = QModelIndex()) -> int:  # noqa: N802, B008
        """Count the edits."""
        return 0 if parent.isValid() else len(self._moves)

    def data(self, index: AnyIndex, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return what a row shows."""
        if not index.isValid():
            return None
        row = MoveRow(self._moves[index.row()].text or UNNAMED, self.outcome(index.row()))
        match role:
            case Qt.ItemDataRole.DisplayRole:
                return row.text
            case Qt.ItemDataRole.AccessibleTextRole | Qt.ItemDataRole.ToolTipRole:
                return f"{row.text}: {row.account}"
            case MoveRole.ROW:
                return row
        return None


class Misfits(QSortFilterProxyModel):
    """All edits, or only those that no longer fit."""

    def __init__(self, source: MovesModel, parent: Any = None) -> None:
        super().__init__(parent)
        self._moves, self._only = source, False
        self.setSourceModel(source)

    def set_only(self, is_only: bool) -> None:
        """Show only edits that no longer fit, or all."""
        self._only = is_only
        self.invalidate()

    def filterAcceptsRow(self, row: int, parent: AnyIndex) -> bool:  # noqa: N802
        """Whether an edit is shown."""
        outcome = self._moves.outcome(row) if self._only else None
        return not self._only or (outcome is not None and not outcome.resolved)


def _common(one: Sequence[Move], other: Sequence[Move]) -> int:
    """How many edits two sequences have in common at their beginnings."""
    pairs = enumerate(zip(one, other, strict=False))
    differs = (at for at, (left, right) in pairs if left is not right)
    return next(differs, min(len(one), len(other)))


def model_row(proxy: QSortFilterProxyModel, index: AnyIndex) -> int:
    """Return the row of the model below a proxy, -1 for none."""
    source: QAbstractItemModel = proxy.sourceModel()
    return proxy.mapToSource(index).row() if index.isValid() and source is not None else -1
