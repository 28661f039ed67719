"""Files that pictures come in; one is used again only when nothing looks at its last picture any more."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from weakref import ReferenceType, ref

import numpy as np

from stepfield_app.render.protocol import Array
from stepfield_app.render.scene import Bytes, Singles
from stepfield_app.render.store import Store


@dataclass
class Slot:
    """A mapped file."""

    path: Path
    room: Array
    asked: bool = False
    watched: ReferenceType[Array] | None = None

    @property
    def free(self) -> bool:
        """Whether a new picture may be drawn into it."""
        return not self.asked and (self.watched is None or self.watched() is None)

    def picture(self, size: tuple[int, int], with_depth: bool) -> tuple[Bytes, Singles | None]:
        """Pixels and depth of the picture in it; the slot is taken while these or parts of them are alive."""
        width, height = size
        # views of views refer to the first array: this one, for numpy does not look behind a memoryview
        whole = np.frombuffer(memoryview(self.room), np.uint8)  # type: ignore[arg-type]  # numpy gives one
        self.watched = ref(whole)
        half = width * height * 4
        pixels = whole[:half].reshape(height, width, 4)
        depth = whole[half : 2 * half].view(np.float32).reshape(height, width) if with_depth else None
        return pixels, depth


class Slots:
    """As many slots as are looked at, asked for, or were lately."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._slots: list[Slot] = []

    def free(self, length: int) -> Slot:
        """Return a slot with so many bytes; give up free ones that are too small or much too large."""
        usable = [slot for slot in self._slots if slot.free and length <= len(slot.room) <= 4 * length]
        for slot in [slot for slot in self._slots if slot.free and slot not in usable]:
            self._slots.remove(slot)
            self._store.remove(slot.path)
        if not usable:
            usable = [Slot(*self._store.blank(length))]
            self._slots += usable
        return usable[0]
