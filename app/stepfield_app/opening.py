"""What is opened, chosen in a dialog or named: a scan of one or more files, or a project."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from stepfield.errors import ProjectError
from stepfield.files import reason, sha256_of
from stepfield.formats import FORMATS
from stepfield.parameters import Parameters
from stepfield.progress import Progress
from stepfield.project import Project
from stepfield.scan.scan import SourceFile
from stepfield_app.document import Document
from stepfield_app.dropping import PROJECT
from stepfield_app.filed import Stored, Work
from stepfield_app.newest import NewestWins
from stepfield_app.requests import paths_of
from stepfield_app.settings import Files, Settings


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


def is_project(files: Sequence[Path]) -> bool:
    """Whether files chosen together are a project rather than scans."""
    return files[0].suffix.lower() == PROJECT


def ask_for_place(parent: QWidget, start: Path) -> Path | None:
    """Let the operator choose where a project is saved; None when the dialog is left."""
    dialog = QFileDialog(parent, "Save the project", str(start.parent), f"Stepfield projects (*{PROJECT})")
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    dialog.setDefaultSuffix(PROJECT[1:])  # before it asks whether a file may be replaced
    dialog.selectFile(start.name)
    is_chosen = dialog.exec() == QFileDialog.DialogCode.Accepted
    dialog.deleteLater()
    return Path(dialog.selectedFiles()[0]) if is_chosen else None


def work_at(file: Path) -> Work:
    """Read a project whose scans are then named by their full paths.

    Raises
    ------
    ProjectError
        In one sentence, when the file is no project.
    """
    file = file.absolute()
    try:
        sha256 = sha256_of(file)  # before it is read: what changes in between is then noticed when saving
    except OSError as error:
        raise ProjectError(f"{file}: cannot read the project ({reason(error)})") from None
    project = Project.read(file)
    places = zip(project.scans, project.scan_paths(file), strict=True)
    scans = tuple(scan.model_copy(update={"path": str(path)}) for scan, path in places)
    return Work(project.model_copy(update={"scans": scans}), Stored(file, sha256))


@dataclass(frozen=True, eq=False)
class Missing:
    """A project some of whose scans are not where it says."""

    work: Work
    paths: Files

    @property
    def sentence(self) -> str:
        """What is wrong, and what to do."""
        where = self.work.stored.path if self.work.stored else "the project"
        scan = os.path.normpath(self.paths[0])
        return f"{where}: its scan {scan} is missing; put it back, or open the project and say where it is"

    def beside(self) -> Mapping[Path, Path]:
        """Return, by where they were, the scans that now lie beside the project under the same names."""
        if self.work.stored is None:
            return {}
        folder = self.work.stored.path.parent
        return {path: folder / path.name for path in self.paths if (folder / path.name).is_file()}

    def found(self, places: Mapping[Path, Path]) -> Work:
        """Return the project with its scans where they were found; it is then to be saved."""
        work = self.work
        paths = (places.get(path, path) for path in paths_of(work.project))
        scans = tuple(
            scan.model_copy(update={"path": str(path)})
            for scan, path in zip(work.project.scans, paths, strict=True)
        )
        project = work.project.model_copy(update={"scans": scans})
        return replace(work, project=project, saved=work.saved or work.project)


class Opener(QObject):
    """Opens what the operator chose in a document; reads and compares on a worker.

    Parameters
    ----------
    document : Document
    parent : QObject, optional
    """

    missing = Signal(object)  # Missing: nothing is opened until ``open_work`` is called with all scans
    failed = Signal(object)  # exception
    scans_differ = Signal(tuple)  # names of scans that are not what the project was made from

    def __init__(self, document: Document, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._document = document
        self._reader = NewestWins[_Wanted | Work, Work | Missing](_found, "project reader", self)
        self._reader.answered.connect(self._go_on)
        self._reader.failed.connect(lambda _, error: self.failed.emit(error))
        self._comparer = NewestWins[_Comparison, tuple[str, ...]](_different, "comparison of scans", self)
        self._comparer.answered.connect(self._tell)
        document.opened.connect(self._compare)

    @property
    def busy(self) -> bool:
        """Whether a project is being read."""
        return self._reader.busy

    def open(self, files: Sequence[Path], parameters: Parameters | None = None) -> None:
        """Open the files of one scan, or a project; of its parameters those replace some that are given."""
        if is_project(files):
            self._reader.ask(_Wanted(files[0], parameters))
        else:
            self._reader.cancel()
            self._document.open(files, parameters)

    def open_work(self, work: Work) -> None:
        """Open a project that was read elsewhere, once its scans are seen to be there."""
        self._reader.ask(work)

    def cancel(self) -> None:
        """Forget the project that is being read."""
        self._reader.cancel()

    def close(self) -> None:
        """End the workers."""
        self._reader.close()
        self._comparer.close()

    def _go_on(self, asked: _Wanted | Work, found: Work | Missing) -> None:
        if isinstance(found, Missing):
            self.missing.emit(found)
        else:
            self._document.open_work(found)

    def _compare(self) -> None:
        """See whether the scans are those the project was made from; their digests may take a while."""
        answer = self._document.answer
        assert answer is not None
        known = [scan.sha256 for scan in self._document.project.scans]
        self._comparer.cancel()
        if any(known):
            self._comparer.ask(_Comparison(self._document.file.work, known, answer.result.scan.files))

    def _tell(self, asked: _Comparison, names: tuple[str, ...]) -> None:
        if names and asked.work is self._document.file.work:
            self.scans_differ.emit(names)


@dataclass(frozen=True, eq=False)
class _Comparison:
    """Digests a project remembers, and the files that were read."""

    work: Work
    known: Sequence[str | None]
    files: Sequence[SourceFile]


@dataclass(frozen=True, eq=False)
class _Wanted:
    """A project file, and parameters some of which may have been given besides."""

    file: Path
    parameters: Parameters | None

    def work(self) -> Work:
        """Read the project; what is given is then to be saved."""
        work = work_at(self.file)
        given = (
            self.parameters.model_dump(include=self.parameters.model_fields_set) if self.parameters else {}
        )
        parameters = Parameters.checked(**(work.project.parameters.model_dump() | given))
        if parameters == work.project.parameters:
            return work
        return replace(
            work, project=work.project.model_copy(update={"parameters": parameters}), saved=work.project
        )


def _found(wanted: _Wanted | Work, progress: Progress) -> Work | Missing:
    work = wanted if isinstance(wanted, Work) else wanted.work()
    absent = tuple(path for path in paths_of(work.project) if not path.exists())
    if not work.project.scans:
        where = work.stored.path if work.stored else "the project"
        raise ProjectError(f"{where}: the project names no scan; open a scan and save it as a project")
    return Missing(work, absent) if absent else work


def _different(asked: _Comparison, progress: Progress) -> tuple[str, ...]:
    pairs = zip(asked.known, asked.files, strict=True)
    return tuple(file.name for known, file in pairs if known and known != file.sha256)


def _patterns(suffixes: Iterable[str]) -> str:
    return " ".join(f"*{suffix}" for suffix in suffixes)
