"""From an answer to what the layers panel and the histogram show; remembers what has not changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import UNASSIGNED
from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield_app.feeds.plots import QUICK_PIXELS, Colours, hexed
from stepfield_app.requests import Answer
from stepfield_app.scenes.histogram import Sample, of_layers
from stepfield_app.scenes.raster import thumbnails
from stepfield_app.scenes.thinned import stride_for
from stepfield_app.views.pictures import Histogram

#: Side of a thumbnail in pixels: twice its size on the panel, for screens of 200 %.
THUMBNAIL = 96


@dataclass(frozen=True, eq=False)
class PanelWish:
    """What the layers panel and the histogram need of an answer; quick thumbnails may miss single pillars."""

    answer: Answer
    colours: Colours
    quick: bool = False


@dataclass(frozen=True, eq=False)
class PanelPictures:
    """Small pictures of all layers by number, and where the points lie in height."""

    thumbnails: Mapping[int, NDArray[np.uint8]]
    histogram: Histogram


@dataclass(frozen=True, eq=False)
class _Drawn:
    """A thumbnail and the pillars it shows."""

    pillars: NDArray[np.int64]
    picture: NDArray[np.uint8]


class PanelDrawing:
    """Draws layers small and counts points by elevation, for one thread at a time.

    An edit changes few layers: the thumbnails of the others stay, and so does the sample of points.
    """

    def __init__(self) -> None:
        self._sample: Sample | None = None
        self._stride = 1
        self._drawn: dict[int, _Drawn] = {}

    def forget(self) -> None:
        """Give the memory of the last scan back."""
        self._sample = None
        self._drawn.clear()

    def __call__(self, wish: PanelWish, progress: Progress) -> PanelPictures:
        """Draw every layer small and count points by elevation."""
        result = wish.answer.result
        if self._sample is None or self._sample.field is not result.field:
            self.forget()
            self._sample = Sample.of(result.field)
        elevations = of_layers(result, known=self._sample)
        levels = tuple(
            (layer.name, hexed(wish.colours[layer.index]), float(elevations.averages[layer.index]))
            for layer in result.layers
        )
        counts = np.rint(elevations.counts).astype(np.int64)
        colours = tuple(hexed(colour) for colour in wish.colours)
        grid = result.field.compartments.grid
        self._draw(result, stride_for(len(grid), QUICK_PIXELS) if wish.quick else 1)
        pictures = {number: drawn.picture for number, drawn in self._drawn.items()}
        return PanelPictures(pictures, Histogram(elevations.edges, counts, colours, levels))

    def _draw(self, result: Reconstruction, stride: int) -> None:
        """Draw what is not drawn yet."""
        members = {layer.index: layer.pillars for layer in result.layers}
        members[UNASSIGNED] = result.layering.members(UNASSIGNED)
        known = self._drawn if stride == self._stride else {}
        new = [number for number, pillars in members.items() if not _shows(known.get(number), pillars)]
        made = thumbnails(result, new, THUMBNAIL, stride) if new else {}
        self._stride = stride
        self._drawn = {
            number: _Drawn(pillars, made[number]) if number in made else known[number]
            for number, pillars in members.items()
        }


def _shows(drawn: _Drawn | None, pillars: NDArray[np.int64]) -> bool:
    return drawn is not None and (drawn.pillars is pillars or np.array_equal(drawn.pillars, pillars))
