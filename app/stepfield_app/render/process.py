"""Keeps the drawing process alive: starts it, passes lines on, starts it again when it dies."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

from PySide6.QtCore import QObject, QProcess, QProcessEnvironment, QTimer, Signal

from stepfield_app.render.protocol import Message, Ready, Unusable, line, message

SERVER = "stepfield_app.render.server"
#: So many deaths in so many seconds, and it is given up.
DEATHS, SECONDS = 4, 20.0
#: Milliseconds before the next start, and that a close waits before it kills.
PAUSE, PATIENCE = 200, 500


def command(folders: list[str]) -> list[str]:
    """Command line of the drawing process."""
    if getattr(sys, "frozen", False):  # a bundled program has no interpreter: it starts itself
        return [sys.executable, "--render-server", *folders]
    return [sys.executable, "-m", SERVER, *folders]


class DrawingProcess(QObject):
    """The process, through its deaths."""

    received = Signal(object)  # Message
    state_changed = Signal(str)

    def __init__(self, folders: list[Path], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._folders = folders
        self._log = folders[-1] / "log"
        self._process: QProcess | None = None
        self._deaths: list[float] = []
        self._pause = QTimer(self, singleShot=True, interval=PAUSE)
        self._pause.timeout.connect(self._launch)
        self.state = "stopped"
        self.reason = ""

    @property
    def process_id(self) -> int:
        """Number of the running process, 0 if there is none."""
        return self._process.processId() if self._process else 0

    def start(self) -> None:
        """Start, unless it runs; forget earlier deaths."""
        self._deaths.clear()
        if self._process is None:
            self._pause.stop()
            self._launch()

    @property
    def details(self) -> str:
        """What the process last wrote to its standard error: its own error if it had one."""
        return self._log.read_text(errors="replace")[-4000:] if self._log.exists() else ""

    def send(self, message: Message) -> None:
        """Send a message; lost if the process is not running."""
        if self._process and self.state == "running":
            self._process.write(line(message))

    def close(self) -> None:
        """End the process, gently for a moment."""
        self._pause.stop()
        self.state = "stopped"
        process, self._process = self._process, None
        if process is None:
            return
        for signal in (process.readyReadStandardOutput, process.finished, process.errorOccurred):
            signal.disconnect()
        if process.state() != QProcess.ProcessState.NotRunning:
            process.closeWriteChannel()
            if not process.waitForFinished(PATIENCE):
                process.kill()
                process.waitForFinished()
        process.deleteLater()

    def give_up(self, reason: str) -> None:
        """End the process for good, until the next start."""
        self.reason = reason
        self.close()
        self._enter("failed")

    def _launch(self) -> None:
        self._process = process = QProcess(self)
        process.setProcessEnvironment(_environment())
        process.setStandardErrorFile(str(self._log))
        process.readyReadStandardOutput.connect(self._read)
        process.finished.connect(self._died)
        process.errorOccurred.connect(self._failed_to_start)
        program, *arguments = command([str(folder) for folder in self._folders])
        self._enter("starting")
        process.start(program, arguments)

    def _read(self) -> None:
        while self._process and self._process.canReadLine():
            said = message(bytes(self._process.readLine().data()))
            if isinstance(said, Ready):
                self._enter("running")
            elif isinstance(said, Unusable):
                self.give_up(said.reason)
            else:
                self.received.emit(said)

    def _failed_to_start(self, error: QProcess.ProcessError) -> None:
        if error == QProcess.ProcessError.FailedToStart:
            self.give_up("The 3-D views cannot start: their program could not be run.")

    def _died(self) -> None:
        self._forget()
        now = time.monotonic()
        self._deaths = [death for death in self._deaths if now - death < SECONDS] + [now]
        if len(self._deaths) >= DEATHS:
            self.give_up(f"The 3-D views have stopped {DEATHS} times within {SECONDS:.0f} seconds.")
            return
        self._enter("stopped")
        self._pause.start()

    def _forget(self) -> None:
        if self._process:
            self._process.deleteLater()
        self._process = None

    def _enter(self, state: str) -> None:
        self.state = state
        self.state_changed.emit(state)


def _environment() -> QProcessEnvironment:
    """Environment in which this very package is found, however this process found it."""
    environment = QProcessEnvironment.systemEnvironment()
    root = str(Path(__file__).parents[2])
    known = environment.value("PYTHONPATH")
    environment.insert("PYTHONPATH", os.pathsep.join(filter(None, [root, known])))
    return environment
