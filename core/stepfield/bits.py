"""Compartments that several moves made on another grid share among them, bit by bit.

Each move alone takes a pillar along when it covers more than half of its compartment. Of many moves over one
another that rule, move by move, adds up what is left over at every rim. So a compartment that moves cover in
part is also kept in bits, small squares that follow every move; once a second move covers some of it, each of
its pillars goes where most of its bits are. Moves made on the grid at hand cover whole compartments: they
find them as they were shown, and leave no bits.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stepfield.changes import Change, Claim, Outcome, State, put
from stepfield.layers import UNASSIGNED
from stepfield.pillars import StepField
from stepfield.places import ROUNDING, best_of_runs
from stepfield.project import Move

Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: Bits along a side: they tell halves, thirds and sixths exactly.
SIDE = 6


@dataclass(frozen=True, eq=False)
class Before:
    """Bits of some pillars before a move, to take it back.

    Attributes
    ----------
    pillars : ndarray of shape (n,)
    layers : ndarray of shape (n, SIDE**2)
    kept : ndarray of shape (n,), bool
        Whether they were kept in bits at all.
    """

    pillars: NDArray[np.int64]
    layers: NDArray[np.int16]
    kept: Mask


class Bits:
    """The layer of every bit of the compartments that moves cover in part. For one thread at a time.

    Parameters
    ----------
    field : StepField
    """

    def __init__(self, field: StepField) -> None:
        self._field = field
        self._kept: Mask = np.zeros(0, bool)  # by pillar; nothing at all before the first bit
        self._layers: NDArray[np.int16] = np.zeros((0, SIDE**2), np.int16)

    def followed(self, state: State, move: Move, change: Change) -> tuple[Change, Before | None]:
        """Let the bits follow a move; return what it comes to with them, and how they were before."""
        claim = change.claim
        if not change.outcome.resolved or (claim is None and not len(self._kept)):
            return change, None
        if claim is None:
            return change, self._dropped(np.flatnonzero(self._kept)) if move.layer is not None else None
        if claim.coverage.is_whole:
            return change, self._dropped(self._kept_beside(claim.coverage.pillars))
        self._make_room()
        partly = claim.coverage.share <= 1 - ROUNDING
        crowd = self._beside(np.union1d(claim.coverage.pillars[partly], self._kept_ones(claim)))
        before = self._noted(crowd)
        fresh = crowd[~self._kept[crowd]]
        self._layers[fresh] = state.layer[fresh, np.newaxis]
        self._kept[crowd] = True
        self._move_bits(state, move, claim)
        return self._settled(state, move, change, claim, crowd[before.kept]), before

    def take_back(self, before: Before | None) -> None:
        """Put bits back as they were."""
        if before is not None:
            self._layers[before.pillars], self._kept[before.pillars] = before.layers, before.kept

    # --- Which of them --------------------------------------------------------------------------------------

    def _make_room(self) -> None:
        if not len(self._kept):
            self._kept = np.zeros(len(self._field), bool)
            self._layers = np.zeros((len(self._field), SIDE**2), np.int16)

    def _beside(self, pillars: Integers) -> Integers:
        """Return all pillars of the compartments of some, ascending."""
        field = self._field
        place = np.unique(np.searchsorted(field.compartments.occupied, field.compartment[pillars]))
        held = field.first[place + 1] - field.first[place]
        nth = np.arange(held.sum()) - np.repeat(np.cumsum(held) - held, held)
        crowd: Integers = np.repeat(field.first[place], held) + nth
        return crowd

    def _kept_ones(self, claim: Claim) -> Integers:
        pillars = claim.coverage.pillars
        kept: Integers = pillars[self._kept[pillars]]
        return kept

    def _kept_beside(self, pillars: Integers) -> Integers:
        if not len(self._kept):
            return np.zeros(0, np.int64)
        return self._beside(pillars[self._kept[pillars]])

    def _noted(self, pillars: Integers) -> Before:
        return Before(pillars, self._layers[pillars], self._kept[pillars])

    def _dropped(self, pillars: Integers) -> Before | None:
        """Keep some no more in bits: they are as the layering has them."""
        if not len(pillars):
            return None
        before = self._noted(pillars)
        self._kept[pillars] = False
        return before

    # --- Moving bits ----------------------------------------------------------------------------------------

    def _move_bits(self, state: State, move: Move, claim: Claim) -> None:
        """Do to every covered bit what a move does to a pillar."""
        pillar, bit = self._covered_bits(move, claim, one_only=claim.target != UNASSIGNED)
        now = self._layers[pillar, bit].astype(np.int64)
        moves = now != claim.target
        pillar, bit, now = pillar[moves], bit[moves], now[moves]
        if claim.target != UNASSIGNED:
            there = self._occupants(pillar, bit, claim.target)
            taken = there >= 0
            if move.conflict == "leave":
                pillar, bit = pillar[~taken], bit[~taken]
            else:
                self._layers[there[taken], bit[taken]] = now[taken]
        self._layers[pillar, bit] = claim.target

    def _covered_bits(self, move: Move, claim: Claim, *, one_only: bool) -> tuple[Integers, Integers]:
        """Pairs of pillar and bit that a move's rectangles cover, of pillars that are kept in bits."""
        found, coverage = self._field, claim.coverage
        concerned = self._kept[coverage.pillar]
        box, pillar = coverage.box[concerned], coverage.pillar[concerned]
        squares = found.compartments.grid.squares(found.compartment[pillar])
        sides = move.boxes()[box, :4]
        middles = (np.arange(SIDE) + 0.5) / SIDE * found.compartments.grid.cell_size
        within = [
            (middles >= (sides[:, [axis]] - squares[:, [axis]]))
            & (middles < (sides[:, [axis + 2]] - squares[:, [axis]]))
            for axis in (0, 1)
        ]
        covers = (within[1][:, :, np.newaxis] & within[0][:, np.newaxis, :]).reshape(-1, SIDE**2)
        key = np.unique(pillar[np.nonzero(covers)[0]] * SIDE**2 + np.nonzero(covers)[1])
        pillar, bit = key // SIDE**2, key % SIDE**2
        if one_only and len(pillar):
            place = found.compartment[pillar] * SIDE**2 + bit
            depth = coverage.depth[np.searchsorted(coverage.pillars, pillar)]
            order = np.argsort(place, kind="stable")
            best = order[best_of_runs(place[order], depth[order])]
            pillar, bit = pillar[best], bit[best]
        return pillar, bit

    def _occupants(self, pillar: Integers, bit: Integers, target: int) -> Integers:
        """Find the pillar of which the same bit is in a layer; -1 where there is none."""
        field, found = self._field, np.full(len(pillar), -1)
        for step in (1, -1):  # up the compartment, then down it
            seeker, at = np.arange(len(pillar)), pillar + step
            while len(seeker):
                is_inside = (at >= 0) & (at < len(field))
                seeker, at = seeker[is_inside], at[is_inside]
                is_same = field.compartment[at] == field.compartment[pillar[seeker]]
                seeker, at = seeker[is_same], at[is_same]
                hit = self._layers[at, bit[seeker]] == target
                found[seeker[hit]] = at[hit]
                seeker, at = seeker[~hit], at[~hit] + step
        return found

    # --- Settling -------------------------------------------------------------------------------------------

    def _settled(self, state: State, move: Move, change: Change, claim: Claim, shared: Integers) -> Change:
        """Put the pillars of compartments that several moves share where most of their bits are."""
        if not len(shared):
            return change
        is_shared = np.zeros(len(self._field), bool)
        is_shared[shared] = True
        alone = put(state, claim.following[~is_shared[claim.following]], claim.target, move.conflict)
        before, after = state.layer[shared], self._most(state, shared)
        changed = before != after
        arrived = int(np.count_nonzero(changed & (after == claim.target)))
        gone = int(np.count_nonzero(changed & (before == claim.target)))
        outcome = alone.outcome
        return replace(
            alone,
            pillars=np.concatenate([alone.pillars, shared[changed]]),
            layers=np.concatenate([alone.layers, after[changed]]),
            outcome=Outcome(
                outcome.moved + arrived, outcome.swapped + gone, outcome.left, outcome.unassigned
            ),
            made=change.made,
        )

    def _most(self, state: State, pillars: Integers) -> Integers:
        """Layers that have most bits of some pillars, each layer once a compartment.

        The greatest share is served first; between equal ones what is there stays.
        """
        place = self._field.compartment[pillars]
        which, layer, share = self._shares(state, pillars)
        order = np.lexsort((layer, which, -share, place[which]))
        which, layer = which[order], layer[order]
        settled = np.full(len(pillars), UNASSIGNED - 1)
        while len(which):
            lead = np.flatnonzero(np.diff(place[which], prepend=-1))
            settled[which[lead]] = layer[lead]
            run = np.cumsum(np.diff(place[which], prepend=-1) != 0) - 1
            taken = (layer == layer[lead][run]) & (layer != UNASSIGNED)
            left = ~taken & (settled[which] < UNASSIGNED)
            which, layer = which[left], layer[left]
        # Where nothing is left for somebody, all of the compartment stay as they are.
        stuck = np.isin(place, place[settled < UNASSIGNED])
        settled[stuck] = state.layer[pillars[stuck]]
        return settled

    def _shares(self, state: State, pillars: Integers) -> tuple[Integers, Integers, NDArray[np.float64]]:
        """List the layers each pillar has bits in, and how many: index into ``pillars``, layer, bits."""
        span = state.count + 3
        rows = self._layers[pillars] - UNASSIGNED
        key = (np.arange(len(pillars))[:, np.newaxis] * span + rows).reshape(-1)
        found, bits = np.unique(key, return_counts=True)
        which, layer = found // span, found % span + UNASSIGNED
        return which, layer, bits + 0.5 * (layer == state.layer[pillars[which]])
