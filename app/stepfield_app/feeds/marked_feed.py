"""Outlines the selection in the map and in the profile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Signal

from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield_app.newest import NewestWins
from stepfield_app.scenes.marked import Marked, marked
from stepfield_app.selection import Selection
from stepfield_app.views.map import MapView
from stepfield_app.views.profile import ProfileView

NONE = np.zeros(0, bool)


@dataclass(frozen=True, eq=False)
class _Wish:
    """A selection to look at from above, and the layer that is shown."""

    result: Reconstruction
    mask: NDArray[np.bool_]
    layer: int

    def is_as(self, other: _Wish) -> bool:
        """Whether the same cells are to be outlined."""
        return self.result is other.result and self.mask is other.mask and self.layer == other.layer


class MarkedFeed(QObject):
    """Keeps the outlines true to the selection.

    Parameters
    ----------
    selection : Selection
    map_view : MapView
    profile : ProfileView
    """

    failed = Signal(object)  # exception

    def __init__(self, selection: Selection, map_view: MapView, profile: ProfileView) -> None:
        super().__init__(selection)
        self._selection, self._map, self._profile = selection, map_view, profile
        self._shown: _Wish | None = None
        self._cells = NewestWins[_Wish, "Marked | None"](_marked, "selection in the map", self)
        self._cells.answered.connect(self._show_cells)
        self._cells.failed.connect(lambda _, error: self.failed.emit(error))
        selection.changed.connect(self._take)
        map_view.picture_changed.connect(self._mark)
        profile.section_changed.connect(self._outline)

    @property
    def is_idle(self) -> bool:
        """Whether the outlines are those of the selection."""
        return not self._cells.busy

    def close(self) -> None:
        """End the worker."""
        self._cells.close()

    def _take(self) -> None:
        self._mark()
        self._outline()

    def _mark(self) -> None:
        selection = self._selection
        if selection.mask is None or selection.result is None or not selection.count:
            self._cells.cancel()
            self._shown = None
            self._map.plot.selected.set_marked(None)
            return
        wish = _Wish(selection.result, selection.mask, self._map.layer)
        if self._shown is None or self._cells.busy or not wish.is_as(self._shown):
            self._cells.ask(wish)

    def _show_cells(self, wish: _Wish, cells: Marked | None) -> None:
        if self._selection.count:
            self._shown = wish
            self._map.plot.selected.set_marked(cells)

    def _outline(self) -> None:
        """Outline the blocks; a section of other pillars than those selected among shows none."""
        section, selection = self._profile.section, self._selection
        if section is None or selection.mask is None or selection.result is None:
            self._profile.set_selected(NONE)
        elif section.field is selection.result.field:
            self._profile.set_selected(selection.mask[section.pillars])
        else:
            self._profile.set_selected(NONE)


def _marked(wish: _Wish, progress: Progress) -> Marked | None:
    return marked(wish.result, wish.mask, wish.layer)
