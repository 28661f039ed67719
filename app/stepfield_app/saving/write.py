"""Writing a project file: paths relative to it, digests of the scans, the view it was left with."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stepfield.errors import ProjectError
from stepfield.files import sha256_of, write_atomically
from stepfield.project import Project, ScanFile
from stepfield.scan.scan import SourceFile
from stepfield_app.filed import Stored


class ChangedByAnother(ProjectError):
    """The file is not what it was when it was read or written last: somebody else has saved there."""

    def __init__(self, path: Path) -> None:
        super().__init__(f"{path}: another window or program has changed the file; nothing was written")
        self.path = path


@dataclass(frozen=True, eq=False)
class Save:
    """What is to be written.

    Attributes
    ----------
    project : Project
        Its scans are named by their full paths.
    path : Path
    expected : str, optional
        Digest of the content that may be replaced; any content may where there is none.
    sources : tuple of SourceFile
        The files of the scan; their digests are stored.
    view : dict
        How the project is looked at.
    """

    project: Project
    path: Path
    expected: str | None = None
    sources: tuple[SourceFile, ...] = ()
    view: dict[str, Any] = field(default_factory=dict)


def write(save: Save) -> Stored:
    """Write a project, and return what then lies there.

    Raises
    ------
    ChangedByAnother
        When the file has another content than expected.
    ProjectError
        In one sentence, when it cannot be written; the old file is whole then.
    """

    def check() -> None:
        if save.expected is not None and _digest(save.path) not in (None, save.expected):
            raise ChangedByAnother(save.path)

    content = content_of(_portable(save), save.path)
    check()  # before anything is written, and again when only the last step remains
    write_atomically(save.path, content, ProjectError, check)
    return Stored(save.path, hashlib.sha256(content).hexdigest())


def content_of(project: Project, path: Path) -> bytes:
    """Return the content of a project file, or say why there can be none."""
    try:
        return project.content()
    except ValueError:  # a file name that holds bytes of no text
        raise ProjectError(
            f"{path}: cannot write the file (the name of a scan is not valid UTF-8); rename the scan"
        ) from None


def _portable(save: Save) -> Project:
    """Return the project as it is stored: scans relative to it, and with their digests."""
    digests = [_digest_of(source) for source in save.sources] or [scan.sha256 for scan in save.project.scans]
    scans = tuple(
        ScanFile(path=Project.stored_path(Path(scan.path), save.path), sha256=digest or scan.sha256)
        for scan, digest in zip(save.project.scans, digests, strict=True)
    )
    return save.project.model_copy(update={"scans": scans, "view": save.view})


def _digest_of(source: SourceFile) -> str | None:
    try:
        return source.sha256
    except OSError:  # gone since it was read
        return None


def _digest(path: Path) -> str | None:
    try:
        return sha256_of(path)
    except FileNotFoundError:
        return None
    except OSError:
        return ""  # there, but nobody knows what it holds
