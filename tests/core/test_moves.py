"""Moves by hand: places in the world that find their pillars again, and never two pillars in one place."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.conftest import scan_of
from tests.core.edited import is_one_a_place

from stepfield.compartments import sort_into_compartments
from stepfield.errors import Cancelled
from stepfield.layers import UNASSIGNED, classify
from stepfield.moves import Replay, apply_moves
from stepfield.pillars import StepField, build_pillars
from stepfield.project import ExistingLayer, Move, NewLayer

RNG = np.random.default_rng(5)
FLOOR_AND_TABLE = scan_of(
    np.vstack(
        [
            np.c_[RNG.random((4000, 2)) * 4, RNG.normal(0, 0.005, 4000)],
            np.c_[RNG.random((2000, 2)) * 2 + 1, RNG.normal(0.8, 0.005, 2000)],
            np.c_[RNG.random((2000, 2)) * 2 + 1, RNG.normal(1.6, 0.005, 2000)],
        ]
    )
)


def field_at(cell: float) -> StepField:
    return build_pillars(sort_into_compartments(FLOOR_AND_TABLE, cell), 0.3)


def move(field: StepField, pillars: np.ndarray, to: object, conflict: str = "swap") -> Move:
    boxes = field.boxes(pillars)
    return Move.model_validate({"text": "test", "to": to, "conflict": conflict, "pillars": boxes})


def of_layer(layer: object, to: object, conflict: str = "swap", above: float | None = None) -> Move:
    return Move.model_validate({"layer": layer, "to": to, "conflict": conflict, "above": above})


def to_layer(layer: int, of: int = 3, elevation: float = 0.0) -> dict[str, object]:
    return {"layer": layer, "of": of, "elevation": elevation}


def test_swap_exchanges_the_two_pillars_and_swapping_back_restores_everything() -> None:
    field = field_at(0.25)
    before = classify(field)
    top = before.members(2)[:5]
    there = move(field, top, to_layer(1))
    after = apply_moves(field, before, [there])
    assert after.outcomes[0].moved == after.outcomes[0].swapped == 5
    assert (after.layering.layer[top] == 1).all()
    back = move(field, top, to_layer(2))
    restored = apply_moves(field, before, [there, back])
    assert np.array_equal(restored.layering.layer, before.layer)


def test_leave_keeps_the_present_pillar_where_it_is() -> None:
    field = field_at(0.25)
    before = classify(field)
    after = apply_moves(field, before, [move(field, before.members(2)[:5], to_layer(1), "leave")])
    assert after.outcomes[0].left == 5
    assert np.array_equal(after.layering.layer, before.layer)


def test_unassigned_takes_every_pillar_of_a_compartment_and_gives_them_back() -> None:
    field = field_at(0.25)
    before = classify(field)
    crowded = np.flatnonzero(np.isin(field.compartment, field.compartment[before.members(2)[:3]]))
    out = move(field, crowded, "unassigned")
    assert (apply_moves(field, before, [out]).layering.layer[crowded] == UNASSIGNED).all()
    home = [move(field, crowded[before.layer[crowded] == k], to_layer(k)) for k in range(3)]
    assert np.array_equal(apply_moves(field, before, [out, *home]).layering.layer, before.layer)


def test_a_new_layer_is_made_once_and_named() -> None:
    field = field_at(0.25)
    before = classify(field)
    moves = [move(field, before.members(1)[i : i + 1], {"new": "Shelf"}) for i in (0, 1)]
    after = apply_moves(field, before, moves)
    assert after.layering.count == 4
    assert after.names == {3: "Shelf"}
    assert len(after.layering.members(3)) == 2


def test_the_target_is_the_nearest_in_elevation_once_the_number_of_layers_changed() -> None:
    field = field_at(0.25)
    before = classify(field)
    chosen = before.members(0)[:4]
    after = apply_moves(field, before, [move(field, chosen, to_layer(0, of=7, elevation=1.5))])
    assert (after.layering.layer[chosen] == 2).all()


def test_a_move_that_finds_nothing_says_so_and_changes_nothing() -> None:
    field = field_at(0.25)
    before = classify(field)
    lost = Move(to=NewLayer(new="Shelf"), pillars=((90, 90, 91, 91, 0, 1),))
    after = apply_moves(field, before, [lost])
    assert after.outcomes[0].reason == "no pillar is where the moved ones were"
    assert after.layering.count == before.count
    assert np.array_equal(after.layering.layer, before.layer)


def test_moves_come_back_identical_through_another_cell_size() -> None:
    field = field_at(0.25)
    before = classify(field)
    moves = [
        move(field, before.members(2)[::3], to_layer(1)),
        move(field, before.members(0)[::7], "unassigned"),
    ]
    first = apply_moves(field, before, moves)
    elsewhere = apply_moves(field_at(0.17), classify(field_at(0.17)), moves)
    assert all(outcome.resolved for outcome in elsewhere.outcomes)
    again = apply_moves(field_at(0.25), classify(field_at(0.25)), moves)
    assert np.array_equal(first.layering.layer, again.layering.layer)


def test_a_finer_grid_keeps_the_moved_area_in_its_layer() -> None:
    field = field_at(0.3)
    before = classify(field)
    region = before.members(2)
    moved = move(field, region, to_layer(1))
    finer = field_at(0.1)
    after = apply_moves(finer, classify(finer), [moved])
    area = len(after.layering.members(1)) * 0.1**2
    assert area == pytest.approx(len(region) * 0.3**2, rel=0.1)


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_no_sequence_of_moves_puts_two_pillars_in_one_place(data: st.DataObject) -> None:
    field = field_at(0.4)
    layering = classify(field)
    moves = []
    for _ in range(data.draw(st.integers(1, 6))):
        chosen = data.draw(st.lists(st.integers(0, len(field) - 1), min_size=1, max_size=30, unique=True))
        target = data.draw(
            st.sampled_from(["unassigned", {"new": "A"}, to_layer(0), to_layer(1), to_layer(2)])
        )
        moves.append(move(field, np.array(chosen), target, data.draw(st.sampled_from(["swap", "leave"]))))
    after = apply_moves(field, layering, moves)
    assert is_one_a_place(field, after.layering)
    assert len(after.layering.layer) == len(field)


def test_existing_layer_is_told_from_a_new_one() -> None:
    assert isinstance(move(field_at(0.4), np.array([0]), to_layer(1)).to, ExistingLayer)
    assert isinstance(move(field_at(0.4), np.array([0]), {"new": "x"}).to, NewLayer)


def test_a_merged_layer_vanishes_and_those_above_it_move_down() -> None:
    field = field_at(0.25)
    before = classify(field)
    after = apply_moves(field, before, [of_layer(to_layer(0), to_layer(1), "fewest")])
    assert after.layering.count == 2
    assert np.array_equal(after.layering.layer == 1, before.layer == 2)
    (outcome,) = after.outcomes
    both = np.count_nonzero((before.layer == 0) | (before.layer == 1))
    assert len(after.layering.members(0)) == both - outcome.unassigned
    assert after.layering.unassigned == before.unassigned + outcome.unassigned


def test_removed_pillars_are_unassigned_and_layers_made_by_hand_keep_their_names() -> None:
    field = field_at(0.25)
    before = classify(field)
    moves = [move(field, before.members(2)[:5], {"new": "Shelf"}), of_layer(to_layer(0, of=4), "unassigned")]
    after = apply_moves(field, before, moves)
    assert after.names == {2: "Shelf"}
    assert after.outcomes[1].unassigned == np.count_nonzero(before.layer == 0)
    again = apply_moves(field, before, [*moves, move(field, before.members(2)[5:9], {"new": "Shelf"})])
    assert len(again.layering.members(2)) == 9


def test_exchanged_layers_take_their_names_along() -> None:
    field = field_at(0.25)
    before = classify(field)
    moves = [
        move(field, before.members(2)[:5], {"new": "Shelf"}),
        of_layer({"new": "Shelf"}, to_layer(0, of=4), "exchange"),
    ]
    after = apply_moves(field, before, moves)
    assert after.names == {0: "Shelf"}
    assert np.array_equal(after.layering.members(3), before.members(0))
    assert np.array_equal(after.layering.members(0), before.members(2)[:5])


def test_a_move_of_neither_pillars_nor_a_layer_makes_an_empty_layer_once() -> None:
    field = field_at(0.25)
    before = classify(field)
    after = apply_moves(field, before, [Move(to=NewLayer(new="Shelf"))] * 2)
    assert (after.layering.count, after.names) == (4, {3: "Shelf"})
    assert all(outcome.resolved for outcome in after.outcomes)


@pytest.mark.parametrize(
    ("moves", "reason"),
    [
        ([of_layer({"new": "Gone"}, "unassigned")], "the layer to take the pillars from is not there"),
        ([of_layer(to_layer(0, of=9, elevation=0.8), to_layer(1), "fewest")], "the two layers have become"),
        ([of_layer(to_layer(0), {"new": "x"}, above=9.0)], "no pillar of the layer lies above 9 m"),
        ([of_layer(to_layer(0, of=of), "unassigned") for of in (3, 2, 1)], "the last layer has to stay"),
    ],
)
def test_an_operation_on_layers_that_does_not_resolve_changes_nothing(moves: list[Move], reason: str) -> None:
    field = field_at(0.25)
    *_, last = apply_moves(field, classify(field), moves).outcomes
    assert last.reason.startswith(reason)
    done = apply_moves(field, classify(field), moves[:-1]).layering
    after = apply_moves(field, classify(field), moves).layering
    assert (after.count, after.layer.tolist()) == (done.count, done.layer.tolist())


def any_move(field: StepField, rng: np.random.Generator) -> Move:
    """Draw a move of any kind, resolvable or not."""
    one, other = (
        to_layer(int(rng.integers(0, 5)), int(rng.integers(1, 6)), float(rng.random() * 2)) for _ in range(2)
    )
    match rng.integers(0, 8):
        case 0:
            return of_layer(one, other, "fewest")
        case 1:
            return of_layer(one, other, "exchange")
        case 2:
            return of_layer(one, "unassigned")
        case 3:
            return of_layer(one, {"new": str(rng.integers(3))}, above=float(rng.random()))
        case 4:
            return Move(to=NewLayer(new=str(rng.integers(3))))
    target = [one, "unassigned", {"new": str(rng.integers(3))}][rng.integers(3)]
    conflict = ["swap", "leave", "fewest"][rng.integers(3)]
    return move(field, np.flatnonzero(rng.random(len(field)) < 0.2), target, conflict)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 15))
def test_a_replay_that_went_back_and_forth_is_as_if_all_were_applied_at_once(seed: int, steps: int) -> None:
    """Undo, redo, edits taken out of the middle: the file holds the moves only, so no history may show."""
    field, rng = field_at(0.5), np.random.default_rng(seed)
    automatic = classify(field)
    replay = Replay(field, automatic)
    moves: list[Move] = []
    undone: list[Move] = []
    for _ in range(steps):
        match rng.integers(0, 6):
            case 0 if moves:
                undone.append(moves.pop())
            case 1 if undone:
                moves.append(undone.pop())
            case 2 if moves:
                del moves[rng.integers(len(moves))]
            case _:
                moves.append(any_move(field, rng))
        edited, fresh = replay.edited(moves), apply_moves(field, automatic, moves)
        assert edited.layering.layer.tobytes() == fresh.layering.layer.tobytes()
        assert (edited.layering.count, edited.names) == (fresh.layering.count, fresh.names)
        assert edited.outcomes == fresh.outcomes
        assert is_one_a_place(field, edited.layering)
    assert np.array_equal(replay.edited([]).layering.layer, automatic.layer)


def test_a_result_does_not_change_when_the_replay_goes_on() -> None:
    field = field_at(0.25)
    before = classify(field)
    replay = Replay(field, before)
    first = replay.edited([move(field, before.members(2)[:5], to_layer(1))])
    layer = first.layering.layer.copy()
    replay.edited([])
    assert np.array_equal(first.layering.layer, layer)
    assert not first.layering.layer.flags.writeable


def test_a_replay_that_was_stopped_goes_on_where_it_was() -> None:
    field = field_at(0.25)
    before = classify(field)
    moves = [move(field, before.members(2)[n : n + 5], to_layer(1)) for n in range(0, 25, 5)]
    replay = Replay(field, before)

    def stop(share: float, what: str) -> None:
        if share > 0.5:
            raise Cancelled

    with pytest.raises(Cancelled):
        replay.edited(moves, stop)
    fresh = apply_moves(field, before, moves)
    assert np.array_equal(replay.edited(moves).layering.layer, fresh.layering.layer)
