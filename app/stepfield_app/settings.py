"""What the program remembers from one day to the next, with types; a damaged entry counts as absent."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import get_args

from PySide6.QtCore import QByteArray, QSettings, QStandardPaths

from stepfield_app.appearance import Choice

#: A scan may come in several files, so a recent one is a list of them.
Files = tuple[Path, ...]

MOST_RECENT = 10
#: Raise it when docks are renamed or added: an older arrangement is then left alone.
ARRANGEMENT = 3


class Settings:
    """The operator's habits.

    Parameters
    ----------
    store : QSettings, optional
        The user's own by default.
    """

    def __init__(self, store: QSettings | None = None) -> None:
        self._store = store or QSettings(
            QSettings.defaultFormat(), QSettings.Scope.UserScope, "Stepfield", "Stepfield"
        )

    @property
    def theme(self) -> Choice:
        """Light, dark, or the system's."""
        return next((choice for choice in get_args(Choice) if choice == self._text("theme")), "system")

    @theme.setter
    def theme(self, choice: Choice) -> None:
        self._store.setValue("theme", choice)

    @property
    def recent(self) -> tuple[Files, ...]:
        """What was opened last and still exists, the newest first."""
        return tuple(files for files in self._recent() if all(path.exists() for path in files))[:MOST_RECENT]

    def remember_opened(self, files: Sequence[Path]) -> None:
        """Put files that were opened together on top of the recent ones."""
        newest = tuple(path.absolute() for path in files)
        entries = [newest, *(entry for entry in self._recent() if entry != newest)][:MOST_RECENT]
        self._store.setValue("recent", json.dumps([[str(path) for path in entry] for entry in entries]))

    def forget_recent(self) -> None:
        """Empty the list of recent files."""
        self._store.remove("recent")

    def folder(self, purpose: str) -> Path:
        """Return the folder last used for a purpose such as ``open`` or ``export``, else the documents."""
        text = self._text(f"folders/{purpose}")
        if text and Path(text).is_dir():
            return Path(text)
        documents = QStandardPaths.writableLocation(QStandardPaths.StandardLocation.DocumentsLocation)
        return Path(documents) if Path(documents).is_dir() else Path.home()

    def remember_folder(self, purpose: str, folder: Path) -> None:
        """Start there next time."""
        self._store.setValue(f"folders/{purpose}", str(folder.absolute()))

    @property
    def targets(self) -> tuple[str, ...]:
        """Names of the simulators that were exported for last."""
        return tuple(filter(None, self._text("targets").split(" ")))

    @targets.setter
    def targets(self, names: Sequence[str]) -> None:
        self._store.setValue("targets", " ".join(names))

    @property
    def geometry(self) -> QByteArray:
        """Place and size of the window, as ``saveGeometry`` gave it; empty the first time."""
        return self._bytes("window/geometry")

    @geometry.setter
    def geometry(self, geometry: QByteArray) -> None:
        self._store.setValue("window/geometry", geometry)

    @property
    def arrangement(self) -> QByteArray:
        """The docks, as ``saveState(ARRANGEMENT)`` gave them; empty the first time."""
        return self._bytes(f"window/arrangement-{ARRANGEMENT}")

    @arrangement.setter
    def arrangement(self, state: QByteArray) -> None:
        self._store.setValue(f"window/arrangement-{ARRANGEMENT}", state)

    def _recent(self) -> list[Files]:
        try:
            entries = json.loads(self._text("recent"))
        except ValueError:
            return []
        kept = filter(_is_list_of_text, entries) if isinstance(entries, list) else ()
        return [tuple(map(Path, entry)) for entry in kept]

    def _text(self, key: str) -> str:
        value = self._store.value(key, "")
        return value if isinstance(value, str) else ""

    def _bytes(self, key: str) -> QByteArray:
        value = self._store.value(key)
        return value if isinstance(value, QByteArray) else QByteArray()


def _is_list_of_text(entry: object) -> bool:
    return isinstance(entry, list) and bool(entry) and all(isinstance(item, str) for item in entry)
