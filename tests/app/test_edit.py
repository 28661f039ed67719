"""An undo step holds what it changes: everything comes back, and a long history stays small."""

from __future__ import annotations

import tracemalloc
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PySide6.QtGui import QUndoStack

from stepfield.boxes import Boxes
from stepfield.parameters import Parameters
from stepfield.project import ExistingLayer, LayerStyle, Move, Project, ScanFile
from stepfield_app.edit import MOST_STEPS, RECALLED, Change, Edit, recalled

BASE = Project(scans=(ScanFile(path="/scans/a.ply"),), parameters=Parameters(cell_size=0.1))


def move(number: int, pillars: int = 1) -> Move:
    """Make a move like no other."""
    places = np.arange(6 * pillars, dtype=np.float64).reshape(-1, 6) + number
    return Move(text=f"Move {number}", to=ExistingLayer(layer=0, of=2, elevation=1.0), pillars=Boxes(places))


class History:
    """A project and its undo stack, as the document has them."""

    def __init__(self, project: Project = BASE) -> None:
        self.project, self.stack = project, QUndoStack()

    def edit(self, text: str, gesture: object | None = None, **values: Any) -> None:
        after = self.project.model_copy(update=values)
        change = Change.between(self.project, after)
        self.stack.push(Edit(text, change, lambda: self.project, self._place, gesture))

    def _place(self, project: Project) -> None:
        self.project = project


#: Kinds of edits and a number that says where or what.
EDITS = st.lists(
    st.tuples(
        st.sampled_from(["add", "remove", "replace", "parameters", "style", "clear", "undo", "redo", "both"]),
        st.integers(0, 30),
        st.booleans(),
    ),
    max_size=40,
)


def values_for(kind: str, number: int, project: Project) -> dict[str, Any]:
    moves = project.moves
    place = number % (len(moves) + 1)
    made: dict[str, dict[str, Any]] = {
        "add": {"moves": (*moves, move(number))},
        "remove": {"moves": moves[:place] + moves[place + 1 :]},
        "replace": {"moves": (*moves[:place], move(number), *moves[place + 1 :])},
        "parameters": {"parameters": Parameters(cell_size=0.1 + number)},
        "style": {"layers": (LayerStyle(index=number, name=f"Floor {number}"),)},
        "clear": {"moves": ()},
        "both": {"moves": (move(number), *moves), "layers": (LayerStyle(index=number, locked=True),)},
    }
    return made[kind]


@settings(max_examples=150, deadline=None)
@given(EDITS)
def test_undoing_everything_gives_the_very_same_bytes(edits: list[tuple[str, int, bool]]) -> None:
    """And redoing everything those of the end; in between undo and redo, and steps that are one gesture."""
    history, gesture = History(), object()
    for kind, number, is_held in edits:
        if kind in ("undo", "redo"):
            getattr(history.stack, kind)()
            gesture = object()
        else:
            gesture = gesture if is_held else object()
            history.edit(kind, gesture, **values_for(kind, number, history.project))
    end = history.project.content()
    states = [end]
    while history.stack.canUndo():
        history.stack.undo()
        states.append(history.project.content())
    assert history.project == BASE
    assert history.project.content() == BASE.content()
    for state in reversed(states[:-1]):
        history.stack.redo()
        assert history.project.content() == state
    while history.stack.canRedo():
        history.stack.redo()


def test_a_change_of_one_move_among_many_holds_one() -> None:
    many = tuple(move(number) for number in range(500))
    before = BASE.model_copy(update={"moves": many})
    without = before.model_copy(update={"moves": many[:200] + many[201:]})
    change = Change.between(before, without)
    assert (change.removed, change.added) == ((many[200],), ())
    assert change.applied(before).moves == without.moves
    assert change.reverted(without).moves == many


@pytest.mark.parametrize("names", [("parameters",), ("moves", "parameters")])
def test_a_gesture_that_ends_where_it_began_is_no_step(names: tuple[str, ...]) -> None:
    history, gesture = History(), object()
    other = {"parameters": Parameters(bits=8), "moves": (move(1),)}
    history.edit("There", gesture, **{name: other[name] for name in names})
    history.edit("Back", gesture, **{name: getattr(BASE, name) for name in names})
    assert history.stack.count() == 0


def test_ten_thousand_steps_take_little_memory() -> None:
    """Were the projects kept, the moves alone would be listed 50 million times: 400 MB."""
    history = History()
    tracemalloc.start()
    for number in range(10_000):
        if number % 4:
            history.edit(f"Move {number}", moves=(*history.project.moves, move(number, pillars=20)))
        else:
            history.edit(f"Cell {number}", parameters=Parameters(cell_size=0.1 + number))
    used, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert used < 100e6, f"{used / 1e6:.0f} MB"
    assert history.stack.count() == 10_000
    while history.stack.canUndo():
        history.stack.undo()
    assert history.project == BASE


@given(EDITS, EDITS)
@settings(deadline=None, max_examples=25)
def test_steps_of_an_earlier_window_lead_back_to_what_was_saved(before: Any, after: Any) -> None:
    """A crash would leave edits that nobody can take back."""
    saved, left = History(), History()
    for kind, number, _ in before:
        if kind not in ("undo", "redo", "both"):
            saved.edit(kind, **values_for(kind, number, saved.project))
    left.project = Project.model_validate_json(saved.project.content())  # as it is read from the file
    for kind, number, _ in after:
        if kind not in ("undo", "redo", "both"):
            left.edit(kind, **values_for(kind, number, left.project))
    history = History(left.project)
    for text, change in recalled(left.project, saved.project):
        history.stack.push(Edit(text, change, lambda: history.project, history._place, is_done=True))
        assert history.project is left.project
    while history.stack.canUndo():
        history.stack.undo()
    assert history.project == saved.project
    while history.stack.canRedo():
        history.stack.redo()
    assert history.project == left.project


def test_the_last_moves_of_an_earlier_window_are_steps_of_their_own() -> None:
    """Ten thousand steps would be pushed for many seconds while the window stands still."""
    project = BASE.model_copy(
        update={"moves": (move(1), move(2)), "layers": (LayerStyle(index=0, name="Floor"),)}
    )
    assert [text for text, _ in recalled(project, None)] == [RECALLED, "Move 1", "Move 2"]
    many = BASE.model_copy(update={"moves": tuple(move(number) for number in range(3 * MOST_STEPS))})
    steps = list(recalled(many, BASE))
    assert len(steps) == MOST_STEPS + 1
    assert steps[0][0] == RECALLED
    assert len(steps[0][1].added) == 2 * MOST_STEPS
