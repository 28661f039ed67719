"""Plans: what is said before is what is done, and nothing is lost on the way."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.core.edited import Window, is_one_a_place, random_plan, write_shelves

from stepfield import moving
from stepfield.layers import UNASSIGNED
from stepfield.project import ExistingLayer, LayerStyle, NewLayer, Project
from stepfield.stack import write_stack

seeds = st.integers(0, 2**32 - 1)


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_shelves(tmp_path_factory.mktemp("scans") / "shelves.npy")


@pytest.fixture
def window(scan: Path) -> Window:
    return Window(scan)


def members(window: Window, layer: int) -> np.ndarray:
    mask: np.ndarray = window.result.layering.layer == layer
    return mask


def counts(thing: object) -> tuple[int, ...]:
    return tuple(getattr(thing, name) for name in ("moved", "swapped", "left", "unassigned"))


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(seeds, st.integers(1, 12))
def test_every_operation_does_what_its_plan_said_and_keeps_one_pillar_a_place(
    scan: Path, seed: int, steps: int
) -> None:
    """A row that says "move 212, swap 14" and moves 211 is worse than one that says nothing."""
    window, rng = Window(scan), np.random.default_rng(seed)
    for _ in range(steps):
        locked = [layer for layer in range(len(window.result.layers)) if rng.random() < 0.1]
        plan = random_plan(window.result, window.project.layers, rng, locked)
        before = window.result.layering
        window.do(plan)
        after = window.result.layering
        assert bool(plan.moves) == (not plan.reason)
        if not plan.moves:
            assert np.array_equal(after.layer, before.layer)
            continue
        outcome = window.result.outcomes[-1]
        assert (counts(outcome), outcome.reason) == (counts(plan), "")
        assert is_one_a_place(window.result.field, after)
        vanished = plan.numbers.count(UNASSIGNED)
        assert after.count == before.count - vanished + (plan.made is not None)
        names = [layer.name for layer in window.result.layers]
        assert len(set(names)) == len(names), "two layers of one name"


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(seeds, st.integers(1, 12))
def test_locked_layers_neither_gain_nor_lose_a_pillar(scan: Path, seed: int, steps: int) -> None:
    window, rng = Window(scan), np.random.default_rng(seed)
    for _ in range(steps):
        locked = int(rng.integers(0, len(window.result.layers)))
        plan = random_plan(window.result, window.project.layers, rng, [locked])
        before = members(window, locked)
        window.do(plan)
        now = plan.numbers[locked] if plan.numbers else locked
        assert np.array_equal(members(window, now), before)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(seeds, st.integers(1, 10))
def test_a_style_stays_with_its_pillars(scan: Path, seed: int, steps: int) -> None:
    """After a merge the colour of the layer above must not jump to the next one."""
    window, rng = Window(scan), np.random.default_rng(seed)
    for _ in range(steps):
        layers = range(len(window.result.layers))
        styles = tuple(LayerStyle(index=n, name=f"Shelf {n}", color=f"#0000{n:02x}") for n in layers)
        window.open(window.project.model_copy(update={"layers": styles}))
        plan = random_plan(window.result, styles, rng)
        old = {f"#0000{n:02x}": members(window, n) for n in layers}
        window.do(plan)
        if plan.moves and plan.moves[0].layer is None:
            assert window.project.layers == styles
        for style in window.project.layers:
            now, then = members(window, style.index), old[style.color or ""]
            assert window.result.layers[style.index].name == style.name
            if plan.moved == 0 or plan.moves[0].conflict == "exchange":
                assert np.array_equal(now, then)
        vanished = plan.numbers.count(UNASSIGNED)
        assert len(window.project.layers) == len(styles) - vanished


def test_more_than_one_of_a_compartment_can_not_go_so_the_fullest_goes(window: Window) -> None:
    result = window.result
    plan = moving.move_to(result, np.ones(len(result.field), bool), "Everything")
    occupied = len(result.field.compartments.occupied)
    assert (plan.moved, plan.stay) == (occupied, len(result.field) - occupied)
    window.do(plan)
    gone = members(window, len(result.layers))
    points, compartment = result.field.points, result.field.compartment
    for pillar in np.flatnonzero(gone):
        assert points[pillar] == points[compartment == compartment[pillar]].max()


def test_what_is_there_already_is_not_driven_out_by_another_chosen_one(window: Window) -> None:
    before = members(window, 0)
    window.do(moving.move_to(window.result, np.ones(len(window.result.field), bool), 0))
    assert (members(window, 0) | ~before).all()


def test_pillars_of_locked_layers_stay_and_are_counted(window: Window) -> None:
    chosen = members(window, 0) | members(window, 1)
    plan = moving.move_to(window.result, chosen, 2, locked={1})
    assert plan.locked == np.count_nonzero(members(window, 1))
    assert plan.sentence.endswith(f"{plan.locked} locked")
    assert moving.move_to(window.result, chosen, 1, locked={1}).reason == "Layer 2 is locked"


@pytest.mark.parametrize(
    ("wish", "reason"),
    [
        (lambda r: moving.move_to(r, np.zeros(len(r.field), bool), 0), "nothing is selected"),
        (lambda r: moving.move_to(r, r.layering.layer == 0, 0), "in Layer 1 already"),
        (lambda r: moving.move_to(r, r.layering.layer == 0, 1, locked=[0]), "in locked layers"),
        (lambda r: moving.move_to(r, r.layering.layer == 0, "Layer 2"), "there is a layer Layer 2 already"),
        (lambda r: moving.merge(r, 1, 1), "into itself"),
        (lambda r: moving.merge(r, 0, 1, locked=[1]), "Layer 2 is locked"),
        (lambda r: moving.merge(r, -1, 1), "Unassigned is no layer"),
        (lambda r: moving.split(r, 0, 99.0, "Roof"), "no pillar of the layer lies above 99 m"),
        (lambda r: moving.split(r, 0, -99.0, "Roof"), "all pillars of Layer 1 lie above"),
        (lambda r: moving.split(r, 0, 0.0, "Layer 1"), "there is a layer Layer 1 already"),
        (lambda r: moving.remove(r, 0, locked=[0]), "Layer 1 is locked"),
        (lambda r: moving.exchange(r, 1, 1), "with itself"),
    ],
)
def test_what_can_not_be_done_says_why(window: Window, wish: object, reason: str) -> None:
    plan = wish(window.result)  # type: ignore[operator]
    assert reason in plan.reason
    assert plan.sentence == plan.reason
    assert plan.moves == ()
    assert plan.applied(window.project) == window.project


def test_the_last_layer_stays(window: Window) -> None:
    while len(window.result.layers) > 1:
        window.do(moving.remove(window.result, 0))
    assert moving.remove(window.result, 0).reason == "the last layer has to stay"


def test_merge_keeps_the_fuller_pillar_of_each_place(window: Window) -> None:
    result, field = window.result, window.result.field
    zero, one = members(window, 0), members(window, 1)
    plan = moving.merge(result, 0, 1)
    assert plan.text == "Merge Layer 1 into Layer 2"
    window.do(plan)
    lost = (zero | one) & members(window, UNASSIGNED)
    assert np.count_nonzero(lost) == plan.unassigned > 0
    for loser in np.flatnonzero(lost):
        rivals = np.flatnonzero((zero | one) & (field.compartment == field.compartment[loser]))
        (winner,) = set(rivals.tolist()) - {int(loser)}
        assert (field.points[winner], -winner) > (field.points[loser], -loser)


def test_split_parts_a_layer_at_an_elevation_of_the_scan(window: Window) -> None:
    result = window.result
    z = result.field.elevation + result.field.compartments.lowest
    level = float(np.median(z[members(window, 1)]))
    high = members(window, 1) & (z > level)
    window.do(moving.split(result, 1, level, "Upper"))
    assert np.array_equal(members(window, len(result.layers)), high)
    assert window.result.layers[-1].name == "Upper"


def test_a_layer_made_by_hand_is_found_by_name_whatever_it_is_called_since(window: Window) -> None:
    """Its number changes with the number of automatic layers, and an empty one has no elevation."""
    window.do(moving.new_layer(window.result, "Shelf"))
    made = len(window.result.layers) - 1
    renamed = window.project.model_copy(update={"layers": (LayerStyle(index=made, name="Rack"),)})
    window.open(renamed)
    plan = moving.move_to(window.result, members(window, 0), made)
    assert plan.text.endswith("pillars to Rack")
    assert plan.moves[0].to == NewLayer(new="Shelf")
    window.do(plan)
    other = window.project.parameters.model_copy(update={"max_layers": made - 1})
    window.open(window.project.model_copy(update={"parameters": other, "layers": ()}))
    assert [layer.name for layer in window.result.layers][-1] == "Shelf"
    assert len(window.result.layers[-1].pillars) == plan.moved


def test_an_empty_automatic_layer_is_found_again_by_what_goes_there(window: Window) -> None:
    window.do(moving.move_to(window.result, members(window, 2), UNASSIGNED))
    plan = moving.move_to(window.result, members(window, 1), 2)
    to = plan.moves[0].to
    assert isinstance(to, ExistingLayer)
    assert to.elevation == pytest.approx(0.8, abs=0.3)


def test_a_new_layer_does_not_take_the_style_of_one_there_was(window: Window) -> None:
    past = LayerStyle(index=len(window.result.layers), name="Roof", visible=False)
    project = window.project.model_copy(update={"layers": (past,)})
    assert moving.new_layer(window.result, "Shelf").applied(project).layers == ()


def test_names_of_new_layers_are_free(window: Window) -> None:
    layers = len(window.result.layers)
    assert moving.free_name(window.result, ()) == f"Layer {layers + 1}"
    taken = LayerStyle(index=0, name=f"Layer {layers + 1}")
    assert moving.free_name(window.result, [taken]) == f"Layer {layers + 2}"


def test_the_command_writes_the_same_bytes_as_the_window(window: Window, tmp_path: Path) -> None:
    """The window arrives step by step, with undo between; the command applies the saved file at once."""
    rng = np.random.default_rng(11)
    style = LayerStyle(index=1, name="Middle", color="#123456")
    window.open(window.project.model_copy(update={"layers": (style,)}))
    for _ in range(12):
        before = window.project
        window.do(random_plan(window.result, window.project.layers, rng))
        if rng.random() < 0.3:
            window.open(before)
    write_stack(window.result, tmp_path / "window")
    window.project.save(tmp_path / "a.stepfield")
    window.project = Project.read(tmp_path / "a.stepfield")
    write_stack(window.fresh(), tmp_path / "command")
    ours, theirs = (sorted((tmp_path / name).iterdir()) for name in ("window", "command"))
    assert [path.name for path in ours] == [path.name for path in theirs]
    for one, other in zip(ours, theirs, strict=True):
        assert one.read_bytes() == other.read_bytes()


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(seeds, st.sampled_from(["swap", "leave"]))
def test_a_forecast_counts_what_the_plan_counts(
    scan: Path, seed: int, conflict: Literal["swap", "leave"]
) -> None:
    """The row under the pointer is told the forecast; the drop carries out the plan."""
    result, rng = Window(scan).result, np.random.default_rng(seed)
    chosen = rng.random(len(result.field)) < rng.random()
    for target in (*range(len(result.layers)), UNASSIGNED, "Another"):
        locked = [layer for layer in range(len(result.layers)) if rng.random() < 0.2]
        told = moving.forecast(result, chosen, target, conflict=conflict, locked=locked)
        plan = moving.move_to(result, chosen, target, conflict=conflict, locked=locked)
        assert told == replace(plan, moves=())


def test_large_numbers_are_written_as_the_window_writes_them() -> None:
    """A hand that carries 1 328 pillars would be told that it moves 1328."""
    plan = moving.Plan("", moved=1328, swapped=106, stay=2036)
    assert plan.sentence == "move 1\u202f328, swap 106, 2\u202f036 stay"
