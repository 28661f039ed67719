"""The runner: quick while a hand moves, exact once it rests, and never an answer nobody wants."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from stepfield.errors import GridError, ScanError
from stepfield.parameters import Parameters
from stepfield_app import runner as module
from stepfield_app.facts import ScanFacts
from stepfield_app.requests import Answer, Request
from stepfield_app.runner import Runner

BASE = Parameters(cell_size=0.2, layer_tolerance=0.3, alpha=0.1)


@pytest.fixture(autouse=True)
def small_scans_count_as_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PREVIEW_POINTS", 500)
    monkeypatch.setattr(module, "SMALL_SCAN", 1000)


def scan(path: Path, points: int) -> Path:
    rng = np.random.default_rng(1)
    np.save(path, np.c_[rng.random((points, 2)) * 3, rng.integers(0, 2, points)])
    return path


@pytest.fixture
def large(tmp_path: Path) -> Request:
    return Request((scan(tmp_path / "large.npy", 3000),), BASE)


@pytest.fixture
def small(tmp_path: Path) -> Request:
    return Request((scan(tmp_path / "small.npy", 800),), BASE)


class Listener:
    """What a runner said."""

    def __init__(self, runner: Runner) -> None:
        self.answers: list[Answer] = []
        self.facts: list[ScanFacts] = []
        self.errors: list[BaseException] = []
        runner.answered.connect(self._take)
        runner.failed.connect(lambda request, error: self.errors.append(error))

    def _take(self, answer: Answer, facts: ScanFacts) -> None:
        self.answers.append(answer)
        self.facts.append(facts)

    def quick(self) -> list[bool]:
        """Return which answers since the last look were previews."""
        said = [answer.request.quick for answer in self.answers]
        self.answers.clear()
        return said


@pytest.fixture
def runner(qtbot: QtBot) -> Iterator[Runner]:
    runner = Runner(threaded=False)
    yield runner
    runner.close()


@pytest.fixture
def heard(runner: Runner) -> Listener:
    return Listener(runner)


def changed(request: Request, **values: Any) -> Request:
    return replace(request, parameters=request.parameters.model_copy(update=values))


def test_a_large_scan_opens_with_a_preview_and_the_exact_result_follows(
    runner: Runner, heard: Listener, large: Request
) -> None:
    runner.ask(large)
    preview, exact = heard.answers
    assert (preview.request, exact.request) == (replace(large, quick=True), large)
    assert len(preview.result.field.compartments.ticks) < 600
    assert len(exact.result.field.compartments.ticks) == 3000
    assert preview.result.field.compartments.grid == exact.result.field.compartments.grid


def test_what_needs_no_sorting_is_exact_even_while_a_hand_moves(
    runner: Runner, heard: Listener, large: Request
) -> None:
    runner.ask(large)
    heard.quick()
    for values in ({"layer_tolerance": 0.4}, {"alpha": 0.5}, {"layering": "rank"}):
        runner.ask(changed(large, **values), settled=False)
    assert heard.quick() == [False, False, False]


def test_a_cell_size_is_previewed_while_a_hand_moves_and_exact_when_it_rests(
    runner: Runner, heard: Listener, large: Request
) -> None:
    runner.ask(large)
    heard.quick()
    for cell in (0.3, 0.4, 0.5):
        runner.ask(changed(large, cell_size=cell), settled=False)
    assert heard.quick() == [True, True, True]
    runner.settle()
    assert [answer.request for answer in heard.answers] == [changed(large, cell_size=0.5)]


def test_a_typed_cell_size_is_previewed_and_then_exact(
    runner: Runner, heard: Listener, large: Request
) -> None:
    runner.ask(large)
    heard.quick()
    runner.ask(changed(large, cell_size=0.5))
    assert heard.quick() == [True, False]


def test_going_back_to_the_sorted_cell_size_is_exact_at_once(
    runner: Runner, heard: Listener, large: Request
) -> None:
    runner.ask(large)
    runner.ask(changed(large, cell_size=0.5), settled=False)
    heard.quick()
    runner.ask(large, settled=False)
    assert heard.quick() == [False]


def test_small_scans_are_always_exact_after_opening(runner: Runner, heard: Listener, small: Request) -> None:
    runner.ask(small)
    heard.quick()
    runner.ask(changed(small, cell_size=0.5), settled=False)
    runner.settle()
    assert heard.quick() == [False]


def test_settling_twice_asks_once(runner: Runner, heard: Listener, large: Request) -> None:
    runner.ask(large)
    runner.ask(changed(large, cell_size=0.5), settled=False)
    heard.quick()
    runner.settle()
    runner.settle()
    assert heard.quick() == [False]


@pytest.mark.parametrize("running", ["preview", "exact", None])
def test_a_release_does_not_wait_for_a_preview_of_what_the_hand_left_behind(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, large: Request, running: str | None
) -> None:
    """The exact result would come that much later; an exact run that is on its way sorts what is wanted."""
    runner = Runner()
    heard = Listener(runner)
    runner.ask(large)
    qtbot.waitUntil(lambda: heard.quick()[-1:] == [False])
    wanted = changed(large, cell_size=0.5)
    preview = replace(wanted, quick=True)
    asked: list[tuple[Request, bool]] = []
    cancelled: list[bool] = []
    runs = {
        "preview": replace(changed(large, cell_size=0.4), quick=True),
        "exact": changed(wanted, alpha=0.9),
    }
    monkeypatch.setattr(runner._worker, "ask", lambda request, at_once: asked.append((request, at_once)))
    monkeypatch.setattr(runner._worker, "cancel", lambda: cancelled.append(True))
    monkeypatch.setattr(type(runner._worker), "running", runs.get(running or ""))
    monkeypatch.setattr(type(runner._worker), "waiting", preview)
    runner.ask(wanted, settled=False)
    assert not cancelled, "while the hand moves the running preview is finished and shown"
    asked.clear()
    runner.settle()
    assert asked == ([] if running == "exact" else [(preview, True)])
    assert bool(cancelled) is (running != "exact")
    monkeypatch.undo()
    runner.close()


def test_after_cancelling_nothing_follows(runner: Runner, heard: Listener, large: Request) -> None:
    runner.ask(large)
    runner.ask(changed(large, cell_size=0.5), settled=False)
    heard.quick()
    runner.cancel()
    runner.settle()
    assert heard.quick() == []


def test_too_few_points_for_a_preview_do_not_hinder_the_exact_result(
    runner: Runner, heard: Listener, large: Request
) -> None:
    fussy = changed(large, min_points=3, layer_tolerance=5.0)
    runner.ask(fussy)
    assert not heard.errors
    assert heard.quick()[-1] is False


def test_an_absurd_cell_size_is_one_failure_and_the_sorted_points_are_kept(
    runner: Runner, heard: Listener, large: Request
) -> None:
    runner.ask(large)
    heard.quick()
    runner.ask(changed(large, cell_size=1e-7))
    assert [type(error) for error in heard.errors] == [GridError]
    runner.ask(changed(large, layer_tolerance=0.4))
    assert heard.quick() == [False]


def test_a_scan_that_cannot_be_read_fails_once_and_leaves_the_present_one_sorted(
    runner: Runner, heard: Listener, large: Request, tmp_path: Path
) -> None:
    runner.ask(large)
    facts = heard.facts[-1]
    heard.quick()
    runner.ask(Request((tmp_path / "absent.npy",), BASE))
    assert [type(error) for error in heard.errors] == [ScanError]
    runner.ask(changed(large, layer_tolerance=0.4), settled=False)
    assert heard.quick() == [False]
    assert heard.facts[-1] is facts, "the scan was read again"


def test_facts_are_those_of_the_whole_scan_and_the_same_for_every_crop(
    runner: Runner, heard: Listener, large: Request
) -> None:
    runner.ask(large)
    runner.ask(changed(large, crop=(0, 0, -1, 1, 1, 0.5)))
    assert len(heard.answers[-1].result.scan) < 3000
    assert len(set(map(id, heard.facts))) == 1
    assert heard.facts[0].points == 3000
    assert heard.facts[0].bounds[2::3] == (0.0, 1.0)


def test_an_exact_run_is_cancelled_by_a_newer_cell_size_but_not_by_a_newer_tolerance(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, large: Request
) -> None:
    """Cancelling for a tolerance would throw away the sorted points it needs as well."""
    runner = Runner()
    heard = Listener(runner)
    asked: list[Request] = []
    cancelled: list[bool] = []
    runner.ask(large)
    qtbot.waitUntil(lambda: heard.quick()[-1:] == [False])
    monkeypatch.setattr(runner._worker, "ask", lambda request, at_once: asked.append(request))
    monkeypatch.setattr(runner._worker, "cancel", lambda: cancelled.append(True))
    monkeypatch.setattr(type(runner._worker), "running", changed(large, cell_size=0.5))
    runner.ask(changed(large, cell_size=0.5, layer_tolerance=0.4))
    assert not cancelled
    runner.ask(changed(large, cell_size=0.6))
    assert cancelled == [True]
    assert [request.quick for request in asked] == [False, True]
    monkeypatch.undo()
    runner.close()


def test_very_many_pillars_are_layered_by_elevation_until_the_hand_rests(
    runner: Runner, heard: Listener, large: Request, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By surface they would take so long that nothing followed the hand."""
    runner.ask(large)
    exact = heard.answers[-1].result
    monkeypatch.setattr(module, "LITTLE_LABOUR", len(exact.field) - 1)
    heard.quick()
    finer = changed(large, layer_tolerance=0.2)
    runner.ask(finer, settled=False)
    [preview] = heard.answers
    assert preview.request == replace(finer, quick=True)
    assert preview.result.parameters.layering == "elevation"
    assert len(preview.result.field.compartments.ticks) == 3000, "no point has to be left out for that"
    runner.ask(replace(finer, styles=()), settled=True)
    assert heard.quick()[-1] is False
    runner.ask(changed(finer, alpha=0.3), settled=False)
    assert heard.quick() == [False], "another alpha leaves the layers as they are"
    runner.ask(changed(finer, layering="elevation", layer_tolerance=0.25), settled=False)
    assert heard.quick() == [False], "by elevation there is nothing to wait for"


def test_layers_with_many_seams_take_long_too(
    runner: Runner, heard: Listener, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a tangle of a hundred thousand pillars hardly one result a second followed the hand."""
    np.save(tmp_path / "tangle.npy", np.random.default_rng(1).random((900, 3)) * 3)
    tangle = Request((tmp_path / "tangle.npy",), BASE)
    runner.ask(tangle)
    exact = heard.answers[-1].result
    assert len(exact.seams)
    labour = len(exact.field) + module.SEAM_LABOUR * len(exact.seams)
    for most, is_preview in ((labour - 1, True), (labour, False)):
        monkeypatch.setattr(module, "LITTLE_LABOUR", most)
        heard.quick()
        runner.ask(changed(tangle, layer_tolerance=0.2 + 0.01 * is_preview), settled=False)
        assert heard.quick() == [is_preview]


def test_one_way_of_layering_follows_a_hand_until_it_rests(
    runner: Runner, heard: Listener, large: Request, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Layers would change to and fro under the hand: previews have fewer pillars than what they stand for."""
    runner.ask(large)
    monkeypatch.setattr(module, "LITTLE_LABOUR", len(heard.answers[-1].result.field) - 1)
    heard.quick()
    for cell in (0.22, 0.3, 0.6):
        runner.ask(changed(large, cell_size=cell), settled=False)
    assert [answer.result.parameters.layering for answer in heard.answers] == ["elevation"] * 3
    assert len(heard.answers[-1].result.field) < module.LITTLE_LABOUR
    runner.settle()
    assert heard.answers[-1].result.parameters.layering == "surface"
