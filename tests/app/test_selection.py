"""The selection: what tools make of it, what it may reach, and that it follows its pillars everywhere."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np
import pytest
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import table

from stepfield.parameters import Parameters
from stepfield.project import ExistingLayer, Move
from stepfield.selecting import Reach, grown, of_layer
from stepfield_app import selection as module
from stepfield_app.document import Document
from stepfield_app.runner import Runner
from stepfield_app.scenes.picking import OnMap, Shape
from stepfield_app.selection import Selection

BASE = Parameters(cell_size=0.5, layer_tolerance=0.3, alpha=0.5)
FLOOR, TOP = 12 * 16, 4 * 6


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    path = tmp_path / "table.npy"
    np.save(path, table())
    return path


@pytest.fixture
def document(qtbot: QtBot, scan: Path) -> Iterator[Document]:
    """A document that answers at once."""
    document = Document(Runner(threaded=False))
    document.open([scan], BASE)
    yield document
    document.close()


@pytest.fixture
def selection(document: Document) -> Iterator[Selection]:
    """A selection that answers at once."""
    selection = Selection(document, threaded=False)
    yield selection
    selection.close()


@pytest.fixture
def threaded(document: Document) -> Iterator[Selection]:
    selection = Selection(document)
    yield selection
    selection.close()


def counted(signal: Any) -> list[None]:
    said: list[None] = []
    signal.connect(lambda *_: said.append(None))
    return said


def rectangle(*corners: float) -> OnMap:
    return OnMap(Shape("rectangle", np.array(corners).reshape(2, 2)), 0)


#: Two by two cells of the floor beside the table, one of them, and all the plan.
FOUR, ONE, PLAN = rectangle(0, 0, 1, 1), rectangle(0, 0, 0.5, 0.5), rectangle(0, 0, 8, 6)


def test_there_is_no_selection_without_a_scan(qtbot: QtBot, scan: Path) -> None:
    document = Document(Runner(threaded=False))
    selection = Selection(document, threaded=False)
    assert (selection.mask, selection.result, selection.count, selection.by_layer) == (None, None, 0, {})
    selection.pick(PLAN)
    selection.grow()
    selection.set(np.zeros(3, bool))
    assert selection.mask is None
    assert selection.z_range == (0.0, 0.0)
    document.open([scan], BASE)
    assert selection.mask is not None
    assert (len(selection.mask), selection.count) == (FLOOR + TOP, 0)
    document.close_scan()
    assert selection.mask is None
    selection.close()
    document.close()


def test_picks_replace_add_and_subtract(selection: Selection) -> None:
    changes = counted(selection.changed)
    selection.pick(FOUR)
    assert (selection.count, selection.by_layer) == (4, {0: 4})
    selection.pick(rectangle(1, 0, 2, 0.5), "add")
    assert selection.count == 6
    selection.pick(ONE, "subtract")
    assert selection.count == 5
    selection.pick(ONE)
    assert selection.count == 1
    selection.pick(rectangle(-2, -2, -1, -1))
    assert selection.count == 0, "a pick of nothing selects nothing"
    assert len(changes) == 5
    assert selection.mask is not None
    assert not selection.mask.flags.writeable


def test_the_reach_follows_the_active_layer_until_it_is_set(selection: Selection, document: Document) -> None:
    """What is not within it stays as it is, or the hand would change what the eye does not look at."""
    changes = counted(selection.reach_changed)
    assert (selection.reach_kind, selection.reach) == ("layer", Reach(layer=0))
    document.set_active_layer(1)
    assert (selection.reach, len(changes)) == (Reach(layer=1), 1)
    selection.pick(PLAN)
    assert selection.by_layer == {1: TOP}
    selection.set_reach("everything")
    assert (selection.reach, len(changes)) == (Reach(), 2)
    selection.pick(PLAN)
    assert selection.by_layer == {0: FLOOR, 1: TOP}
    document.set_active_layer(0)
    assert len(changes) == 2, "the active layer is not what it reaches"
    selection.set_reach("everything")
    assert len(changes) == 2


def test_the_range_is_all_of_the_scan_until_it_is_set(selection: Selection) -> None:
    assert selection.z_range == (0.0, 1.0)
    selection.set_reach("range")
    assert selection.reach == Reach(low=0.0, high=1.0)
    selection.set_reach("range", low=0.4)
    assert selection.z_range == (0.4, 1.0)
    selection.pick(PLAN)
    assert selection.by_layer == {1: TOP}
    selection.set_reach("range", high=0.1)
    assert selection.z_range == (0.1, 0.4), "ends that cross change places"
    selection.set_reach("layer")
    assert selection.z_range == (0.1, 0.4)
    assert selection.reach == Reach(layer=0)


def test_another_scan_is_reached_from_bottom_to_top_and_begins_without_a_selection(
    selection: Selection, document: Document, tmp_path: Path
) -> None:
    selection.set_reach("range", 0.4, 0.9)
    selection.pick(PLAN)
    other = tmp_path / "other.npy"
    np.save(other, table() + np.array([0, 0, 10]))
    document.open([other], BASE)
    assert (selection.count, selection.z_range) == (0, (10.0, 11.0))
    assert document.answer is not None
    assert selection.result is document.answer.result


def test_grow_shrink_invert_and_all_of_a_layer(selection: Selection) -> None:
    selection.pick(FOUR)
    selection.grow()
    assert selection.count == 8
    selection.invert()
    assert selection.by_layer == {0: FLOOR - 8}, "the other layer is out of reach"
    selection.all_of(1)
    assert selection.by_layer == {1: TOP}
    selection.shrink()
    assert selection.by_layer == {1: 2 * 4}
    selection.clear()
    assert (selection.count, selection.by_layer) == (0, {})


def test_a_mask_of_ones_own_is_copied(selection: Selection) -> None:
    mask = np.zeros(FLOOR + TOP, bool)
    mask[:3] = True
    selection.set(mask)
    mask[:] = False
    assert selection.count == 3


def test_picks_of_one_gesture_begin_where_it_began(selection: Selection) -> None:
    """A lasso that was too large for a moment must not leave anything."""
    selection.pick(ONE)
    gesture = object()
    selection.pick(PLAN, "add", gesture)
    assert selection.count == FLOOR
    selection.pick(rectangle(1, 0, 2, 0.5), "add", gesture)
    assert selection.count == 1 + 2
    selection.pick(FOUR, "subtract", object())
    assert selection.count == 2, "another gesture begins with what the first one left"


def test_a_gesture_can_be_taken_back(selection: Selection) -> None:
    selection.pick(FOUR)
    gesture = object()
    selection.pick(PLAN, "add", gesture)
    selection.pick(ONE, "replace", gesture)
    selection.take_back(object())
    assert selection.count == 1, "another gesture is not the last one"
    selection.take_back(gesture)
    assert selection.count == 4
    selection.take_back(gesture)
    assert selection.count == 4


def test_a_mask_may_be_of_an_older_result(selection: Selection, document: Document) -> None:
    """A list of edits knows places of the result it was made from."""
    assert document.answer is not None
    older = document.answer.result
    document.set_parameters("Cell", cell_size=0.25)
    selection.set(of_layer(older, 1), older)
    assert selection.by_layer == {1: 4 * TOP}


def test_cleaning_changes_the_range_of_elevations(selection: Selection, document: Document) -> None:
    """Else the two numbers of the range would be of points there are no more."""
    changes = counted(selection.reach_changed)
    document.set_parameters("Slab", crop=(-1, -1, -0.5, 9, 9, 0.5))
    assert (selection.z_range, len(changes)) == ((0.0, 0.0), 1)
    document.set_parameters("Tolerance", layer_tolerance=0.2)
    assert len(changes) == 1


def test_a_move_keeps_the_selection_and_counts_it_anew(selection: Selection, document: Document) -> None:
    selection.pick(FOUR)
    mask, result = selection.mask, selection.result
    assert result is not None
    assert mask is not None
    boxes = result.field.boxes(np.flatnonzero(mask))
    to = ExistingLayer(layer=1, of=2, elevation=1.0)
    move = Move(to=to, pillars=boxes)
    document.edit("Move", document.project.model_copy(update={"moves": (move,)}))
    assert selection.by_layer == {1: 4}
    assert np.array_equal(selection.mask, mask)  # type: ignore[arg-type]
    assert document.answer is not None
    assert selection.result is document.answer.result
    document.undo_stack.undo()
    assert selection.by_layer == {0: 4}


def test_a_selection_survives_parameters_that_lose_its_pillars(
    selection: Selection, document: Document
) -> None:
    """A slider moved too far and back must not cost the selection."""
    document.set_active_layer(1)
    selection.pick(PLAN)
    mask = selection.mask
    document.set_parameters("Cell", cell_size=0.25)
    assert selection.by_layer == {1: 4 * TOP}
    document.set_parameters("Cell", cell_size=4.0)
    assert selection.count < TOP
    document.set_parameters("Cell", cell_size=0.5)
    assert np.array_equal(selection.mask, mask)  # type: ignore[arg-type]


def test_what_is_changed_meanwhile_is_what_is_carried_on(selection: Selection, document: Document) -> None:
    selection.pick(FOUR)
    document.set_parameters("Cell", cell_size=0.25)
    selection.pick(rectangle(0, 0, 0.5, 0.5), "subtract")
    assert selection.count == 12
    document.set_parameters("Cell", cell_size=0.5)
    assert selection.count == 3


# --- On its worker ------------------------------------------------------------------------------------------


class Gate:
    """Lets the worker do its steps when the test says so."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.open, self.done = Event(), 0

        def slow(result: Any, mask: Any, reach: Any) -> Any:
            self.open.wait(10)
            self.done += 1
            return grown(result, mask, reach)

        monkeypatch.setattr(module, "grown", slow)


def test_no_step_is_lost_while_another_is_being_made(
    qtbot: QtBot, threaded: Selection, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The newest wish wins the worker, but it carries what the ones before it meant."""
    gate, busy = Gate(monkeypatch), counted(threaded.busy_changed)
    threaded.pick(rectangle(2.5, 2.5, 3, 3))
    for _ in range(3):
        threaded.grow()
    threaded.pick(ONE, "add")
    gate.open.set()
    qtbot.waitUntil(lambda: not threaded.busy)
    assert threaded.count == 25 + 1
    assert len(busy) == 2


def test_a_hand_quicker_than_the_worker_does_not_make_it_slower(
    qtbot: QtBot, threaded: Selection, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What has been answered is done: only what came later is left to do."""
    gate, asked = Gate(monkeypatch), 0

    def go_on() -> None:
        nonlocal asked
        if asked < 20:
            asked += 1
            threaded.grow()

    threaded.pick(rectangle(2.5, 2.5, 3, 3))
    go_on()
    go_on()
    threaded.changed.connect(go_on)  # so that the worker never rests
    gate.open.set()
    qtbot.waitUntil(lambda: asked == 20 and not threaded.busy)
    assert threaded.count == FLOOR
    assert gate.done <= 3 * asked


def test_a_result_that_arrives_meanwhile_is_what_the_selection_ends_with(
    qtbot: QtBot, threaded: Selection, document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    gate = Gate(monkeypatch)
    threaded.pick(rectangle(2.5, 2.5, 3, 3))
    qtbot.waitUntil(lambda: threaded.count == 1)
    threaded.grow()
    document.set_parameters("Tolerance", layer_tolerance=0.2)
    gate.open.set()
    qtbot.waitUntil(lambda: not threaded.busy)
    assert document.answer is not None
    assert threaded.result is document.answer.result
    assert threaded.count == 5


def test_clearing_forgets_what_is_being_made(
    qtbot: QtBot, threaded: Selection, monkeypatch: pytest.MonkeyPatch
) -> None:
    gate = Gate(monkeypatch)
    threaded.pick(FOUR)
    qtbot.waitUntil(lambda: threaded.count == 4)
    threaded.grow()
    threaded.clear()
    assert threaded.count == 0
    gate.open.set()
    qtbot.waitUntil(lambda: not threaded.busy)
    assert threaded.count == 0
    threaded.pick(ONE)
    qtbot.waitUntil(lambda: threaded.count == 1)


def test_a_failure_is_told_and_leaves_what_was_selected(
    qtbot: QtBot, threaded: Selection, document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    threaded.pick(FOUR)
    qtbot.waitUntil(lambda: threaded.count == 4)
    errors = counted(threaded.failed)

    def fail(*_: Any) -> None:
        raise MemoryError

    monkeypatch.setattr(module, "grown", fail)
    threaded.grow()
    qtbot.waitUntil(lambda: len(errors) == 1)
    assert threaded.count == 4
    threaded.shrink()
    qtbot.waitUntil(lambda: threaded.count == 0)
    assert document.answer is not None
    assert of_layer(document.answer.result, 0).sum() == FLOOR
