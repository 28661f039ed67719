"""Edits nobody has saved survive the window: kept within seconds, offered once, to one window only."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Callable, Iterator
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import table

from stepfield.moving import move_to
from stepfield.parameters import Parameters
from stepfield.project import Project
from stepfield_app.document import Document
from stepfield_app.filed import Stored
from stepfield_app.opening import work_at
from stepfield_app.recovery import Draft, Recovery
from stepfield_app.recovery import recovery as module
from stepfield_app.recovery.drafts import LOCK, SUFFIX
from stepfield_app.runner import Runner

BASE = Parameters(cell_size=0.5, layer_tolerance=0.3, alpha=0.5)


class Bench:
    """A document and what keeps its edits, as a window has them."""

    def __init__(self, qtbot: QtBot, folder: Path) -> None:
        self.qtbot, self.folder = qtbot, folder
        self.document = Document(Runner(threaded=False))
        self.recovery = Recovery(self.document, lambda: {"layer": 1}, folder)
        self.offered: list[Draft] = []
        self.told: list[str] = []
        self.recovery.found.connect(self.offered.append)
        self.recovery.failed.connect(lambda error: self.told.append(str(error)))

    def edit(self, alpha: float) -> None:
        self.document.set_parameters(f"Alpha {alpha}", alpha=alpha)

    def keep(self) -> None:
        """Let the time pass after which edits are kept."""
        self.recovery.keep()
        self.settle()

    def settle(self) -> None:
        self.qtbot.waitUntil(lambda: not self.recovery._keeper.busy)

    def look(self) -> list[Draft]:
        """Find what others have left."""
        before = len(self.offered)
        self.recovery.look_for_leftovers()
        self.qtbot.waitUntil(lambda: not self.recovery._finder.busy)
        return self.offered[before:]

    def recover(self, draft: Draft) -> None:
        self.document.open_work(draft.work)
        self.settle()

    def die(self) -> None:
        """Vanish as a killed process does: the lock goes, the draft stays."""
        slot, self.recovery._slot = self.recovery._slot, None
        if slot is not None:
            slot.release(remove=False)
        self.document.file.give_up()
        self.close()

    def close(self) -> None:
        self.recovery.close()
        self.document.close()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "recovery"


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    np.save(tmp_path / "table.npy", table())
    return tmp_path / "table.npy"


@pytest.fixture
def made(qtbot: QtBot, folder: Path, scan: Path) -> Iterator[Callable[[], Bench]]:
    """Make windows with the table in them."""
    benches: list[Bench] = []

    def make(*, is_empty: bool = False) -> Bench:
        bench = Bench(qtbot, folder)
        benches.append(bench)
        if not is_empty:
            bench.document.open([scan], BASE)
        return bench

    yield make
    for bench in benches:
        bench.close()


Made = Callable[..., Bench]


def drafts(folder: Path) -> list[Path]:
    return list(folder.glob(f"*{SUFFIX}"))


def test_nothing_is_written_without_edits(made: Made, folder: Path) -> None:
    bench = made()
    bench.keep()
    assert not folder.exists()


def test_a_change_is_kept_within_seconds(made: Made, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Half a minute of work is the most that may be lost."""
    assert module.QUIET <= 5
    assert module.LATEST <= 20
    bench = made()
    bench.recovery._quiet.setInterval(1)
    bench.edit(0.7)
    bench.qtbot.waitUntil(lambda: bool(drafts(folder)))
    bench.settle()
    kept = Project.read(drafts(folder)[0])
    assert kept.parameters.alpha == 0.7
    assert kept.scans[0].path == str(bench.document.scans[0])


def test_a_hand_that_never_rests_does_not_put_it_off(made: Made, folder: Path) -> None:
    """If it failed, a long drag would be lost whole."""
    bench = made()
    bench.recovery._latest.setInterval(100)
    bench.edit(0.7)
    for number in range(1, 200):
        bench.edit(0.7 + number / 1000)
        if drafts(folder):
            break
        bench.qtbot.wait(2)
    assert drafts(folder)
    assert bench.recovery._latest.interval() < bench.recovery._quiet.interval()


def test_undone_and_saved_edits_are_not_kept(made: Made, folder: Path) -> None:
    bench = made()
    bench.edit(0.7)
    bench.keep()
    assert drafts(folder)
    bench.document.undo_stack.undo()
    bench.settle()
    assert not drafts(folder)
    bench.edit(0.8)
    bench.keep()
    bench.document.file.note(bench.document.project, Stored(folder / "a.stepfield", ""))
    bench.settle()
    assert not drafts(folder)


def test_a_window_that_closes_in_peace_leaves_nothing(made: Made, folder: Path) -> None:
    bench = made()
    bench.edit(0.7)
    bench.keep()
    bench.document.file.give_up()
    bench.close()
    assert list(folder.iterdir()) == []


def test_a_window_that_is_ended_by_a_signal_keeps_the_last_edit(made: Made, folder: Path) -> None:
    bench = made()
    bench.edit(0.7)
    bench.close()
    (draft,) = made(is_empty=True).look()
    assert draft.work.project.parameters.alpha == 0.7


def test_what_a_dead_window_left_is_offered_and_comes_back(made: Made, folder: Path, scan: Path) -> None:
    bench, after = made(), made(is_empty=True)
    bench.edit(0.7)
    bench.edit(0.8)
    bench.keep()
    bench.die()
    (draft,) = after.look()
    now = draft.kept_at
    assert draft.sentence(now) == f"Recover the unsaved edits of table.npy from {now:%H:%M}?"
    assert f"on {now.day} {now:%B %Y}" in draft.sentence(datetime(2020, 3, 3))
    after.recover(draft)
    assert after.document.project.parameters.alpha == 0.8
    assert after.document.scans == (scan,)
    assert after.document.project.view == {"layer": 1}
    assert after.document.file.dirty, "it is in no file yet"
    (kept,) = drafts(folder)
    assert kept != draft.slot.path, "it was kept anew before the old one went"
    after.document.file.give_up()
    after.close()
    assert list(folder.iterdir()) == []


def test_edits_that_came_back_are_offered_again_after_another_crash(made: Made) -> None:
    first, second, third = made(), made(is_empty=True), made(is_empty=True)
    first.edit(0.7)
    first.keep()
    first.die()
    second.recover(second.look()[0])
    second.edit(0.9)
    second.keep()
    second.die()
    (draft,) = third.look()
    assert draft.work.project.parameters.alpha == 0.9


def test_a_draft_knows_its_project_file_and_what_it_held(made: Made, tmp_path: Path) -> None:
    """Saving what came back must notice that another window has changed the file since."""
    file = tmp_path / "room.stepfield"
    bench = made()
    bench.document.project.save(file)
    bench.document.open_work(work_at(file))
    stored = bench.document.file.stored
    bench.edit(0.7)
    bench.keep()
    bench.die()
    after = made(is_empty=True)
    (draft,) = after.look()
    assert draft.name == "room.stepfield"
    after.recover(draft)
    assert after.document.file.stored == stored


def test_what_came_back_can_be_undone_step_by_step(made: Made, tmp_path: Path) -> None:
    """Back to what the file holds, as in the window that crashed."""
    file = tmp_path / "room.stepfield"
    bench = made()
    bench.document.project.save(file)
    bench.document.open_work(work_at(file))
    answer = bench.document.answer
    assert answer is not None
    for target in (0, "Shelf"):
        plan = move_to(answer.result, answer.result.layering.layer == 1, target)
        bench.document.edit(plan.text, plan.applied(bench.document.project))
    bench.edit(0.7)
    bench.keep()
    bench.die()
    after = made(is_empty=True)
    after.recover(after.look()[0])
    stack = after.document.undo_stack
    texts = [stack.text(step) for step in range(stack.count())]
    assert texts == ["Edits recovered", *(move.text for move in after.document.project.moves)]
    while stack.canUndo():
        stack.undo()
    assert after.document.project.moves == ()
    assert after.document.project.parameters == BASE
    assert after.document.answer is not None
    assert np.array_equal(
        after.document.answer.result.layering.layer, after.document.answer.result.automatic.layer
    )


def test_windows_do_not_take_each_others_edits(made: Made) -> None:
    living, dead, one, two = made(), made(), made(is_empty=True), made(is_empty=True)
    for alpha, bench in ((0.7, living), (0.8, dead)):
        bench.edit(alpha)
        bench.keep()
    dead.die()
    (draft,) = one.look()
    assert draft.work.project.parameters.alpha == 0.8
    assert two.look() == [], "what one window offers another must not"
    one.recovery.leave(draft)
    assert len(two.look()) == 1, "left for later it is offered again"
    living.edit(0.75)
    living.keep()


def test_discarded_edits_are_gone(made: Made, folder: Path) -> None:
    bench, after = made(), made(is_empty=True)
    bench.edit(0.7)
    bench.keep()
    bench.die()
    after.recovery.discard(after.look()[0])
    assert list(folder.iterdir()) == []


def test_edits_that_could_not_be_opened_are_offered_again(made: Made, scan: Path) -> None:
    """Their scan is on a disk that is not there today."""
    bench, after, later = made(), made(is_empty=True), made(is_empty=True)
    bench.edit(0.7)
    bench.keep()
    bench.die()
    hidden = scan.with_name("hidden")
    scan.rename(hidden)
    after.recover(after.look()[0])
    assert after.document.answer is None
    after.close()
    hidden.rename(scan)
    later.recover(later.look()[0])
    assert later.document.project.parameters.alpha == 0.7


def test_edits_that_were_saved_at_the_last_moment_are_not_offered(
    made: Made, folder: Path, tmp_path: Path
) -> None:
    bench = made()
    file = tmp_path / "room.stepfield"
    bench.document.project.save(file)
    bench.document.open_work(work_at(file))
    bench.edit(0.7)
    bench.keep()
    bench.document.project.save(file)
    bench.die()
    assert made(is_empty=True).look() == []
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"{", b'{"format": "stepfield-project", "moves": 3}'])
def test_a_damaged_draft_is_set_aside_and_told_once(made: Made, folder: Path, content: bytes) -> None:
    bench, after = made(), made(is_empty=True)
    bench.edit(0.7)
    bench.keep()
    drafts(folder)[0].write_bytes(content)
    bench.die()
    assert after.look() == []
    assert len(after.told) == 1
    assert not drafts(folder)
    assert [path.read_bytes() for path in folder.glob("*.damaged")] == [content], "it is not thrown away"
    assert after.look() == []
    assert len(after.told) == 1


def test_a_draft_of_a_newer_version_is_left_to_it(made: Made, folder: Path) -> None:
    bench, after = made(), made(is_empty=True)
    bench.edit(0.7)
    bench.keep()
    (path,) = drafts(folder)
    path.write_text(json.dumps({**json.loads(path.read_text()), "version": 9}))
    bench.die()
    assert after.look() == []
    assert not after.told
    assert drafts(folder) == [path]


def test_a_full_disk_is_told_once_and_tried_again(
    made: Made, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    bench = made()
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        for alpha in (0.7, 0.8):
            bench.edit(alpha)
            bench.keep()
    (sentence,) = bench.told
    assert sentence.startswith("Edits are not kept for the case of a crash, save them: ")
    assert "no space left on device" in sentence
    assert bench.recovery._latest.isActive(), "it tries again before long"
    bench.keep()
    assert drafts(folder)
    assert len(bench.told) == 1


def test_a_place_that_cannot_be_written_is_one_sentence(made: Made, folder: Path) -> None:
    folder.write_text("a file stands in the way")
    bench = made()
    bench.edit(0.7)
    bench.keep()
    assert len(bench.told) == 1
    assert "cannot be kept there" in bench.told[0]
    assert "\n" not in bench.told[0]
    bench.document.file.give_up()


def test_locks_without_drafts_do_not_pile_up(made: Made, folder: Path) -> None:
    folder.mkdir()
    (folder / f"old{LOCK}").touch()
    made(is_empty=True).look()
    assert list(folder.iterdir()) == []


def test_another_scan_takes_the_place_of_the_kept_edits(made: Made, folder: Path, scan: Path) -> None:
    """The operator said not to save them: they must not come back."""
    bench = made()
    bench.edit(0.7)
    bench.keep()
    bench.document.open([scan], BASE)
    bench.settle()
    assert not drafts(folder)


def test_a_name_of_no_text_is_a_sentence(made: Made, scan: Path) -> None:
    """Old archives hold file names in other encodings."""
    odd = Path(os.fsdecode(os.fsencode(scan.parent) + b"/sc\xe4n.npy"))
    scan.rename(odd)
    bench = made(is_empty=True)
    bench.document.open([odd], BASE)
    bench.edit(0.7)
    bench.keep()
    assert len(bench.told) == 1
    assert "not valid UTF-8" in bench.told[0]
    bench.document.file.give_up()
