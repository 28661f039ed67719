"""Leads the map, the profile and the 3-D views to a place."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from stepfield.reconstruction import Reconstruction
from stepfield.suspects import Place
from stepfield_app.document import Document
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.feeds.selection_feed import Chosen, SelectionFeed
from stepfield_app.views.extent import Extent
from stepfield_app.views.line import ProfileLine
from stepfield_app.views.map import BAND_CELLS, MapView
from stepfield_app.views.trio import Trio

#: Compartments around a place that the map, the profile line and the 3-D views show at least.
AROUND = 12
#: The eye is away from a place at most so many times the diagonal of what is to be seen around it.
AWAY = 1.6
#: A map that shows this many times as much across comes nearer.
TOO_FAR = 8


class Lead:
    """Leads the map, the profile and the 3-D views to a place.

    Parameters
    ----------
    document : Document
    map_view : MapView
    trio : Trio
    scene_feed : SceneFeed
        Knows the local origin.
    selection_feed : SelectionFeed
    """

    def __init__(
        self,
        document: Document,
        map_view: MapView,
        trio: Trio,
        scene_feed: SceneFeed,
        selection_feed: SelectionFeed,
    ) -> None:
        self._document, self._map, self._trio = document, map_view, trio
        self._scene_feed, self._outlines = scene_feed, selection_feed

    def go_to(self, place: Place, result: Reconstruction) -> None:
        """Show a place everywhere; views that show it well already stay as they are."""
        cell_size = result.field.compartments.grid.cell_size
        self._document.set_active_layer(place.layer)
        self._pan_map(place, cell_size)
        self._map.set_line(_line_through(place, cell_size))
        self._turn_to(place, cell_size)
        self.point_out(place, result)

    def point_out(self, place: Place, result: Reconstruction) -> None:
        """Outline a place in the 3-D views."""
        mask = np.zeros(len(result.field), bool)
        mask[place.pillars] = True
        self._outlines.point_out(Chosen(result, mask))

    def _pan_map(self, place: Place, cell_size: float) -> None:
        pane, wanted = self._map.plot.pane, _surroundings(place, cell_size)
        seen: Extent = pane.visible
        is_inside = (
            seen.left <= wanted.left
            and wanted.right <= seen.right
            and seen.bottom <= wanted.bottom
            and wanted.top <= seen.top
        )
        if not is_inside or wanted.width < seen.width / TOO_FAR:
            pane.setRange(wanted.rectangle(), padding=0.5)
            pane.is_touched = True

    def _turn_to(self, place: Place, cell_size: float) -> None:
        viewpoint, around = self._trio.viewpoint, _surroundings(place, cell_size)
        farthest = AWAY * math.hypot(around.width, around.height)
        centre = np.array(place.centre) - self._scene_feed.origin
        camera = viewpoint.camera.with_centre(centre)
        viewpoint.look(replace(camera, distance=min(camera.distance, farthest)))


def _surroundings(place: Place, cell_size: float) -> Extent:
    """Return a place from above with some compartments around it."""
    x0, y0, x1, y1, _, _ = place.box
    missing = [max(0.0, AROUND * cell_size - side) / 2 for side in (x1 - x0, y1 - y0)]
    return Extent(x0 - missing[0], y0 - missing[1], x1 + missing[0], y1 + missing[1])


def _line_through(place: Place, cell_size: float) -> ProfileLine:
    """Return a line through the middle of a place, along its longer side."""
    around, (x, y, _) = _surroundings(place, cell_size), place.centre
    if around.width >= around.height:
        start, end = (around.left - around.width / 2, y), (around.right + around.width / 2, y)
    else:
        start, end = (x, around.bottom - around.height / 2), (x, around.top + around.height / 2)
    return ProfileLine(start, end, BAND_CELLS * cell_size)
