"""Files are replaced whole or not at all, with their rights; a lock lasts as long as its holder."""

from __future__ import annotations

import errno
import os
import resource
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from stepfield.errors import ProjectError
from stepfield.files import STALE, FileLock, write_atomically


def replace(path: Path, content: bytes = b"new") -> None:
    write_atomically(path, content, ProjectError)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "a.stepfield"
    path.write_bytes(b"old")
    return path


def test_rights_of_the_old_file_are_kept(file: Path) -> None:
    """A project made private must not become readable by all with the next save."""
    file.chmod(0o640)
    replace(file)
    assert (file.read_bytes(), stat.S_IMODE(file.stat().st_mode)) == (b"new", 0o640)


def test_a_new_file_has_the_usual_rights(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        replace(tmp_path / "b")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "b").stat().st_mode) == 0o640


def test_a_link_is_followed(file: Path, tmp_path: Path) -> None:
    """If it failed, a project linked into a folder would be cut off from its original."""
    link = tmp_path / "link"
    link.symlink_to(file)
    replace(link)
    assert link.is_symlink()
    assert file.read_bytes() == b"new"


def test_a_file_that_may_not_be_written_is_not_replaced(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # the tests may run as root
    with pytest.raises(ProjectError, match="permission denied"):
        replace(file)
    assert file.read_bytes() == b"old"


def test_a_refusal_at_the_last_moment_leaves_the_old_file(file: Path) -> None:
    def check() -> None:
        assert len(list(file.parent.iterdir())) == 2, "the new content must be whole by then"
        raise ProjectError("changed meanwhile")

    with pytest.raises(ProjectError, match="changed meanwhile"):
        write_atomically(file, b"new", ProjectError, check)
    assert [(path.name, path.read_bytes()) for path in file.parent.iterdir()] == [("a.stepfield", b"old")]


@pytest.mark.parametrize("call", ["fsync", "replace", "write"])
def test_a_full_disk_leaves_the_old_file_whole(
    file: Path, call: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    if call == "write":
        monkeypatch.setattr("stepfield.files._write", full)
    else:
        monkeypatch.setattr(os, call, full)
    with pytest.raises(
        ProjectError, match=r"a\.stepfield: cannot write the file \(no space left on device\)"
    ):
        replace(file)
    assert [(path.name, path.read_bytes()) for path in file.parent.iterdir()] == [("a.stepfield", b"old")]


def test_a_limit_of_the_file_size_is_a_sentence_too(file: Path) -> None:
    """What a quota does in the middle of a write; the system sends a signal with it."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(ProjectError, match="file too large"):
            replace(file, b"x" * 100_000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert [(path.name, path.read_bytes()) for path in file.parent.iterdir()] == [("a.stepfield", b"old")]


KILLED = """
import os, sys, time
from pathlib import Path
from stepfield import files
from stepfield.errors import ProjectError

def wait():
    print("ready", flush=True)
    time.sleep(60)

files.write_atomically(Path(sys.argv[1]), b"new", ProjectError, wait)
"""


def test_a_killed_writer_harms_nothing_and_its_leftovers_go(file: Path) -> None:
    """They must not pile up, and those that somebody may still be writing must stay."""
    writer = subprocess.Popen([sys.executable, "-c", KILLED, str(file)], stdout=subprocess.PIPE)
    assert writer.stdout is not None
    assert writer.stdout.readline() == b"ready\n"
    writer.send_signal(signal.SIGKILL)
    writer.communicate(timeout=30)
    assert file.read_bytes() == b"old"
    (left,) = (path for path in file.parent.iterdir() if path != file)
    replace(file)
    assert left.exists(), "a fresh one may be somebody's"
    past = left.stat().st_mtime - 2 * STALE
    os.utime(left, (past, past))
    replace(file)
    assert list(file.parent.iterdir()) == [file]


HOLDER = """
import sys
from pathlib import Path
from stepfield.files import FileLock
lock = FileLock.taken(Path(sys.argv[1]))
print(lock is not None, flush=True)
sys.stdin.read()
"""


def test_a_lock_ends_with_its_holder_and_not_before(tmp_path: Path) -> None:
    """If it failed, two windows would take each other's edits, or nobody those of a dead one."""
    path = tmp_path / "lock"
    pipe = subprocess.PIPE
    holder = subprocess.Popen([sys.executable, "-c", HOLDER, str(path)], stdin=pipe, stdout=pipe)
    assert holder.stdout is not None
    assert holder.stdout.readline() == b"True\n"
    assert FileLock.taken(path) is None
    holder.kill()
    holder.communicate(timeout=30)
    lock = FileLock.taken(path)
    assert lock is not None
    assert FileLock.taken(path) is None
    lock.release(remove=True)
    assert not path.exists()


def test_a_lock_on_a_file_that_was_removed_counts_for_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between making the file and locking it another process may clear it away."""
    path = tmp_path / "lock"
    monkeypatch.setattr("stepfield.files._lock", lambda descriptor: path.unlink())
    assert FileLock.taken(path) is None
