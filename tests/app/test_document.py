"""The document: one truth, named steps, and what is on screen always of one set of parameters."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from stepfield.errors import GridError, ParameterError, ScanError
from stepfield.parameters import Parameters
from stepfield.project import LayerStyle
from stepfield.scan import read_scan
from stepfield_app.document import Document
from stepfield_app.requests import Answer, request_for
from stepfield_app.runner import Runner

BASE = Parameters(cell_size=0.2, layer_tolerance=0.3, alpha=0.1)


@pytest.fixture
def table(tmp_path: Path) -> Path:
    rng = np.random.default_rng(3)
    floor = np.c_[rng.random((3000, 2)) * 3, rng.normal(0, 0.01, 3000)]
    top = np.c_[rng.random((1000, 2)) + 1, rng.normal(0.75, 0.01, 1000)]
    path = tmp_path / "table.npy"
    np.save(path, np.vstack([floor, top]))
    return path


@pytest.fixture
def document(qtbot: QtBot) -> Iterator[Document]:
    """A document that answers at once."""
    document = Document(Runner(threaded=False))
    yield document
    document.close()


@pytest.fixture
def opened(document: Document, table: Path) -> Document:
    document.open([table], BASE)
    return document


def collected(signal: Any) -> list[Any]:
    said: list[Any] = []
    signal.connect(lambda *values: said.append(values[0] if values else None))
    return said


def test_an_opened_scan_has_an_answer_no_steps_and_nothing_pending(document: Document, table: Path) -> None:
    order: list[str] = []
    for name in ("project_changed", "facts_changed", "answer_changed", "opened"):
        getattr(document, name).connect(lambda *_, name=name: order.append(name))
    document.open([table], BASE)
    assert order == ["project_changed", "facts_changed", "answer_changed", "opened"]
    assert document.scans == (table,)
    assert document.answer is not None
    assert document.answer.request == request_for(document.project)
    assert (document.pending, document.undo_stack.count(), document.opening) == (False, 0, False)


def test_all_of_an_opened_scan_is_there_when_the_first_signal_comes(document: Document, table: Path) -> None:
    """A panel that looks at the document in the first slot must not see half of two scans."""
    document.project_changed.connect(
        lambda project: seen.append((document.answer is not None, document.facts is not None))
    )
    seen: list[tuple[bool, bool]] = []
    document.open([table], BASE)
    assert seen == [(True, True)]


def test_a_drag_is_one_step_and_a_second_drag_another(opened: Document) -> None:
    for start in (0.2, 0.5):
        gesture = opened.begin_gesture()
        for tick in range(1, 50):
            opened.set_parameters(f"Alpha {start + tick / 100:.2f} m", gesture, alpha=start + tick / 100)
        opened.end_gesture(gesture)
    stack = opened.undo_stack
    assert [stack.text(i) for i in range(stack.count())] == ["Alpha 0.69 m", "Alpha 0.99 m"]
    stack.undo()
    assert opened.project.parameters.alpha == 0.69
    stack.undo()
    assert opened.project.parameters == BASE
    stack.redo()
    assert opened.project.parameters.alpha == 0.69


def test_a_drag_there_and_back_is_no_step(opened: Document) -> None:
    gesture = opened.begin_gesture()
    for alpha in (0.2, 0.3, 0.1):
        opened.set_parameters("Alpha", gesture, alpha=alpha)
    opened.end_gesture(gesture)
    assert opened.undo_stack.count() == 0
    assert opened.undo_stack.isClean()


def test_a_drag_that_comes_through_its_start_is_undone_to_it(opened: Document) -> None:
    gesture = opened.begin_gesture()
    for alpha in (0.2, 0.1, 0.4, 0.5):
        opened.set_parameters("Alpha", gesture, alpha=alpha)
    opened.end_gesture(gesture)
    assert opened.undo_stack.count() == 1
    opened.undo_stack.undo()
    assert opened.project.parameters.alpha == 0.1


def test_single_edits_are_steps_of_their_own(opened: Document) -> None:
    opened.set_parameters("Rank", layering="rank")
    opened.set_parameters("8 bits", bits=8)
    opened.set_parameters("8 bits", bits=8)
    assert opened.undo_stack.count() == 2


def test_undoing_everything_gives_the_same_heights_again(opened: Document) -> None:
    def gray() -> list[bytes]:
        assert opened.answer is not None
        return [made.gray.tobytes() for made in opened.answer.result.height_maps()]

    before = gray()
    opened.set_parameters("Cell", cell_size=0.5)
    opened.set_parameters("Tolerance", layer_tolerance=2.0)
    assert gray() != before
    opened.undo_stack.undo()
    opened.undo_stack.undo()
    assert gray() == before


def test_an_impossible_value_is_refused_in_one_sentence(opened: Document) -> None:
    errors, projects = collected(opened.failed), collected(opened.project_changed)
    opened.set_parameters("Cell", cell_size=-1.0)
    assert [type(error) for error in errors] == [ParameterError]
    assert opened.undo_stack.count() == 0
    assert projects == [opened.project], "a panel must be told to show the old value again"


def test_parameters_that_fail_leave_the_last_result_and_stay_pending(opened: Document) -> None:
    errors, before = collected(opened.failed), opened.answer
    opened.set_parameters("Cell", cell_size=1e-7)
    assert [type(error) for error in errors] == [GridError]
    assert opened.answer is before
    assert opened.pending
    opened.undo_stack.undo()
    assert not opened.pending


@pytest.mark.parametrize("content", [b"not a scan", b""])
def test_a_malformed_scan_leaves_the_present_document_as_it_was(
    opened: Document, tmp_path: Path, content: bytes
) -> None:
    opened.set_parameters("Alpha", alpha=0.5)
    project, answer, errors = opened.project, opened.answer, collected(opened.failed)
    broken = tmp_path / "broken.npy"
    broken.write_bytes(content)
    opened.open([broken])
    assert [type(error) for error in errors] == [ScanError]
    assert (opened.project, opened.answer) == (project, answer)
    assert (opened.opening, opened.pending, opened.undo_stack.count()) == (False, False, 1)
    opened.undo_stack.undo()
    assert opened.answer is not None
    assert opened.answer.result.parameters.alpha == 0.1


def test_opening_another_scan_starts_afresh(opened: Document, tmp_path: Path) -> None:
    opened.set_parameters("Alpha", alpha=0.5)
    opened.set_active_layer(1)
    other = tmp_path / "other.npy"
    np.save(other, np.random.default_rng(0).random((500, 3)))
    facts = opened.facts
    opened.open([other])
    assert opened.scans == (other,)
    assert opened.undo_stack.count() == 0
    assert opened.active_layer == 0
    assert opened.facts is not facts
    assert opened.answer is not None
    assert len(opened.answer.result.scan) == 500


def test_auto_becomes_numbers_in_the_answer_and_stays_auto_in_the_project(
    document: Document, table: Path
) -> None:
    document.open([table])
    assert document.answer is not None
    assert document.project.parameters.cell_size == "auto"
    assert isinstance(document.answer.result.parameters.cell_size, float)


def test_only_names_of_layers_reach_the_method(opened: Document) -> None:
    """Showing and hiding a layer must not make its geometry anew."""
    answers = collected(opened.answer_changed)
    opened.set_style("Hide Layer 1", 0, visible=False)
    opened.set_style("Colour", 0, color="#ff0000")
    assert not answers
    assert not opened.pending
    opened.set_style("Rename", 0, name="Floor")
    assert answers[-1].result.layers[0].name == "Floor"
    assert opened.style(0) == LayerStyle(index=0, name="Floor", color="#ff0000", visible=False)
    opened.undo_stack.undo()
    assert answers[-1].result.layers[0].name == "Layer 1"


def test_the_active_layer_stays_one_there_is(opened: Document) -> None:
    changes = collected(opened.active_layer_changed)
    opened.set_active_layer(1)
    opened.set_parameters("Tolerance", layer_tolerance=2.0)
    assert changes == [1, 0]
    opened.set_active_layer(-1)
    opened.set_parameters("Tolerance", layer_tolerance=0.3)
    assert opened.active_layer == -1


def test_closing_a_scan_leaves_nothing_of_it(opened: Document) -> None:
    answers = collected(opened.answer_changed)
    opened.set_parameters("Alpha", alpha=0.5)
    opened.close_scan()
    assert answers[-1] is None
    assert (opened.scans, opened.answer, opened.facts, opened.pending) == ((), None, None, False)
    assert opened.undo_stack.count() == 0


def slow_files(monkeypatch: pytest.MonkeyPatch, slow: Path) -> None:
    """Make reading one file go on until it is cancelled."""
    original = read_scan

    def reading(paths: Any, unit: Any, up: Any, progress: Any) -> Any:
        while slow in paths:
            progress(0.0, "reading")
            time.sleep(0.001)
        return original(paths, unit, up, progress)

    monkeypatch.setattr("stepfield.pipeline.read_scan", reading)


def test_a_cancelled_load_keeps_the_old_scan_alive(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, table: Path, tmp_path: Path
) -> None:
    slow = tmp_path / "slow.npy"
    slow_files(monkeypatch, slow)
    document = Document()
    with qtbot.waitSignal(document.opened):
        document.open([table], BASE)
    errors, openings = collected(document.failed), collected(document.opening_changed)
    document.open([slow])
    qtbot.waitUntil(lambda: document.busy)
    document.set_parameters("Alpha", alpha=0.5)
    assert document.opening
    document.cancel()
    qtbot.waitUntil(lambda: not document.busy and not document.pending)
    assert document.scans == (table,)
    assert document.answer is not None
    assert document.answer.result.parameters.alpha == 0.5, "the edit made meanwhile must be answered"
    assert openings == [True, False]
    assert not errors
    document.close()


def test_a_cancelled_result_goes_back_to_what_is_shown(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, table: Path
) -> None:
    """Else the window would wait for ever for a result that nobody makes."""
    document = Document()
    with qtbot.waitSignal(document.opened):
        document.open([table], BASE)
    slow_files(monkeypatch, table)
    document.set_parameters("Up", up="-z")
    qtbot.waitUntil(lambda: document.busy)
    document.cancel()
    qtbot.waitUntil(lambda: not document.busy)
    assert not document.pending
    assert document.project.parameters == BASE
    document.undo_stack.undo()
    assert document.project.parameters.up == "-z", "what was given up cannot be had back"
    document.cancel()
    document.close()


def test_a_second_load_replaces_the_first(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, table: Path, tmp_path: Path
) -> None:
    slow = tmp_path / "slow.npy"
    slow_files(monkeypatch, slow)
    document = Document()
    openings = collected(document.opened)
    document.open([slow])
    qtbot.waitUntil(lambda: document.busy)
    document.open([table], BASE)
    qtbot.waitUntil(lambda: document.scans == (table,))
    qtbot.waitUntil(lambda: not document.busy)
    assert len(openings) == 1
    document.close()


def test_back_at_what_is_on_screen_nothing_else_takes_its_place(qtbot: QtBot, table: Path) -> None:
    """Otherwise undoing quickly would leave the answer of a step that was undone."""
    document = Document()
    with qtbot.waitSignal(document.opened):
        document.open([table], BASE)
    qtbot.waitUntil(lambda: not document.busy)
    answers: list[Answer] = collected(document.answer_changed)
    document.set_parameters("Tolerance", layer_tolerance=0.5)
    document.undo_stack.undo()
    assert not document.pending
    qtbot.waitUntil(lambda: not document.busy)
    assert not answers
    assert not document.pending
    document.close()
