"""The one place that moves pillars and changes layers; widgets wish, the document is edited, undoably."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Signal

from stepfield.layers import UNASSIGNED
from stepfield.moving import Plan, free_name
from stepfield.project import Move
from stepfield.taking_out import TakenOut
from stepfield_app.document import Document
from stepfield_app.edit import Gesture
from stepfield_app.editor.previews import Previews
from stepfield_app.editor.situation import REST, Conflict, Situation
from stepfield_app.editor.wishes import CHANGED_MEANWHILE, Wish, Wishes
from stepfield_app.theme import layer_colour
from stepfield_app.wording import counted

if TYPE_CHECKING:
    from stepfield_app.selection import Selection


@dataclass(frozen=True)
class Target:
    """Where a selection can go: a layer, or Unassigned (-1)."""

    to: int
    name: str
    colour: str
    is_locked: bool


class Editor(QObject):
    """Takes wishes, plans them on a worker, and makes each one undo step.

    Parameters
    ----------
    document : Document
    selection : Selection
    parent : QObject, optional
    """

    told = Signal(str)  # what was done, or why not: one sentence
    conflict_changed = Signal(str)
    previews_changed = Signal()
    merge_weighed = Signal(int, int, object)  # the layer that goes, into which, and the Plan

    def __init__(self, document: Document, selection: Selection, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._document, self.selection = document, selection
        self._conflict: Conflict = "swap"
        self._previews = Previews(self._selected_situation, self)
        self._wishes = Wishes(document, selection, self._situation, self)
        self._previews.changed.connect(self.previews_changed)
        self._previews.failed.connect(document.failed)
        self._wishes.refused.connect(self.told)
        for signal in (selection.changed, document.answer_changed, document.project_changed):
            signal.connect(self._previews.make_soon)

    def close(self) -> None:
        """End the workers."""
        self._previews.close()
        self._wishes.close()

    # --- What it tells --------------------------------------------------------------------------------------

    @property
    def conflict(self) -> Conflict:
        """What becomes of pillars where moved ones go: they swap, or they stay and so does the moved one."""
        return self._conflict

    @property
    def is_idle(self) -> bool:
        """Whether every wish has become an edit or was refused."""
        return self._wishes.is_idle

    @property
    def locked(self) -> frozenset[int]:
        """Numbers of the locked layers."""
        return frozenset(style.index for style in self._document.project.layers if style.locked)

    @property
    def targets(self) -> tuple[Target, ...]:
        """Where the selection can go: the layers, the highest first, then Unassigned."""
        answer = self._document.answer
        if answer is None:
            return ()
        layers = reversed(range(len(answer.result.layers)))
        return tuple(self._target(layer) for layer in (*layers, UNASSIGNED))

    def name_of(self, layer: int) -> str:
        """What a layer is called."""
        if layer == UNASSIGNED:
            return REST
        answer = self._document.answer
        made = answer.result.layers[layer].name if answer and layer < len(answer.result.layers) else ""
        return self._document.style(layer).name or made or f"Layer {layer + 1}"

    def preview(self, target: int | str) -> Plan | None:
        """What moving the selection would do, None until that is known; any text stands for a new layer."""
        return self._previews.of(target)

    def plan_ahead(self) -> None:
        """Make the previews now: a drag begins."""
        self._previews.make()

    def _target(self, layer: int) -> Target:
        own = self._document.style(layer).color if layer != UNASSIGNED else None
        return Target(layer, self.name_of(layer), own or layer_colour(layer), layer in self.locked)

    def _situation(self) -> Situation | None:
        """What there is to work on; the selection only where it belongs to what is shown."""
        answer, selection = self._document.answer, self.selection
        if answer is None:
            return None
        chosen = selection.mask if selection.result is answer.result else None
        if chosen is None:
            chosen = np.zeros(len(answer.result.field), bool)
        name = free_name(answer.result, self._document.project.layers)
        return Situation(answer.result, chosen, self._conflict, self.locked, name)

    def _selected_situation(self) -> Situation | None:
        """The same, None while nothing is selected in it."""
        answer, selection = self._document.answer, self.selection
        belongs = answer is not None and selection.count and selection.result is answer.result
        return self._situation() if belongs else None

    # --- What is wished for ---------------------------------------------------------------------------------

    def set_conflict(self, conflict: Conflict) -> None:
        """Choose what becomes of pillars where moved ones go."""
        if conflict != self._conflict:
            self._conflict = conflict
            self.conflict_changed.emit(conflict)
            self._previews.make_soon()

    def move_to(self, target: int | str) -> None:
        """Move the selection to a layer, to Unassigned (-1), or to a new layer of a name."""
        layers = (target,) if isinstance(target, int) and target != UNASSIGNED else ()
        work = partial(_planned_move, target)
        self._wishes.want(Wish(work, self.carry_out, layers, of_selection=True))

    def new_layer(self, move_selection: bool = False) -> None:
        """Make a layer, empty or of the selection."""
        work = _planned_new_layer if move_selection else Situation.new_layer
        self._wishes.want(Wish(work, self.carry_out, of_selection=move_selection))

    def merge(self, source: int, target: int) -> None:
        """Put the pillars of a layer into another; the first one vanishes."""
        self._want_merge(source, target, partial(self.carry_out, heir=target))

    def weigh_merge(self, source: int, target: int) -> None:
        """Find out what a merge would do, and say so with ``merge_weighed``; nothing is done."""
        self._want_merge(source, target, partial(self.merge_weighed.emit, source, target))

    def _want_merge(self, source: int, target: int, then: Callable[[Plan], object]) -> None:
        self._wishes.want(Wish(lambda now: now.merge(source, target), then, (source, target)))

    def split(self, layer: int, elevation: float) -> None:
        """Put the pillars of a layer above an elevation, scan coordinates, metres, into a new layer."""
        self._wishes.want(Wish(lambda now: now.split(layer, elevation), self.carry_out, (layer,)))

    def exchange(self, layer: int, other: int) -> None:
        """Let two layers exchange their numbers, and with them their places in the list."""
        work = partial(_exchanged, layer=layer, other=other)
        self._wishes.want(Wish(work, self.carry_out, (layer, other)))

    def reorder(self, layer: int, place: int) -> None:
        """Give a layer another number, those between move up or down by one: one undo step."""
        step, gesture = (1 if place > layer else -1), Gesture()
        text = f"Move {self.name_of(layer)} to place {place + 1}"
        for at in range(layer, place, step):
            then = partial(self._carry_out_as, text, gesture)
            speaks_of = (at, at + step) if at == layer else ()
            self._wishes.want(Wish(partial(_exchanged, layer=at, other=at + step), then, speaks_of))

    def remove(self, layer: int) -> None:
        """Take a layer away; its pillars go to Unassigned."""
        self._wishes.want(
            Wish(lambda now: now.remove(layer), partial(self.carry_out, heir=layer - 1), (layer,))
        )

    def take_out(self, at: int) -> None:
        """Take an edit out from among the others, or tell which of them needs it."""
        moves = self._document.project.moves
        self._wishes.want(Wish(lambda now: now.without(moves, at), partial(self._go_on_without, moves[at])))

    def set_locked(self, layer: int, is_locked: bool) -> None:
        """Keep pillars from going into or out of a layer, or no more."""
        verb, name = "Lock" if is_locked else "Unlock", self.name_of(layer)
        self._document.set_style(f"{verb} {name}", layer, locked=is_locked)

    def select_places(self, move: Move) -> None:
        """Select the pillars that now stand where those of a move were."""
        self._wishes.want(Wish(lambda now: now.standing_at(move), self.selection.set))

    # --- Doing it -------------------------------------------------------------------------------------------

    def carry_out(self, plan: Plan, gesture: Gesture | None = None, heir: int = 0) -> None:
        """Make a plan of the present result an undo step, or tell why nothing can be done.

        Parameters
        ----------
        plan : Plan
        gesture : Gesture, optional
            Plans in a row with the same one are a single step.
        heir : int
            The layer that becomes active if the active one vanishes.
        """
        if not plan.moves:
            self.told.emit(_sentence(plan.reason))
            return
        self._document.edit(plan.text, plan.applied(self._document.project), gesture)
        self._follow(plan.numbers, heir)
        self.told.emit(_account(plan))

    def _go_on_without(self, move: Move, found: TakenOut) -> None:
        """Make the project without a move an undo step."""
        project = self._document.project
        if found.reason:
            self.told.emit(_sentence(found.reason))
        elif len(found.moves) == len(project.moves) - 1 and any(move is one for one in project.moves):
            self._document.edit(f"Remove edit: {move.text}", found.applied(project))
            self._follow(found.numbers, 0)
        else:
            self.told.emit(CHANGED_MEANWHILE)

    def _carry_out_as(self, text: str, gesture: Gesture, plan: Plan) -> None:
        """Make a plan a part of a step of another name."""
        self.carry_out(replace(plan, text=text), gesture)

    def _follow(self, numbers: tuple[int, ...], heir: int) -> None:
        """Keep the active layer active although its number has changed."""
        active = self._document.active_layer
        if 0 <= active < len(numbers):
            number = numbers[active if numbers[active] != UNASSIGNED else max(heir, 0)]
            self._document.set_active_layer(max(number, 0))


def _exchanged(now: Situation, layer: int, other: int) -> Plan:
    return now.exchange(layer, other)


def _account(plan: Plan) -> str:
    """Say what was done."""
    extras = (
        (0 if plan.numbers else plan.swapped, "swapped"),
        (plan.left, "stayed because their places are taken"),
        (plan.locked, "stayed because their layer is locked"),
        (plan.stay, "stayed because another one of their compartment goes there"),
        (plan.unassigned, "went to Unassigned"),
    )
    said = ", ".join(f"{counted(number, 'pillar')} {what}" for number, what in extras if number)
    return f"{plan.text}: {said}" if said else plan.text


def _sentence(reason: str) -> str:
    return f"{reason[:1].upper()}{reason[1:]}"


def _planned_move(target: int | str, now: Situation) -> Plan:
    return now.move_to(target)


def _planned_new_layer(now: Situation) -> Plan:
    return now.move_to(now.new_name)
