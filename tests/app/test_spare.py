"""Memory that was freed does not stay with the window."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import threading
from pathlib import Path

import psutil
import pytest

from stepfield_app.render import inbox as module
from stepfield_app.render.inbox import Inbox
from stepfield_app.spare import ARENAS, give_back

pytestmark = pytest.mark.skipif(
    platform.libc_ver()[0] != "glibc", reason="other libraries give back by themselves, or never"
)
#: Says how much memory a process has with 200 MB, without them, and after giving back.
KEEPING = """
import numpy, psutil
from stepfield_app.spare import give_back, keep
keep()
def held(): return psutil.Process().memory_info().rss
before = held()
numpy.ones(25_000_000)
freed = held()
numpy.ones(25_000_000)
again = held()
give_back()
print(freed - before, again - before, held() - before)
"""

#: Says from how many places eight threads take memory that are there at the same time.
SHARING = """
import ctypes, sys, threading
from stepfield_app.spare import share
share()
library, together = ctypes.CDLL(None), threading.Barrier(9)
library.malloc.restype = library.fopen.restype = ctypes.c_void_p
def work():
    together.wait()
    library.malloc(ctypes.c_size_t(100_000))
    together.wait()
for _ in range(8):
    threading.Thread(target=work).start()
together.wait()
together.wait()
told = ctypes.c_void_p(library.fopen(sys.argv[1].encode(), b"w"))
library.malloc_info(0, told)
library.fclose(told)
"""


def test_what_one_worker_frees_serves_the_others(tmp_path: Path) -> None:
    """The window would grow for as long as it takes every worker to meet the largest scan."""
    told = tmp_path / "told.xml"
    subprocess.run([sys.executable, "-c", SHARING, str(told)], check=True)
    assert 1 <= told.read_text().count("<heap nr=") <= ARENAS


def test_what_a_picture_frees_serves_the_next_one_and_goes_back_after_it() -> None:
    """The system would hand the same memory out for every picture, which takes as long as drawing it."""
    done = subprocess.run([sys.executable, "-c", KEEPING], capture_output=True, text=True, check=True)
    freed, again, after = map(int, done.stdout.split())
    assert freed > 150_000_000
    assert again < 250_000_000
    assert after < 50_000_000


def test_the_drawing_process_notices_when_it_is_quiet(monkeypatch: pytest.MonkeyPatch) -> None:
    """It would keep for ever what its largest picture needed."""
    monkeypatch.setattr(module, "QUIET", 0.01)
    reading, writing = os.pipe()
    quiet, ended = threading.Event(), threading.Event()
    with os.fdopen(reading, "rb") as pipe, os.fdopen(writing, "wb") as said:
        inbox = Inbox(pipe, ended.set, quiet.set)
        threading.Thread(target=inbox.take, args=(True,), daemon=True).start()
        assert quiet.wait(10)
        said.close()
        assert ended.wait(10)


def test_what_was_freed_between_what_is_kept_goes_back_to_the_system() -> None:
    blocks = [bytearray(100_000) for _ in range(1000)]
    kept = blocks[::100]
    before = psutil.Process().memory_info().rss
    del blocks
    give_back()
    assert before - psutil.Process().memory_info().rss > 50_000_000
    assert len(kept) == 10
