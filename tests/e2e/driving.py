"""What works the real window: the real mouse and keyboard under Xvfb, and waits for what comes of them.

A program made of this runs the window in its own process, so that it can see when something has come true.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

from PySide6.QtCore import QEvent, QMimeData, QObject, QPoint, Qt, QTimer, QUrl
from PySide6.QtGui import QDrag, QMouseEvent
from PySide6.QtWidgets import QApplication, QDialog, QLabel, QMainWindow, QWidget

from stepfield_app.appearance import Appearance
from stepfield_app.main_window import MainWindow
from stepfield_app.settings import Settings

#: Milliseconds between two looks, and looks before a wait is given up.
LOOK, PATIENCE = 20, 1500

Place = tuple[int, int]
#: What is waited for, and whether it has come true.
Wait = tuple[str, Callable[[], bool]]
Steps = Iterator[Wait]


class Source(QLabel):
    """A file that can be dragged out of another window, as from a file manager."""

    def __init__(self, path: Path) -> None:
        super().__init__(path.name)
        self._path = path
        self.setWindowFlag(Qt.WindowType.WindowStaysOnTopHint)
        self.setGeometry(1300, 820, 200, 60)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Begin the drag."""
        data = QMimeData()
        data.setUrls([QUrl.fromLocalFile(str(self._path))])
        drag = QDrag(self)
        drag.setMimeData(data)
        drag.exec(Qt.DropAction.CopyAction)


class Desktop(QObject):
    """Gives the keyboard to a window that opens, and back when it closes: there is no window manager."""

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        """Follow windows and dialogs."""
        if isinstance(watched, QDialog | QMainWindow):
            if event.type() == QEvent.Type.Show:
                QTimer.singleShot(0, watched, watched.activateWindow)
            elif event.type() == QEvent.Type.Hide:
                QTimer.singleShot(0, _activate_what_is_left)
        return False


def _activate_what_is_left() -> None:
    modal = QApplication.activeModalWidget()
    windows = [widget for widget in QApplication.topLevelWidgets() if isinstance(widget, QMainWindow)]
    for window in [modal] if modal else windows:
        window.activateWindow()


# --- Mouse and keyboard -------------------------------------------------------------------------------------


_hands: list[subprocess.Popen[bytes]] = []


def xdotool(*words: object) -> None:
    """Move the real mouse and press real keys; starts it and does not wait, as this very thread answers."""
    _hands.append(subprocess.Popen(["xdotool", *map(str, words)], start_new_session=True))


def is_resting() -> bool:
    """Whether all has been pressed and released: a key that is still down cannot be pressed again."""
    _hands[:] = [hand for hand in _hands if hand.poll() is None]
    return not _hands


def at(widget: QWidget, x: float, y: float) -> Place:
    """Return the place on the screen of a point of a widget, given as shares of its size."""
    return on_screen(widget, int(x * (widget.width() - 1)), int(y * (widget.height() - 1)))


def on_screen(widget: QWidget, x: float, y: float) -> Place:
    """Return the place on the screen of a pixel of a widget."""
    place = widget.mapToGlobal(QPoint(round(x), round(y)))
    return place.x(), place.y()


def clicking(place: Place, button: int = 1) -> list[object]:
    """Words that make xdotool click at a place."""
    return ["mousemove", *place, "click", button]


def carrying(place: Place, other: Place) -> list[object]:
    """Words that make xdotool press a button at a place and go to another without letting go."""
    return ["mousemove", *place, "sleep", 0.1, "mousedown", 1, *moving(place, other)]


def moving(one: Place, other: Place) -> list[object]:
    """Words that make xdotool move from place to place as a hand does."""
    words: list[object] = []
    for step in range(1, 13):
        there = [round(a + (b - a) * step / 12) for a, b in zip(one, other, strict=True)]
        words += ["mousemove", *there, "sleep", 0.03]
    return words


def dragging(*places: Place, button: int = 1) -> list[object]:
    """Words that make xdotool drag from place to place."""
    words: list[object] = ["mousemove", *places[0], "sleep", 0.1, "mousedown", button]
    for one, other in pairwise(places):
        words += moving(one, other)
    return [*words, "mouseup", button]


def typing(*keys: str) -> list[object]:
    """Words that make xdotool press keys one after the other."""
    return ["key", "--delay", 15, *keys]


def pressed() -> bool:
    """Whether a mouse button is still down."""
    return QApplication.mouseButtons() != Qt.MouseButton.NoButton


# --- Looking ------------------------------------------------------------------------------------------------


def dialog(name: str) -> Any:
    """Return the dialog of a class of this name while it is open and drawn, else None."""
    active = QApplication.activeModalWidget()
    return active if active is not None and type(active).__name__ == name else None


def picture(window: QWidget, folder: Path, name: str) -> None:
    """Save what the window shows."""
    window.grab().save(str(folder / f"{name}.png"))


# --- Running ------------------------------------------------------------------------------------------------


class Driver:
    """Takes the next step whenever what the last one waits for has come true."""

    def __init__(self, window: MainWindow, todo: Steps, report: dict[str, Any], failed_to: Path) -> None:
        self._window, self._todo, self._report, self._failed_to = window, todo, report, failed_to
        self._wait: Wait = ("the start", lambda: True)
        self._looks = 0
        self._timer = QTimer(interval=LOOK)
        self._timer.timeout.connect(self._look)
        self._timer.start()

    def _look(self) -> None:
        self._looks += 1
        try:
            if is_resting() and self._wait[1]():
                self._wait, self._looks = next(self._todo), 0
            elif self._looks > PATIENCE:
                self._stop(f"waited in vain for {self._wait[0]}")
        except StopIteration:
            self._stop(None)
        except Exception as error:  # noqa: BLE001 - told in the report; the window would stay open otherwise
            self._stop(f"{self._wait[0]}: {error!r}")

    def _stop(self, failure: str | None) -> None:
        self._timer.stop()
        self._report["failure"] = failure
        if failure:
            self._window.grab().save(str(self._failed_to))
            messages = [message.sentence for message in self._window.message_bar.messages]
            self._report["messages"] = messages
            self._window.filing.close_without()
            for widget in QApplication.topLevelWidgets():
                widget.close()
        QApplication.quit()


def run(todo: Callable[[MainWindow, dict[str, Any]], Steps], report_to: Path) -> None:
    """Open the window, do it all, and write what was true on the way to a file."""
    report: dict[str, Any] = {"failure": "the program ended early"}
    QApplication.setAttribute(Qt.ApplicationAttribute.AA_DontUseNativeDialogs)
    application = QApplication([])
    application.setQuitOnLastWindowClosed(False)  # the driver has to see it first
    desktop = Desktop()
    application.installEventFilter(desktop)
    window = MainWindow(Appearance(application, "dark"), Settings(), size=(1600, 1000))
    window.show()
    driver = Driver(window, todo(window, report), report, report_to.with_suffix(".png"))
    application.exec()
    application.removeEventFilter(desktop)
    del driver
    write_report(report, report_to)


def write_report(report: dict[str, Any], file: Path) -> None:
    """Write a report whole: somebody may be waiting for it."""
    unfinished = file.with_suffix(".part")
    unfinished.write_text(json.dumps(report))
    unfinished.replace(file)
