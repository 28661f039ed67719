"""Saving: whole or not at all, in the background, and never over the work of another window."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import table

from stepfield.errors import ProjectError
from stepfield.parameters import Parameters
from stepfield.project import Project
from stepfield_app.document import Document
from stepfield_app.opening import Missing, Opener, work_at
from stepfield_app.runner import Runner
from stepfield_app.saving import FileWatch, Saving

BASE = Parameters(cell_size=0.5, layer_tolerance=0.3, alpha=0.5)


class Bench:
    """A document with what saves, watches and opens it, as a window has them."""

    def __init__(self, qtbot: QtBot) -> None:
        self.qtbot = qtbot
        self.document = Document(Runner(threaded=False))
        self.saving = Saving(self.document, lambda: {"layer": 1})
        self.watch = FileWatch(self.document, self.saving)
        self.opener = Opener(self.document)
        self.told: list[Any] = []
        for signal in (self.saving.failed, self.saving.refused, self.watch.changed, self.watch.gone):
            signal.connect(self.told.append)
        for signal in (self.opener.missing, self.opener.failed, self.opener.scans_differ):
            signal.connect(self.told.append)

    def open(self, file: Path) -> None:
        with self.qtbot.waitSignal(self.document.opened):
            self.opener.open([file], None if file.suffix == ".stepfield" else BASE)

    def save(self, path: Path | None = None, **how: Any) -> None:
        self.saving.save(path, **how)
        self.qtbot.waitUntil(lambda: not self.saving.busy)

    def edit(self, alpha: float) -> None:
        self.document.set_parameters(f"Alpha {alpha}", alpha=alpha)

    def close(self) -> None:
        for part in (self.watch, self.opener, self.saving, self.document):
            part.close()


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    path = tmp_path / "scans" / "table.npy"
    path.parent.mkdir()
    np.save(path, table())
    return path


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "work" / "room.stepfield"


@pytest.fixture
def bench(qtbot: QtBot, scan: Path, file: Path) -> Iterator[Bench]:
    """A document with the table in it."""
    file.parent.mkdir()
    bench = Bench(qtbot)
    bench.open(scan)
    yield bench
    bench.close()


@pytest.fixture
def other(qtbot: QtBot) -> Iterator[Bench]:
    """Another window."""
    bench = Bench(qtbot)
    yield bench
    bench.close()


# --- What is written ----------------------------------------------------------------------------------------


def test_a_saved_project_names_its_scans_relatively_with_their_digests(
    bench: Bench, scan: Path, file: Path
) -> None:
    """If it failed, a folder of work could not be moved, and a scan that changed would not be noticed."""
    bench.edit(0.7)
    bench.save(file)
    written = json.loads(file.read_text())
    digest = hashlib.sha256(scan.read_bytes()).hexdigest()
    assert written["scans"] == [{"path": "../scans/table.npy", "sha256": digest}]
    assert written["parameters"]["alpha"] == 0.7
    assert written["view"] == {"layer": 1}
    assert not bench.told


def test_a_project_comes_back_as_it_was_saved(bench: Bench, other: Bench, file: Path) -> None:
    bench.edit(0.7)
    bench.document.set_style("Name", 1, name="Top", locked=True)
    bench.save(file)
    other.open(file)
    mine, theirs = bench.document.project, other.document.project
    assert (theirs.parameters, theirs.layers, theirs.moves) == (mine.parameters, mine.layers, mine.moves)
    assert other.document.scans == (file.parent / "../scans/table.npy",)
    assert not other.document.file.dirty
    other.save()
    assert Project.read(file).content() == file.read_bytes()
    assert not other.told


def test_dirty_is_what_differs_from_the_file(bench: Bench, file: Path) -> None:
    changes: list[bool] = []
    bench.document.file.dirty_changed.connect(changes.append)
    assert not bench.document.file.dirty, "a scan just opened is lost with nothing"
    bench.edit(0.7)
    bench.save(file)
    bench.edit(0.8)
    bench.document.undo_stack.undo()
    bench.document.undo_stack.undo()
    bench.document.undo_stack.redo()
    assert changes == [True, False, True, False, True, False]


def test_an_edit_made_while_saving_is_still_to_be_saved(bench: Bench, file: Path) -> None:
    bench.edit(0.7)
    bench.saving.save(file)
    bench.edit(0.8)
    bench.qtbot.waitUntil(lambda: not bench.saving.busy)
    assert bench.document.file.dirty
    assert Project.read(file).parameters.alpha == 0.7
    bench.document.undo_stack.undo()
    assert not bench.document.file.dirty


def test_what_is_to_follow_a_save_follows_only_a_save(bench: Bench, file: Path) -> None:
    """If it failed, a window would close although its project could not be written."""
    done: list[str] = []
    bench.save(file, then=lambda: done.append("saved"))
    bench.save(file.parent / "absent" / "a.stepfield", then=lambda: done.append("not saved"))
    assert done == ["saved"]
    assert [type(error) for error in bench.told] == [ProjectError]


# --- Full disks ---------------------------------------------------------------------------------------------


def test_a_full_disk_leaves_the_old_file_and_the_edits(
    bench: Bench, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.save(file)
    before = file.read_bytes()
    bench.edit(0.7)

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    bench.save()
    (error,) = bench.told
    assert str(error) == f"{file}: cannot write the file (no space left on device); choose another place"
    assert (file.read_bytes(), list(file.parent.iterdir())) == (before, [file])
    assert bench.document.file.dirty
    monkeypatch.undo()
    bench.save()
    assert not bench.document.file.dirty
    assert Project.read(file).parameters.alpha == 0.7


# --- Two windows --------------------------------------------------------------------------------------------


@pytest.fixture
def both(bench: Bench, other: Bench, file: Path) -> tuple[Bench, Bench]:
    """Two windows on one project."""
    bench.save(file)
    other.open(file)
    return bench, other


def test_the_work_of_another_window_is_not_overwritten_unnoticed(
    both: tuple[Bench, Bench], file: Path
) -> None:
    one, two = both
    two.edit(0.9)
    two.save()
    theirs = file.read_bytes()
    one.edit(0.6)
    one.save()
    assert file in one.told
    assert file.read_bytes() == theirs
    assert one.document.file.dirty
    one.save(over_another=True)
    assert Project.read(file).parameters.alpha == 0.6
    one.edit(0.65)
    one.save()
    assert Project.read(file).parameters.alpha == 0.65, "once it was decided, nothing stands in the way"


def test_a_window_hears_at_once_that_another_has_saved(both: tuple[Bench, Bench], file: Path) -> None:
    one, two = both
    two.edit(0.9)
    two.save()
    one.qtbot.waitUntil(lambda: one.told == [file])
    two.watch.look()
    two.qtbot.waitUntil(lambda: not two.watch._worker.busy)
    assert not two.told, "what a window writes itself is no news to it"


def test_a_window_hears_that_its_file_is_gone_and_can_write_it_anew(bench: Bench, file: Path) -> None:
    bench.save(file)
    file.unlink()
    bench.qtbot.waitUntil(lambda: bench.told == [file])
    bench.save()
    assert Project.read(file).parameters == BASE


def test_another_window_that_saves_at_the_last_moment_is_noticed(
    both: tuple[Bench, Bench], file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between looking at the file and replacing it a large project is being written: seconds."""
    one, _ = both
    fsync = os.fsync

    def slow(descriptor: int) -> None:
        fsync(descriptor)
        file.write_bytes(b"theirs")

    monkeypatch.setattr(os, "fsync", slow)
    one.edit(0.6)
    one.save()
    assert file.read_bytes() == b"theirs"
    assert one.told[0] == file


def test_saving_under_another_name_does_not_ask_again(both: tuple[Bench, Bench], file: Path) -> None:
    one, two = both
    two.edit(0.9)
    two.save()
    one.save(file.with_name("mine.stepfield"))
    assert one.document.file.stored is not None
    assert one.document.file.stored.path == file.with_name("mine.stepfield")
    one.save(file)
    assert Project.read(file).parameters.alpha == 0.5, "the dialog has asked already"


def test_a_save_that_ends_after_another_scan_was_opened_belongs_to_the_first(
    bench: Bench, scan: Path, file: Path
) -> None:
    bench.edit(0.7)
    bench.saving.save(file)
    bench.document.open([scan], BASE)
    bench.edit(0.9)
    bench.qtbot.waitUntil(lambda: not bench.saving.busy)
    assert bench.document.file.stored is None, "the next save would replace another project"
    assert bench.document.file.dirty


# --- Opening ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "damaged project, it is not JSON"),
        (b'{"format": "stepfield-project", "moves": [', "damaged project, it is not JSON"),
        (b"\xff\xfe{}", "damaged project, it is not JSON"),
        (b"[" * 100_000, "damaged project, it is not JSON"),
        (b"{}", "not a project of Stepfield"),
        (b'{"format": "stepfield-stack", "version": 1}', "not a project of Stepfield"),
        (b'{"format": "stepfield-project", "version": 7, "future": 1}', "newer Stepfield"),
        (b'{"format": "stepfield-project", "version": 1, "future": 1}', "future"),
        (b'{"format": "stepfield-project", "version": 1, "scans": [{"path": 3}]}', "scans.0.path"),
        (b'{"format": "stepfield-project", "version": 1}', "names no scan"),
        (None, "cannot read the project"),
    ],
)
def test_a_project_that_cannot_be_opened_is_one_sentence(
    bench: Bench, file: Path, content: bytes | None, sentence: str
) -> None:
    """And what was open stays open."""
    if content is not None:
        file.write_bytes(content)
    project = bench.document.project
    bench.opener.open([file])
    bench.qtbot.waitUntil(lambda: bool(bench.told))
    (error,) = bench.told
    assert isinstance(error, ProjectError)
    assert sentence in str(error)
    assert str(error).startswith(str(file))
    assert "\n" not in str(error)
    assert bench.document.project is project


def test_parameters_given_besides_a_project_replace_its_own_and_are_to_be_saved(
    bench: Bench, other: Bench, file: Path
) -> None:
    """``view PROJECT --cell 0.25`` must not show the project as if nothing had been given."""
    bench.edit(0.7)
    bench.save(file)
    with other.qtbot.waitSignal(other.document.opened):
        other.opener.open([file], Parameters.checked(cell_size=0.25))
    parameters = other.document.project.parameters
    assert (parameters.cell_size, parameters.alpha) == (0.25, 0.7)
    assert other.document.answer is not None
    assert other.document.answer.result.parameters.cell_size == 0.25
    assert other.document.file.dirty
    assert Project.read(file).parameters.cell_size == 0.5


def test_parameters_that_a_project_has_already_change_nothing(bench: Bench, other: Bench, file: Path) -> None:
    bench.save(file)
    with other.qtbot.waitSignal(other.document.opened):
        other.opener.open([file], Parameters.checked(cell_size=0.5))
    assert not other.document.file.dirty


def test_a_scan_that_has_moved_is_asked_for(bench: Bench, scan: Path, file: Path, tmp_path: Path) -> None:
    bench.save(file)
    there = tmp_path / "elsewhere.npy"
    shutil.move(scan, there)
    bench.opener.open([file])
    bench.qtbot.waitUntil(lambda: bool(bench.told))
    (missing,) = bench.told
    assert isinstance(missing, Missing)
    assert (missing.paths, missing.beside()) == ((file.parent / "../scans/table.npy",), {})
    with bench.qtbot.waitSignal(bench.document.opened):
        bench.opener.open_work(missing.found({missing.paths[0]: there}))
    assert bench.document.scans == (there,)
    assert bench.document.file.dirty, "the file still names the old place"
    bench.save()
    assert Project.read(file).scans[0].path == "../elsewhere.npy"
    assert not bench.document.file.dirty


def test_a_scan_beside_the_project_is_proposed(bench: Bench, scan: Path, file: Path) -> None:
    bench.save(file)
    shutil.move(scan, file.parent)
    work = work_at(file)
    missing = Missing(work, tuple(Path(scan.path) for scan in work.project.scans))
    assert list(missing.beside().values()) == [file.parent / "table.npy"]
    assert "is missing" in missing.sentence


def test_a_scan_that_has_changed_is_told(bench: Bench, other: Bench, scan: Path, file: Path) -> None:
    bench.save(file)
    other.open(file)
    other.qtbot.waitUntil(lambda: not other.opener._comparer.busy)
    assert not other.told
    np.save(scan, table() + 0.25)
    other.open(file)
    other.qtbot.waitUntil(lambda: other.told == [("table.npy",)])


def test_a_scan_is_opened_in_place_of_a_project_that_is_still_being_read(
    bench: Bench, scan: Path, file: Path
) -> None:
    bench.save(file)
    bench.document.close_scan()
    bench.opener.open([file])
    bench.opener.open([scan], BASE)
    bench.qtbot.waitUntil(lambda: not bench.opener.busy)
    assert bench.document.file.stored is None
