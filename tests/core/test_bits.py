"""Moves made on another grid share compartments: by area, and back to where it was when taken back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.conftest import scan_of
from tests.core.edited import Window, is_one_a_place, random_plan, write_shelves

from stepfield.compartments import sort_into_compartments
from stepfield.layers import classify
from stepfield.moves import Replay, apply_moves
from stepfield.parameters import Parameters
from stepfield.pillars import StepField, build_pillars
from stepfield.project import Move

#: A level floor, 0.9 m square, with nine points in each tenth of a metre squared.
SIDE = np.arange(0, 0.9, 0.1)
EAST, NORTH = (each.ravel() for each in np.meshgrid(SIDE, SIDE))
FLOOR = scan_of(np.c_[np.r_[0.0, EAST + 0.05, 0.9], np.r_[0.0, NORTH + 0.05, 0.9], np.zeros(len(EAST) + 2)])
SECOND = ((0.1, 0.2), (0.3, 0.6))
COARSE = Parameters(cell_size=0.55, layer_tolerance=0.3, alpha=0.1)


def floor(cell: float) -> StepField:
    return build_pillars(sort_into_compartments(FLOOR, cell), 0.3)


def strip(field: StepField, start: float, end: float, to: object) -> Move:
    """Move what lies between two distances east into a layer."""
    middle = field.compartments.grid.centres(field.compartment)[:, 0]
    boxes = field.boxes(np.flatnonzero((middle > start) & (middle < end)))
    return Move.model_validate({"to": to, "pillars": boxes})


def test_a_later_move_gets_what_it_has_most_of_although_it_covers_less_than_half_by_itself() -> None:
    """In the first three columns B ends with two thirds, a third from each of two moves."""
    fine, coarse = floor(0.1), floor(0.3)
    a, b = {"new": "A"}, {"new": "B"}
    moves = [
        strip(fine, 0.0, 0.9, a),
        strip(fine, 0.2, 0.6, b),
        # The second column, and again all of the second compartments: a move that finds nothing does nothing.
        Move.model_validate(
            {"to": b, "pillars": np.vstack([strip(fine, *part, b).boxes() for part in SECOND])}
        ),
    ]
    after = apply_moves(coarse, classify(coarse), moves)
    east = coarse.compartments.grid.centres(coarse.compartment)[:, 0]
    first = after.layering.layer[east < 0.3]
    assert (first == after.layering.layer[(east > 0.3) & (east < 0.6)][0]).all()
    assert after.names[int(first[0])] == "B"


def test_one_move_alone_takes_along_exactly_what_it_covers_more_than_half_of() -> None:
    fine = floor(0.1)
    for cell in (0.15, 0.19, 0.23):
        coarse = floor(cell)
        after = apply_moves(coarse, classify(coarse), [strip(fine, 0.2, 0.5, {"new": "A"})])
        squares = coarse.compartments.grid.squares(coarse.compartment)
        across = np.minimum(squares[:, 2], 0.5) - np.maximum(squares[:, 0], 0.2)
        down = np.minimum(squares[:, 3], 0.9) - squares[:, 1]
        assert np.array_equal(after.layering.layer == 1, np.maximum(across, 0) * down > cell**2 / 2 + 1e-9)


@pytest.fixture(scope="module")
def shelves(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_shelves(tmp_path_factory.mktemp("bits") / "shelves.npy")


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), steps=st.integers(2, 8))
def test_on_another_grid_nothing_is_lost_doubled_or_left_behind(shelves: Path, seed: int, steps: int) -> None:
    """Moves of a fine grid on a coarse one, undone and redone in steps, come to what they do at once."""
    rng, window = np.random.default_rng(seed), Window(shelves)
    for _ in range(steps):
        window.do(random_plan(window.result, window.project.layers, rng))
    moves = window.project.moves
    coarse = Window(shelves, COARSE).result
    replay = Replay(coarse.field, coarse.automatic)
    for kept in (len(moves), 0, *rng.integers(0, len(moves) + 1, 4), len(moves)):
        some = moves[: int(kept)]
        edited, fresh = replay.edited(some), apply_moves(coarse.field, coarse.automatic, some)
        assert is_one_a_place(coarse.field, edited.layering)
        assert np.array_equal(edited.layering.layer, fresh.layering.layer)
        assert edited.names == fresh.names
        assert edited.outcomes == fresh.outcomes


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_what_is_moved_on_the_grid_at_hand_comes_to_what_was_said_before(shelves: Path, seed: int) -> None:
    rng, window = np.random.default_rng(seed), Window(shelves)
    for _ in range(5):
        window.do(random_plan(window.result, window.project.layers, rng))
    window.open(window.project.model_copy(update={"parameters": COARSE}))
    for _ in range(3):
        plan = random_plan(window.result, window.project.layers, rng)
        window.do(plan)
        if plan.moves:
            outcome = window.result.outcomes[-1]
            assert (outcome.moved, outcome.swapped) == (plan.moved, plan.swapped)
