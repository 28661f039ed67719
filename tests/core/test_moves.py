"""Moves by hand: places in the world that find their pillars again, and never two pillars in one place."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.conftest import scan_of

from stepfield.compartments import sort_into_compartments
from stepfield.layers import UNASSIGNED, Layering, classify
from stepfield.moves import apply_moves
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
    boxes = tuple(tuple(box) for box in field.boxes(pillars).tolist())
    return Move.model_validate({"text": "test", "to": to, "conflict": conflict, "pillars": boxes})


def to_layer(layer: int, of: int = 3, elevation: float = 0.0) -> dict[str, object]:
    return {"layer": layer, "of": of, "elevation": elevation}


def one_pillar_a_place(field: StepField, layering: Layering) -> bool:
    assigned = layering.layer >= 0
    places = np.c_[field.compartment[assigned], layering.layer[assigned]]
    return len(np.unique(places, axis=0)) == len(places)


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
    assert one_pillar_a_place(field, after.layering)
    assert len(after.layering.layer) == len(field)


def test_existing_layer_is_told_from_a_new_one() -> None:
    assert isinstance(move(field_at(0.4), np.array([0]), to_layer(1)).to, ExistingLayer)
    assert isinstance(move(field_at(0.4), np.array([0]), {"new": "x"}).to, NewLayer)
