"""Starting and leaving the window: the one place that knows the application is one."""

from __future__ import annotations

import gc
import os
import signal
import socket
import sys
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from types import FrameType, TracebackType

from PySide6.QtCore import (
    QCoreApplication,
    QEvent,
    QMessageLogContext,
    QSocketNotifier,
    QTimer,
    QtMsgType,
    qInstallMessageHandler,
)
from PySide6.QtWidgets import QApplication

import stepfield
from stepfield.errors import StepfieldError
from stepfield.parameters import Parameters
from stepfield_app.appearance import Appearance, Choice
from stepfield_app.garbage import GarbageCollector
from stepfield_app.main_window import MainWindow
from stepfield_app.screenshot import Screenshot
from stepfield_app.settings import Settings
from stepfield_app.spare import share

#: Rate at which threads take turns, seconds: the hand on a slider should not wait for the method, and every
#: call of Qt's gives the turn away.
TURN = 0.0001


def run(
    scans: Sequence[Path],
    parameters: Parameters | None = None,
    *,
    screenshot: Path | None = None,
    size: tuple[int, int] | None = None,
    theme: Choice | None = None,
) -> int:
    """Open the window, on scans if any are named, and return the exit code when it is closed.

    Parameters
    ----------
    scans : sequence of Path
        Files of one scan.
    parameters : Parameters, optional
        To begin with.
    screenshot : Path, optional
        Where to save a picture once everything is drawn; the window then closes.
    size : tuple of int, optional
        Width and height of the window in pixels.
    theme : str, optional
        ``dark`` or ``light`` in place of what the operator chose.

    Raises
    ------
    StepfieldError
        When there is no screen, or the picture cannot be made.
    """
    _find_screen(needed=screenshot is None)
    sys.setswitchinterval(TURN)
    share()
    application = QApplication.instance() or QApplication(["stepfield"])
    assert isinstance(application, QApplication)
    _name(application)
    settings = Settings()
    garbage = GarbageCollector(application)
    appearance = Appearance(application, theme or settings.theme)
    with appearance.undressed():
        window = MainWindow(appearance, settings, size=size, remembers=screenshot is None, in_pieces=True)
    garbage.pause()
    window.ready.connect(garbage.go_on)
    window.ready.connect(lambda: _tell_unexpected(window))
    _tell_unexpected(window)
    picture = Screenshot(window, screenshot) if screenshot is not None else None
    window.show()
    stop = _closed_by_signals(window)
    if scans:
        window.first_paint.happened.connect(lambda: window.open_scans(scans, parameters or Parameters()))
    code = application.exec()
    sys.excepthook = sys.__excepthook__
    garbage.stop()
    stop()
    _destroy(window)
    if picture is not None and picture.failure is not None:
        raise picture.failure
    return code


def _destroy(window: MainWindow) -> None:
    """Destroy the window while there is an application: the interpreter would come to it too late."""
    window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    gc.collect()


def _find_screen(*, needed: bool) -> None:
    """Draw without a screen where a picture is all that is wanted; refuse to open a window nowhere."""
    has_screen = sys.platform != "linux" or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )
    if has_screen or "QT_QPA_PLATFORM" in os.environ:
        return
    if needed:
        raise StepfieldError(
            "there is no display to open a window on; use stepfield build, or view --screenshot FILE.png"
        )
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    qInstallMessageHandler(_say_what_matters)


def _say_what_matters(kind: QtMsgType, context: QMessageLogContext, message: str | None) -> None:
    """Pass on what Qt says, but for what it says of every window that is on no screen."""
    if message and not message.startswith("This plugin does not support"):
        sys.stderr.write(f"{message}\n")


def _name(application: QApplication) -> None:
    application.setOrganizationName("Stepfield")
    application.setApplicationName("Stepfield")
    application.setApplicationVersion(stepfield.__version__)
    application.setDesktopFileName("stepfield")


def _tell_unexpected(window: MainWindow) -> None:
    """Let the operator, and the terminal, know what nobody expected; libraries have ideas of their own."""

    def show(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        details = "".join(traceback.format_exception(kind, error, trace))
        sys.stderr.write(details)
        window.tell_unexpected(details)

    sys.excepthook = show


def _closed_by_signals(window: MainWindow) -> Callable[[], None]:
    """Close the window on Ctrl+C and on SIGTERM, keeping edits; return what puts everything back.

    Python handles signals between two of its own instructions only, and the event loop may not run any for
    long: a socket that the signal writes to wakes it.
    """
    reading, writing = socket.socketpair()
    for end in (reading, writing):
        end.setblocking(False)
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}

    def close(number: int, frame: FrameType | None) -> None:
        QTimer.singleShot(0, window.close_at_once)

    for number in before:
        signal.signal(number, close)
    old = signal.set_wakeup_fd(writing.fileno(), warn_on_full_buffer=False)
    notifier = QSocketNotifier(reading.fileno(), QSocketNotifier.Type.Read)
    notifier.activated.connect(lambda: reading.recv(64))

    def stop() -> None:
        notifier.setEnabled(False)
        signal.set_wakeup_fd(old)
        for number, handler in before.items():
            signal.signal(number, handler)
        reading.close()
        writing.close()

    return stop
