"""A window killed at any moment loses seconds of work at most, and the next start offers it back."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import psutil
import pytest
from tests.app.scenes_made import table

from stepfield.parameters import Parameters
from stepfield.project import Project, ScanFile
from stepfield_app.recovery.drafts import SUFFIX

#: A window of its own process that works and reports; what it does comes as text.
WINDOW = """
import os, sys, time
from pathlib import Path
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication
from stepfield_app import application
from stepfield_app.main_window import MainWindow
from stepfield_app.recovery import recovery

recovery.QUIET = 0.05
made = []
first = MainWindow.__init__

def remember(self, *words, **named):
    first(self, *words, **named)
    made.append(self)
    self.when_ready(lambda: begin(self))

def say(*words):
    print(*words, flush=True)

{work}

MainWindow.__init__ = remember
sys.exit(application.run([Path(name) for name in sys.argv[1:]]))
"""

#: Edits once, and says when that is kept.
EDIT = """
def begin(window):
    window.filing.recovery.kept.connect(lambda: say("kept"))
    window.bench.document.opened.connect(lambda: QTimer.singleShot(0, edit))

def edit():
    made[0].bench.document.set_parameters("Alpha", alpha=0.7)
    made[0].bench.document.set_style("Name", 0, name="Floor")
"""

#: Edits again after that, and stops in the middle of keeping it.
STOP_WHILE_WRITING = """
def begin(window):
    window.filing.recovery.kept.connect(again)
    window.bench.document.opened.connect(lambda: QTimer.singleShot(0, edit))

def edit():
    made[0].bench.document.set_parameters("Alpha", alpha=0.7)
    made[0].bench.document.set_style("Name", 0, name="Floor")

def again():
    def stop(one, other):
        say("kept")
        time.sleep(60)

    os.{function} = stop
    made[0].bench.document.set_parameters("Alpha", alpha=0.9)
"""

#: Recovers what is offered, saves it and leaves.
RECOVER = """
def begin(window):
    window.filing.recovery.found.connect(lambda draft: QTimer.singleShot(0, recover))
    window.bench.document.opened.connect(lambda: QTimer.singleShot(0, look))

def recover():
    (message,) = made[0].message_bar.messages
    say("offered", message.sentence)
    message.choices[0].do()

def look():
    document = made[0].bench.document
    say("alpha", document.project.parameters.alpha, document.style(0).name, document.file.dirty)
    say("title", made[0].windowTitle(), made[0].isWindowModified())
    made[0].filing.save(then=leave)

def leave():
    say("dirty", made[0].bench.document.file.dirty)
    made[0].close()
"""

#: Says what is offered, and leaves it.
LOOK = """
def begin(window):
    window.filing.recovery._finder.answered.connect(lambda folder, found: end(found))

def end(found):
    say("offers", len(found.drafts))
    made[0].close()
"""


def started(folder: Path, work: str, *words: object) -> subprocess.Popen[str]:
    """Start a window with settings and state of its own, on no screen."""
    own = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    own |= {"HOME": str(folder), "QT_QPA_PLATFORM": "offscreen", "QT_LOGGING_RULES": "*.debug=false"}
    own |= {f"XDG_{name}_HOME": str(folder / name.lower()) for name in ("CONFIG", "CACHE", "STATE")}
    return subprocess.Popen(
        [sys.executable, "-c", WINDOW.replace("{work}", work), *map(str, words)],
        env=own,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def killed(window: subprocess.Popen[str]) -> None:
    """Kill a window once it says that its edits are kept."""
    assert window.stdout is not None
    line = window.stdout.readline()
    assert line == "kept\n", f"{line}{window.stderr.read() if window.stderr else ''}"
    children = psutil.Process(window.pid).children()
    window.send_signal(signal.SIGKILL)
    window.communicate(timeout=30)
    psutil.wait_procs(children, timeout=30)
    assert not [child for child in children if child.is_running()], "the drawing process lives on"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    np.save(tmp_path / "table.npy", table())
    file = tmp_path / "room.stepfield"
    parameters = Parameters(cell_size=0.5, layer_tolerance=0.3, alpha=0.5)
    Project(scans=(ScanFile(path="table.npy"),), parameters=parameters).save(file)
    return file


def drafts(folder: Path) -> list[Path]:
    return list((folder / "state").rglob(f"*{SUFFIX}"))


@pytest.mark.parametrize(
    "work",
    [
        EDIT,
        STOP_WHILE_WRITING.replace("{function}", "replace"),
        STOP_WHILE_WRITING.replace("{function}", "chmod"),
    ],
    ids=["at rest", "as the draft is put in place", "as the draft is written"],
)
def test_edits_of_a_killed_window_come_back(tmp_path: Path, project: Path, work: str) -> None:
    before = project.read_bytes()
    killed(started(tmp_path, work, project))
    assert project.read_bytes() == before, "the file is changed by saving only"
    assert len(drafts(tmp_path)) == 1
    after = started(tmp_path, RECOVER)
    said, errors = after.communicate(timeout=60)
    assert after.returncode == 0, errors
    offered, alpha, title, dirty = said.splitlines()
    assert offered.startswith("offered Recover the unsaved edits of room.stepfield from ")
    assert alpha == "alpha 0.7 Floor True"
    assert title == "title room.stepfield[*] – Stepfield True"
    assert dirty == "dirty False"
    assert Project.read(project).parameters.alpha == 0.7
    assert Project.read(project).scans[0].path == "table.npy"
    assert not drafts(tmp_path), "saved edits are not offered again"


def test_edits_are_offered_until_they_are_wanted_or_not(tmp_path: Path, project: Path) -> None:
    """A window that is just closed has not decided about them; a living one's are nobody's business."""
    killed(started(tmp_path, EDIT, project))
    living = started(tmp_path, EDIT, project)
    assert living.stdout is not None
    assert living.stdout.readline() == "kept\n"
    assert len(drafts(tmp_path)) == 2
    said, errors = started(tmp_path, LOOK).communicate(timeout=60)
    assert said == "offers 0\n", f"the living window has them in its bar; {errors}"
    living.kill()
    living.communicate(timeout=30)
    for _ in range(2):
        said, errors = started(tmp_path, LOOK).communicate(timeout=60)
        assert said == "offers 2\n", errors


def test_a_signal_to_end_keeps_the_edits_without_a_question(tmp_path: Path, project: Path) -> None:
    """Who logs out cannot answer: the window must neither stay nor lose anything."""
    window = started(tmp_path, EDIT, project)
    assert window.stdout is not None
    assert window.stdout.readline() == "kept\n"
    window.send_signal(signal.SIGTERM)
    _, errors = window.communicate(timeout=30)
    assert window.returncode == 0, errors
    assert len(drafts(tmp_path)) == 1
    said, errors = started(tmp_path, LOOK).communicate(timeout=60)
    assert said == "offers 1\n", errors
