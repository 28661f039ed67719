"""The editor: wishes become undo steps, in turn, and never about layers that are no longer there."""

from __future__ import annotations

from functools import partial

import numpy as np
from pytestqt.qtbot import QtBot
from tests.app.editing import Desk

from stepfield.layers import UNASSIGNED
from stepfield.moving import Plan
from stepfield_app.editor.wishes import CHANGED_MEANWHILE, NOTHING_SELECTED


def one_pillar_a_place(desk: Desk) -> bool:
    """Whether no compartment has two pillars in a layer."""
    layer, compartment = desk.result.layering.layer, desk.result.field.compartment
    pairs = np.column_stack([layer, compartment])[layer != UNASSIGNED]
    return len(np.unique(pairs, axis=0)) == len(pairs)


def is_moving(desk: Desk, count: int) -> bool:
    """Whether the preview for the lowest layer says that so many pillars would move."""
    plan = desk.editor.preview(0)
    return plan is not None and plan.moved == count


def test_the_selection_moves_in_one_step_that_undoes(desk: Desk) -> None:
    """Pillars could not be put right, or not be put back."""
    before = desk.result.layering.layer
    desk.select(1, 40)
    desk.editor.move_to(0)
    desk.settle()
    assert np.count_nonzero(desk.result.layering.layer[desk.selection.mask] == 0) == 40
    assert one_pillar_a_place(desk)
    assert desk.steps == ["Move 40 pillars to Layer 1"]
    assert desk.told == ["Move 40 pillars to Layer 1: 40 pillars swapped"]
    desk.undo()
    np.testing.assert_array_equal(desk.result.layering.layer, before)


def test_what_is_said_before_is_what_happens(desk: Desk, qtbot: QtBot) -> None:
    """The row under the pointer would promise something else than the drop does."""
    desk.select(1, 40)
    desk.editor.plan_ahead()
    qtbot.waitUntil(lambda: desk.editor.preview(0) is not None)
    plan = desk.editor.preview(0)
    desk.editor.move_to(0)
    desk.settle()
    assert plan is not None
    outcome = desk.result.outcomes[0]
    assert (plan.moved, plan.swapped) == (outcome.moved, outcome.swapped)
    assert plan.sentence == "move 40, swap 40"


def test_previews_follow_the_selection(desk: Desk, qtbot: QtBot) -> None:
    """A row would speak of pillars that are no longer selected."""
    assert desk.editor.preview(0) is None
    for count in (40, 30):
        desk.select(1, count)
        qtbot.waitUntil(partial(is_moving, desk, count))
    qtbot.waitUntil(lambda: desk.editor.preview("any name") is not None)
    desk.selection.clear()
    assert desk.editor.preview(0) is None


def test_places_that_are_taken_can_be_left(desk: Desk) -> None:
    """The operator could not choose what becomes of pillars in the way."""
    desk.editor.set_conflict("leave")
    desk.select(1, 40)
    desk.editor.move_to(0)
    desk.settle()
    assert desk.steps == []
    assert desk.told == ["All places in Layer 1 are taken"]


def test_nothing_selected_is_said(desk: Desk) -> None:
    """A key without effect would leave the operator wondering."""
    desk.editor.move_to(1)
    desk.settle()
    assert desk.told == [NOTHING_SELECTED]


def test_a_locked_layer_takes_nothing_in_and_undo_unlocks_it(desk: Desk) -> None:
    """A lock would be for show only, or for ever."""
    desk.editor.set_locked(0, True)
    desk.select(1, 40)
    desk.editor.move_to(0)
    desk.settle()
    assert desk.told == ["Layer 1 is locked"]
    assert desk.steps == ["Lock Layer 1"]
    assert desk.editor.locked == {0}
    desk.undo()
    assert desk.editor.locked == frozenset()


def test_wishes_wait_for_the_result_of_those_before(desk: Desk) -> None:
    """Two keys in quick succession would lose one of the moves, or plan it from an old result."""
    desk.select(1, 40)
    desk.editor.move_to(2)
    desk.editor.move_to(UNASSIGNED)
    desk.editor.move_to(0)
    desk.settle()
    assert len(desk.steps) == 3
    assert np.count_nonzero(desk.result.layering.layer[desk.selection.mask] == 0) == 40
    assert one_pillar_a_place(desk)


def test_a_wish_about_layers_that_have_changed_meanwhile_is_refused(desk: Desk) -> None:
    """A click meant for one layer would hit another that has got its number."""
    desk.editor.remove(0)
    desk.editor.remove(2)
    desk.settle()
    assert desk.steps == ["Remove Layer 1"]
    assert desk.told[-1] == CHANGED_MEANWHILE


def test_a_new_layer_is_empty_or_of_the_selection(desk: Desk) -> None:
    """A drop below the rows would do nothing."""
    desk.editor.new_layer()
    desk.settle()
    assert desk.counts[3] == 0
    desk.select(1, 40)
    desk.editor.new_layer(move_selection=True)
    desk.settle()
    assert desk.counts[3:] == [0, 40]
    assert desk.steps == ["Add Layer 4", "Move 40 pillars to Layer 5"]


def test_merging_counts_its_losers_before_and_keeps_one_pillar_a_place(desk: Desk) -> None:
    """Pillars would get lost without a word."""
    plans: list[Plan] = []
    desk.editor.merge_weighed.connect(lambda source, target, plan: plans.append(plan))
    desk.editor.weigh_merge(2, 1)
    desk.settle()
    assert desk.steps == []
    desk.document.set_active_layer(2)
    desk.editor.merge(2, 1)
    desk.settle()
    assert len(desk.counts) == 2
    assert desk.result.layering.unassigned == plans[0].unassigned > 0
    assert one_pillar_a_place(desk)
    assert desk.document.active_layer == 1


def test_a_split_parts_a_layer_at_an_elevation(desk: Desk) -> None:
    """Two surfaces in one layer could not be taken apart."""
    elevation = desk.result.field.elevation[desk.result.layers[1].pillars] + 10.0
    middle = float(elevation.min() + elevation.max()) / 2
    desk.editor.split(1, middle)
    desk.settle()
    assert desk.counts[3] == np.count_nonzero(elevation > middle) > 0


def test_a_dragged_layer_takes_its_name_along_in_one_step(desk: Desk) -> None:
    """Names and colours would stay behind, or a drag would take several undos."""
    before, names = desk.counts, ["Floor", "Tables", "Shelf"]
    for layer, name in enumerate(names):
        desk.document.set_style(f"Rename to {name}", layer, name=name, color=f"#00000{layer}")
    desk.document.set_active_layer(2)
    desk.settle()
    desk.editor.reorder(2, 0)
    desk.settle()
    assert desk.counts == [before[2], before[0], before[1]]
    assert [layer.name for layer in desk.result.layers] == ["Shelf", "Floor", "Tables"]
    assert desk.document.style(0).color == "#000002"
    assert desk.document.active_layer == 0
    assert desk.steps[3:] == ["Move Shelf to place 1"]
    desk.undo()
    assert desk.counts == before


def test_the_last_layer_stays(desk: Desk) -> None:
    """A scan without layers could be made, and nothing be exported."""
    for _ in range(3):
        desk.editor.remove(0)
        desk.settle()
    assert len(desk.counts) == 1
    assert len(desk.steps) == 2
    assert desk.told[-1]


def test_pillars_where_a_move_took_its_own_can_be_selected(desk: Desk) -> None:
    """An edit in the list could not be looked at."""
    desk.select(1, 40)
    chosen = desk.selection.mask
    desk.editor.move_to(2)
    desk.settle()
    desk.selection.clear()
    desk.editor.select_places(desk.document.project.moves[0])
    desk.settle()
    np.testing.assert_array_equal(desk.selection.mask, chosen)


def test_closing_the_scan_forgets_what_was_wished(desk: Desk, qtbot: QtBot) -> None:
    """A wish would be fulfilled in a scan that it was not about."""
    desk.select(1, 40)
    desk.editor.move_to(2)
    desk.editor.remove(0)
    desk.document.close_scan()
    qtbot.waitUntil(lambda: desk.editor.is_idle)
    assert desk.document.project.moves == ()
    assert desk.editor.targets == ()
