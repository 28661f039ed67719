"""Places find their pillars: against a slow search that does what the sentence says."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.conftest import scan_of

from stepfield.compartments import sort_into_compartments
from stepfield.layers import classify
from stepfield.margins import AROUND, margins
from stepfield.pillars import StepField, build_pillars
from stepfield.places import ROUNDING, best_of_runs, occupants, pillars_in

seeds = st.integers(0, 2**32 - 1)


def field_of(seed: int, cell: float, origin: float = 0.0) -> StepField:
    points = np.random.default_rng(seed).random((300, 3)) * [3, 2, 2] + origin
    return build_pillars(sort_into_compartments(scan_of(points), cell), 0.2)


def found_slowly(field: StepField, boxes: NDArray[np.float64], *, one_only: bool) -> list[int]:
    """Go through all boxes and all pillars, one by one."""
    own = field.boxes(np.arange(len(field)))
    area, depth = np.zeros(len(field)), np.zeros(len(field))
    for x0, y0, x1, y1, low, high in boxes:
        best: dict[int, tuple[float, int, float]] = {}
        for pillar, (a0, b0, a1, b1, z0, z1) in enumerate(own):
            across, along = min(x1, a1) - max(x0, a0), min(y1, b1) - max(y0, b0)
            overlap = min(high, z1) - max(low, z0)
            if across <= 0 or along <= 0 or overlap < -ROUNDING:
                continue
            place = int(field.compartment[pillar])
            best[place] = max(best.get(place, (-1.0, 0, 0.0)), (overlap, -pillar, across * along))
        for overlap, pillar, shared in best.values():
            area[-pillar] += shared
            depth[-pillar] += overlap
    side = field.compartments.grid.cell_size
    follows = [n for n in range(len(field)) if area[n] / side**2 > 0.5 + ROUNDING]
    if one_only:
        places = {int(field.compartment[n]) for n in follows}
        follows = sorted(
            max((n for n in follows if field.compartment[n] == place), key=lambda n: (depth[n], -n))
            for place in places
        )
    return follows


@settings(max_examples=40, deadline=None)
@given(seeds, st.sampled_from([0.3, 0.41, 0.5, 0.77]), st.booleans())
def test_pillars_follow_the_boxes_that_hold_most_of_them(seed: int, cell: float, one_only: bool) -> None:
    rng = np.random.default_rng(seed)
    boxes = field_of(1, 0.5).boxes(np.flatnonzero(rng.random(len(field_of(1, 0.5))) < 0.5))
    boxes = rng.permutation(boxes) + rng.normal(0, 0.01, 6) * [1, 1, 1, 1, 0, 0]
    field = field_of(1, cell)
    found = pillars_in(field, boxes, one_only=one_only).tolist()
    assert found == found_slowly(field, boxes, one_only=one_only)


@settings(max_examples=30, deadline=None)
@given(seeds, st.sampled_from([0.0, 5_400_000.0]))
def test_boxes_find_exactly_their_own_pillars_again(seed: int, origin: float) -> None:
    field = field_of(2, 0.3, origin)
    chosen = np.flatnonzero(np.random.default_rng(seed).random(len(field)) < 0.3)
    assert np.array_equal(pillars_in(field, field.boxes(chosen), one_only=False), chosen)


@settings(max_examples=40, deadline=None)
@given(seeds, st.floats(0.05, 0.95))
def test_margins_reach_no_pillar_of_their_own_grid(seed: int, share: float) -> None:
    """Else what was selected would not be what is moved."""
    field = field_of(3, 0.2)
    layer, rng = classify(field).layer, np.random.default_rng(seed)
    chosen = np.flatnonzero(rng.random(len(field)) < share)
    around = margins(field, layer, chosen)
    assert not len(pillars_in(field, around, one_only=False))
    boxes = np.vstack([field.boxes(chosen), around])
    assert np.array_equal(pillars_in(field, boxes, one_only=False), chosen)
    assert len(np.unique(around[:, [0, 1, 4]], axis=0)) == len(around)


@settings(max_examples=30, deadline=None)
@given(seeds, st.floats(0.05, 0.95))
def test_margins_are_found_at_every_rim(seed: int, share: float) -> None:
    """Compartment by compartment: one that most of those around it are chosen goes with them."""
    field = field_of(3, 0.2)
    layer, rng = classify(field).layer, np.random.default_rng(seed)
    grid, chosen = field.compartments.grid, rng.random(len(field)) < share
    expected = []
    for number in np.unique(layer[chosen]):
        members = {int(field.compartment[at]): int(at) for at in np.flatnonzero(layer == number)}
        for cell in set(range(len(grid))) - set(members):
            row, column = divmod(cell, grid.columns)
            inside = [(row + down, column + right) for down, right in AROUND]
            around = [r * grid.columns + c for r, c in inside if 0 <= c < grid.columns]
            held = [members[beside] for beside in around if beside in members]
            taken = [at for at in held if chosen[at]]
            if 2 * len(taken) > len(held):
                low, high = field.lows(np.array(taken)).min(), field.highs(np.array(taken)).max()
                own = np.flatnonzero(field.compartment == cell)
                if not ((field.lows(own) <= high + 2e-6) & (field.highs(own) >= low - 2e-6)).any():
                    expected.append((cell, round(float(low), 9), round(float(high), 9)))
    found = margins(field, layer, np.flatnonzero(chosen))
    middles, spans = found[:, :2] + grid.cell_size / 2, found[:, 4:] - field.compartments.lowest
    cells = grid.compartment(middles[:, 0] - grid.west, middles[:, 1] - grid.south)
    assert sorted(zip(cells.tolist(), *spans.round(9).T.tolist(), strict=True)) == sorted(expected)


def test_a_wall_one_compartment_wide_is_found_on_a_coarser_grid() -> None:
    """Its old compartments cover less than half of the new ones."""
    wall = np.c_[np.linspace(0.02, 3, 900), np.full(900, 0.05), np.tile(np.linspace(0, 0.2, 30), 30)]
    scan = scan_of(np.vstack([wall, [[0, 3, 0]]]))
    fine, coarse = (build_pillars(sort_into_compartments(scan, cell), 0.3) for cell in (0.1, 0.25))
    chosen = np.flatnonzero(fine.compartments.grid.centres(fine.compartment)[:, 1] < 1)
    layer = classify(fine).layer
    bare, whole = fine.boxes(chosen), np.vstack([fine.boxes(chosen), margins(fine, layer, chosen)])
    assert not len(pillars_in(coarse, bare, one_only=True))
    assert len(pillars_in(coarse, whole, one_only=True)) == len(coarse) - 1


def test_nothing_has_no_margins() -> None:
    field = field_of(3, 0.2)
    assert margins(field, classify(field).layer, np.zeros(0, np.int64)).shape == (0, 6)
    assert not len(pillars_in(field, np.zeros((0, 6)), one_only=True))


def test_occupants_are_those_of_the_same_compartment() -> None:
    field = field_of(4, 0.5)
    layer = classify(field, "rank", max_layers="none").layer
    for pillar in range(len(field)):
        for target in set(range(4)) - {int(layer[pillar])}:
            there = np.flatnonzero((field.compartment == field.compartment[pillar]) & (layer == target))
            expected = there[0] if len(there) else -1
            assert occupants(field, layer, np.array([pillar]), target)[0] == expected


def test_best_of_runs_takes_the_first_of_equals() -> None:
    key, worth = np.array([3, 3, 3, 1, 7, 7]), np.array([1, 5, 5, 0, 2, 2])
    assert best_of_runs(key, worth).tolist() == [1, 3, 4]
