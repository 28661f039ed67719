"""One edit taken out from among others: the rest means what it meant, and nothing is lost."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.core.edited import Window, is_one_a_place, random_plan, write_shelves

from stepfield import moving
from stepfield.project import LayerStyle
from stepfield.taking_out import TakenOut, take_out


@pytest.fixture(scope="module")
def shelves(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_shelves(tmp_path_factory.mktemp("shelves") / "shelves.npy")


@pytest.fixture
def window(shelves: Path) -> Window:
    return Window(shelves)


def taken_out(window: Window, at: int) -> TakenOut:
    return take_out(window.result.field, window.result.automatic, window.project.moves, at)


def chosen(window: Window, layer: int, count: int) -> np.ndarray:
    mask = np.zeros(len(window.result.field), bool)
    mask[window.result.layering.members(layer)[:count]] = True
    return mask


@pytest.mark.parametrize("change", ["merge", "remove", "exchange", "new layer"])
def test_later_edits_speak_of_the_layers_they_spoke_of(window: Window, change: str) -> None:
    """By number they would find others once a merge, a removal or an exchange before them is gone."""
    plans = {
        "merge": lambda: moving.merge(window.result, 1, 0),
        "remove": lambda: moving.remove(window.result, 0),
        "exchange": lambda: moving.exchange(window.result, 0, 2),
        "new layer": lambda: moving.new_layer(window.result, "mine"),
    }
    before = window.result
    window.do(plans[change]())
    third = next(n for n, layer in enumerate(window.result.layers) if len(layer.pillars) and n != 0)
    moved = chosen(window, 0, 5)
    goal = set(window.result.layering.members(third).tolist())
    window.do(moving.move_to(window.result, moved, third))
    went = window.result.layering.layer[moved]
    assert (went == third).all()
    window.open(taken_out(window, 0).applied(window.project))
    after = window.result
    assert len(after.layers) == len(before.layers)
    [number] = set(after.layering.layer[moved].tolist())
    assert len(goal & set(before.layering.members(number).tolist())) > len(goal) / 2, "another layer got them"


def test_styles_follow_their_layers(window: Window) -> None:
    """Names and colours would stand at other layers afterwards."""
    styles = tuple(LayerStyle(index=at, name=name) for at, name in enumerate(("low", "middle", "high")))
    window.open(window.project.model_copy(update={"layers": styles}))
    window.do(moving.exchange(window.result, 0, 2))
    window.do(moving.remove(window.result, 1))
    assert [layer.name for layer in window.result.layers][:2] == ["high", "low"]
    window.open(taken_out(window, 0).applied(window.project))
    assert [layer.name for layer in window.result.layers][:2] == ["low", "high"]


def test_an_edit_that_others_need_says_which(window: Window) -> None:
    """A later one would be lost without a word."""
    window.do(moving.move_to(window.result, chosen(window, 0, 9), "mine"))
    made = len(window.result.layers) - 1
    window.do(moving.merge(window.result, made, 1))
    found = taken_out(window, 0)
    assert not found.moves
    assert found.reason.startswith("“Merge mine into Layer 2” would no longer fit: ")
    assert taken_out(window, 1).moves == window.project.moves[:1]


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 12))
def test_whatever_is_taken_out_the_rest_is_replayed(shelves: Path, seed: int, steps: int) -> None:
    """One pillar a compartment a layer, no pillar lost, no edit that fitted fits no more."""
    window, rng = Window(shelves), np.random.default_rng(seed)
    for _ in range(steps):
        if (plan := random_plan(window.result, window.project.layers, rng)).moves:
            window.do(plan)
    project = window.project
    for at in range(len(project.moves)):
        found = take_out(window.result.field, window.result.automatic, project.moves, at)
        if found.reason:
            continue
        window.open(found.applied(project))
        result = window.result
        assert is_one_a_place(result.field, result.layering)
        assert len(result.layering.layer) == len(result.field)
        assert sum(len(layer.pillars) for layer in result.layers) + result.layering.unassigned == len(
            result.field
        )
        assert len(result.outcomes) == len(project.moves) - 1
        assert result.layering.count == found.count
        assert all(outcome.resolved for outcome in result.outcomes)
        window.open(project)
    fits = [outcome.resolved for outcome in window.result.outcomes]
    assert all(fits), "what was planned for this very result fits it"


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 10))
def test_what_is_done_last_and_taken_out_is_undone(shelves: Path, seed: int, steps: int) -> None:
    """Both ways lead to the same file, but for names of layers that had vanished."""
    window, rng = Window(shelves), np.random.default_rng(seed)
    before = window.project
    for _ in range(steps):
        if (plan := random_plan(window.result, (), rng)).moves:
            before = window.project
            window.do(plan)
    if window.project.moves:
        found = taken_out(window, len(window.project.moves) - 1)
        assert not found.reason
        assert found.applied(window.project).content() == before.content()
