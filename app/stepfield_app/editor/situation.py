"""All that a plan depends on, as a frozen value that can be taken to a worker."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield import moving
from stepfield.moves import pillars_in
from stepfield.moving import Plan
from stepfield.project import Move
from stepfield.reconstruction import Reconstruction
from stepfield.taking_out import TakenOut, take_out

Conflict = Literal["swap", "leave"]
Mask = NDArray[np.bool_]

#: What a drag of the selection carries: the number of pillars as text.
PILLARS_MIME = "application/x-stepfield-pillars"
#: What the pillars in no layer are called.
REST = "Unassigned"


@dataclass(frozen=True, eq=False)
class Situation:
    """A result, what is selected in it, and how the operator wants it treated.

    Attributes
    ----------
    result : Reconstruction
    chosen : ndarray of shape (P,), bool
        The selection, read-only.
    conflict : str
        What becomes of pillars where moved ones go: ``swap`` or ``leave``.
    locked : frozenset of int
        Layers that nothing goes into or out of.
    new_name : str
        What a new layer would be called.
    """

    result: Reconstruction
    chosen: Mask
    conflict: Conflict
    locked: frozenset[int]
    new_name: str

    def is_as(self, other: Situation) -> bool:
        """Whether the same plans follow from another one."""
        return (
            self.result is other.result
            and self.chosen is other.chosen
            and (self.conflict, self.locked, self.new_name) == (other.conflict, other.locked, other.new_name)
        )

    def move_to(self, target: int | str) -> Plan:
        """Plan to move the selection."""
        return moving.move_to(self.result, self.chosen, target, conflict=self.conflict, locked=self.locked)

    def forecast(self, target: int | str) -> Plan:
        """Tell what moving the selection would come to."""
        return moving.forecast(self.result, self.chosen, target, conflict=self.conflict, locked=self.locked)

    def new_layer(self) -> Plan:
        """Plan an empty layer."""
        return moving.new_layer(self.result, self.new_name)

    def merge(self, source: int, target: int) -> Plan:
        """Plan to put a layer into another."""
        return moving.merge(self.result, source, target, self.locked)

    def split(self, layer: int, elevation: float) -> Plan:
        """Plan to put what is above an elevation, metres, into a new layer."""
        return moving.split(self.result, layer, elevation, self.new_name, self.locked)

    def exchange(self, layer: int, other: int) -> Plan:
        """Plan to let two layers exchange their numbers."""
        return moving.exchange(self.result, layer, other)

    def remove(self, layer: int) -> Plan:
        """Plan to take a layer away."""
        return moving.remove(self.result, layer, self.locked)

    def without(self, moves: tuple[Move, ...], at: int) -> TakenOut:
        """Take one of the moves that led to the result out from among the others."""
        return take_out(self.result.field, self.result.automatic, moves, at)

    def standing_at(self, move: Move) -> Mask:
        """Mask of the pillars that stand where those of a move were."""
        mask = np.zeros(len(self.result.field), bool)
        mask[pillars_in(self.result.field, move.boxes(), one_only=False)] = True
        mask.flags.writeable = False
        return mask
