"""Arrays that live in files the drawing process maps too: large ones are in memory once, not twice."""

from __future__ import annotations

from typing import Any
from weakref import finalize

from stepfield_app.render.store import Array, Store, mapped

#: Smaller arrays are not worth a file that stays open.
LEAST = 1 << 20


class Shared:
    """Arrays by identity; a file goes when nobody in the window has its array any more.

    May be asked on any thread.
    """

    def __init__(self, store: Store) -> None:
        self._store = store
        self._where: dict[int, dict[str, Any]] = {}

    def share(self, array: Array) -> Array:
        """Return the same numbers as a shared array, read-only, or the array itself where that cannot be.

        Small arrays are not shared, nor is any while there is no room: who sends it to the drawing process
        says so then.
        """
        if array.nbytes < LEAST or self.where(array):
            return array
        try:
            where = self._store.write(array)
            shared = mapped(where)
        except OSError:
            return array
        self._where[id(shared)] = where
        finalize(shared, self._forget, id(shared)).atexit = False
        return shared

    def where(self, array: Array) -> dict[str, Any] | None:
        """Say where a shared array is; None for others."""
        return self._where.get(id(array))

    def _forget(self, key: int) -> None:
        self._store.remove(self._where.pop(key)["file"])
