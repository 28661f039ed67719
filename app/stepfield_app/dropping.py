"""Files dropped on the window, and which of them can be opened: known before what opens them is loaded."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from PySide6.QtCore import QEvent, QMimeData, QObject, Qt, Signal
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QWidget

from stepfield.formats import FORMATS
from stepfield_app.settings import Files

PROJECT = ".stepfield"


class DropTarget(QObject):
    """Lets files be dropped on a widget.

    Accepts what holds at least one file that can be opened; says no to anything else while it is still in
    the hand.
    """

    dropped = Signal(tuple)  # of Path

    def __init__(self, widget: QWidget) -> None:
        super().__init__(widget)
        widget.setAcceptDrops(True)
        widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Take the drag events of files; leave all others, such as pillars on their way, alone."""
        if not isinstance(event, QDropEvent) or not (files := files_of(event.mimeData())):
            return False
        event.setDropAction(Qt.DropAction.CopyAction)
        event.accept()
        if event.type() == QEvent.Type.Drop:
            self.dropped.emit(files)
        return True


def files_of(data: QMimeData) -> Files:
    """Return the files on this machine in a drop that can be opened."""
    return openable(Path(url.toLocalFile()) for url in data.urls() if url.isLocalFile())


def openable(files: Iterable[Path]) -> Files:
    """Return those files that can be opened together: one project, or all the scans."""
    files = tuple(files)
    projects = tuple(path for path in files if path.suffix.lower() == PROJECT)
    return projects[:1] or tuple(path for path in files if path.suffix.lower() in FORMATS)
