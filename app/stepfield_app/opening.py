"""What can be opened, and how it gets here: the file dialog, and files dropped on the window."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from PySide6.QtCore import QEvent, QMimeData, QObject, Qt, Signal
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QFileDialog, QWidget

from stepfield.project import Project
from stepfield.scan import FORMATS
from stepfield_app.settings import Files, Settings

PROJECT = ".stepfield"


def file_filters() -> str:
    """Return the kinds of files for a dialog: all that can be opened, then scans, projects, everything."""
    scans = _patterns(FORMATS)
    return ";;".join(
        (
            f"Scans and projects ({scans} *{PROJECT})",
            f"Scans ({scans})",
            f"Stepfield projects (*{PROJECT})",
            "All files (*)",
        )
    )


def ask_for_files(parent: QWidget, settings: Settings) -> Files:
    """Let the operator choose the files of one scan, or a project; none when the dialog is left."""
    names, _ = QFileDialog.getOpenFileNames(
        parent, "Open the files of one scan, or a project", str(settings.folder("open")), file_filters()
    )
    files = tuple(Path(name) for name in names)
    if files:
        settings.remember_folder("open", files[0].parent)
    return files


def openable(files: Iterable[Path]) -> Files:
    """Return those files that can be opened together: one project, or all the scans."""
    files = tuple(files)
    projects = tuple(path for path in files if path.suffix.lower() == PROJECT)
    return projects[:1] or tuple(path for path in files if path.suffix.lower() in FORMATS)


def is_project(files: Sequence[Path]) -> bool:
    """Whether files chosen together are a project rather than scans."""
    return files[0].suffix.lower() == PROJECT


def project_at(file: Path) -> Project:
    """Read a project whose scans are then named by their full paths.

    Raises
    ------
    ProjectError
        In one sentence, when the file is no project.
    """
    project = Project.read(file)
    places = zip(project.scans, project.scan_paths(file.absolute()), strict=True)
    scans = tuple(scan.model_copy(update={"path": str(path)}) for scan, path in places)
    return project.model_copy(update={"scans": scans})


class DropTarget(QObject):
    """Lets files be dropped on a widget.

    Accepts what holds at least one file that can be opened; says no to anything else while it is still in
    the hand.
    """

    dropped = Signal(tuple)  # of Path
    hovering = Signal(bool)  # whether files that can be opened are held over the widget

    def __init__(self, widget: QWidget) -> None:
        super().__init__(widget)
        widget.setAcceptDrops(True)
        widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Take the drag events of files; leave all others, such as pillars on their way, alone."""
        kind = event.type()
        if kind == QEvent.Type.DragLeave:
            self.hovering.emit(False)
            return False
        if not isinstance(event, QDropEvent) or not (files := files_of(event.mimeData())):
            return False
        event.setDropAction(Qt.DropAction.CopyAction)
        event.accept()
        self.hovering.emit(kind != QEvent.Type.Drop)
        if kind == QEvent.Type.Drop:
            self.dropped.emit(files)
        return True


def files_of(data: QMimeData) -> Files:
    """Return the files on this machine in a drop that can be opened."""
    return openable(Path(url.toLocalFile()) for url in data.urls() if url.isLocalFile())


def _patterns(suffixes: Iterable[str]) -> str:
    return " ".join(f"*{suffix}" for suffix in suffixes)
