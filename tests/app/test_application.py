"""Starting and leaving: without a screen, with a fault, by a signal; always in one sentence and cleanly."""

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

from stepfield.errors import StepfieldError
from stepfield.project import Project, ScanFile
from stepfield_app import application
from stepfield_app.render.store import MEMORY, PREFIX

#: A window that reports, and does something unexpected when told; run in a process of its own.
WINDOW = """
import sys
from pathlib import Path
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication
from stepfield_app import application
from stepfield_app.main_window import MainWindow

made = []
first = MainWindow.__init__

def remember(self, *words, **named):
    first(self, *words, **named)
    made.append(self)
    self.when_ready(listen)

def listen():
    made[0].bench.document.opened.connect(lambda: QTimer.singleShot(0, act))
    made[0].bench.client.state_changed.connect(lambda state: state == "running" and tell())

def tell():
    print("running", made[0].bench.client.process_id, flush=True)

def act():
    {act}

MainWindow.__init__ = remember
code = application.run([Path(name) for name in sys.argv[1:]])
print("code", code, flush=True)
sys.exit(code)
"""

FAIL = """
    def fail():
        raise ZeroDivisionError("nobody thought of this")

    def look():
        (message,) = made[0].message_bar.messages
        assert "nobody thought of this" in message.details, message
        assert "ZeroDivisionError" not in message.sentence, message
        made[0].bench.document.set_parameters("Alpha", alpha=0.9)
        made[0].bench.document.answer_changed.connect(lambda answer: done(answer))

    def done(answer):
        print("alpha", answer.result.parameters.alpha, flush=True)
        made[0].filing.close_without()

    QTimer.singleShot(0, fail)
    QTimer.singleShot(0, look)
"""


OPEN_A_DIALOG = """
    QTimer.singleShot(0, made[0].commands["export"].trigger)
    application_ = QApplication.instance()

    def look():
        if application_.activeModalWidget() is None:
            QTimer.singleShot(10, look)
        else:
            print("open", flush=True)

    look()
"""


def started(folder: Path, act: str = "pass", *words: str) -> subprocess.Popen[str]:
    """Start a window with settings of its own, on no screen."""
    own = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    own |= {"HOME": str(folder), "QT_QPA_PLATFORM": "offscreen", "QT_LOGGING_RULES": "*.debug=false"}
    own |= {f"XDG_{name}_HOME": str(folder / name.lower()) for name in ("CONFIG", "CACHE", "STATE")}
    return subprocess.Popen(
        [sys.executable, "-c", WINDOW.replace("{act}", act), *words],
        env=own,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def told(errors: str) -> str:
    """What was written to the terminal, but for what Qt says of every window that is on no screen."""
    return "\n".join(line for line in errors.splitlines() if "This plugin does not support" not in line)


def shared_folders(process: int) -> list[Path]:
    return list(MEMORY.glob(f"{PREFIX}{process}-*"))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_closes_the_window_cleanly(tmp_path: Path, number: signal.Signals) -> None:
    """If it failed, Ctrl+C would leave a drawing process and its memory behind."""
    window = started(tmp_path)
    assert window.stdout is not None
    word, process = window.stdout.readline().split()
    assert word == "running"
    assert psutil.pid_exists(int(process))
    assert shared_folders(window.pid)
    window.send_signal(number)
    said, errors = window.communicate(timeout=30)
    assert (window.returncode, said) == (0, "code 0\n"), errors
    assert not told(errors)
    assert not psutil.pid_exists(int(process))
    assert not shared_folders(window.pid)


def test_a_signal_closes_the_window_under_an_open_dialog(tmp_path: Path) -> None:
    scan = tmp_path / "table.npy"
    np.save(scan, table())
    window = started(tmp_path, OPEN_A_DIALOG.strip(), str(scan))
    assert window.stdout is not None
    while window.stdout.readline().strip() != "open":
        assert window.poll() is None
    window.send_signal(signal.SIGTERM)
    _, errors = window.communicate(timeout=30)
    assert window.returncode == 0, errors
    assert not told(errors)
    assert not shared_folders(window.pid)


def test_a_fault_is_shown_and_everything_lives_on(tmp_path: Path) -> None:
    """If it failed, a fault in one slot would be lost in a terminal nobody looks at, or end the window."""
    scan = tmp_path / "table.npy"
    np.save(scan, table())
    window = started(tmp_path, FAIL.strip(), str(scan))
    said, errors = window.communicate(timeout=60)
    assert window.returncode == 0, errors
    assert "alpha 0.9\n" in said
    assert errors.count("ZeroDivisionError: nobody thought of this") == 1


def test_a_picture_that_cannot_be_made_is_one_sentence(tmp_path: Path) -> None:
    """What is left of the window was once destroyed after the application: a crash behind the sentence."""
    project = Project(scans=(ScanFile(path="absent.npy"),))
    project.save(tmp_path / "room.stepfield")
    words = ["view", str(tmp_path / "room.stepfield"), "--screenshot", str(tmp_path / "a.png")]
    own = os.environ | {"HOME": str(tmp_path), "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run(
        [sys.executable, "-m", "stepfield", *words], env=own, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "absent.npy is missing; put it back" in told(done.stderr)
    assert len(told(done.stderr).splitlines()) == 1


def test_the_package_of_the_window_is_the_view_command(tmp_path: Path) -> None:
    """It took every word for a scan, ``--help`` too, and told of errors by a traceback."""
    for words, code, said in (
        (["--help"], 0, "stepfield view"),
        (["absent.npy", "--screenshot", "a.png"], 1, ""),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "stepfield_app", *words],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == code
        assert said in done.stdout
        assert "Traceback" not in done.stderr


def test_nowhere_to_open_a_window_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(StepfieldError, match="there is no display") as caught:
        application.run([])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["DISPLAY", "WAYLAND_DISPLAY"])
def test_a_screen_is_used_where_there_is_one(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    for each in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(each, raising=False)
    monkeypatch.setenv(name, ":7")
    application._find_screen(needed=True)
    application._find_screen(needed=False)
    assert "QT_QPA_PLATFORM" not in os.environ


def test_other_systems_always_have_a_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    for each in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(each, raising=False)
    monkeypatch.setattr(sys, "platform", "darwin")
    application._find_screen(needed=True)
    assert "QT_QPA_PLATFORM" not in os.environ


def test_the_window_waits_for_no_heavy_library() -> None:
    """None is needed before something is done, and most of them take a quarter of a second and more."""
    probe = (
        "import sys, stepfield_app.application, stepfield_app.main_window;"
        "heavy = {'scipy', 'open3d', 'rasterio', 'laspy', 'pyarrow', 'PIL', 'trimesh', 'stepfield.synth'};"
        "print(heavy & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", probe], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "set()"


def test_nobody_looks_for_garbage_among_what_was_imported() -> None:
    """It would be done before the window is made, and take a twentieth of its start."""
    probe = (
        "import gc; from stepfield.cli import view; looked = [];"
        "gc.callbacks.append(lambda phase, info: looked.append(phase));"
        "view._imported(view.WINDOW); kept = [[] for _ in range(100)]; print(looked)"
    )
    done = subprocess.run([sys.executable, "-c", probe], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"
