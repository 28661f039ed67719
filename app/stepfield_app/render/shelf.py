"""Arrays the drawing process can read: each written once, kept as long as a scene needs it."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import QObject, Qt, Signal

from stepfield_app.render.protocol import Array
from stepfield_app.render.shared import Shared
from stepfield_app.render.store import Store

#: Arrays up to so many bytes are written at once; larger ones by a thread.
SMALL = 1 << 20


@dataclass
class Entry:
    """An array, and where it is once it is written."""

    array: Array
    where: dict[str, Any] | None = None


class Shelf(QObject):
    """Arrays by identity."""

    written = Signal()
    failed = Signal(str)  # why

    _done = Signal(object, object)

    def __init__(self, store: Store, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store, self._shared = store, Shared(store)
        self.share = self._shared.share
        self._entries: dict[int, Entry] = {}
        self._writer = ThreadPoolExecutor(1, "shelf")
        self._done.connect(self._note, Qt.ConnectionType.QueuedConnection)

    def has(self, arrays: Iterable[Array]) -> bool:
        """Whether all are written; begin with those that are not."""
        entries = [self._entry(array) for array in arrays if not self._shared.where(array)]
        return all(entry.where is not None for entry in entries)

    def where(self, array: Array) -> dict[str, Any]:
        """Say where a written array is."""
        where = self._shared.where(array) or self._entries[id(array)].where
        assert where is not None
        return where

    def keep(self, arrays: Iterable[Array]) -> None:
        """Forget all others."""
        wanted = {id(array) for array in arrays}
        for key in [key for key, entry in self._entries.items() if key not in wanted and entry.where]:
            where = self._entries.pop(key).where
            assert where is not None
            self._store.remove(where["file"])

    def close(self) -> None:
        """Stop writing."""
        self._writer.shutdown(wait=True, cancel_futures=True)

    def _entry(self, array: Array) -> Entry:
        entry = self._entries.get(id(array))
        if entry is None:
            self._entries[id(array)] = entry = Entry(array)
            if array.nbytes <= SMALL:
                entry.where = self._store.write(array)
            else:
                self._writer.submit(self._write, array)
        return entry

    def _write(self, array: Array) -> None:
        try:
            where = self._store.write(array)
        except OSError as error:
            self.failed.emit(str(error.strerror))
        else:
            self._done.emit(array, where)

    def _note(self, array: Array, where: dict[str, Any]) -> None:
        self._entries[id(array)].where = where
        self.written.emit()
