"""From an answer to what the plots show: functions for workers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import UNASSIGNED
from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield_app.requests import Answer
from stepfield_app.scenes.cloud import Cloud
from stepfield_app.scenes.fidelity import FidelityFacts
from stepfield_app.scenes.overlays import Overlay, overlay
from stepfield_app.scenes.palette import UNASSIGNED_CODE
from stepfield_app.scenes.raster import Raster, raster
from stepfield_app.scenes.section import Band, band, section
from stepfield_app.scenes.thinned import coarse_grid, stride_for
from stepfield_app.views.line import ProfileLine
from stepfield_app.views.pictures import OVERLAYS, MapPicture, Section

Colours = NDArray[np.uint8]
#: Compartments of a map while a hand moves.
QUICK_PIXELS = 120_000


@dataclass(frozen=True, eq=False)
class MapWish:
    """A layer to draw from above; ``colours`` has a row a layer and one for Unassigned.

    While a hand moves a ``quick`` picture will do: of a large map only some of the compartments. Errors are
    drawn of the result that ``facts`` are of: a newer one's are still being found out.
    """

    answer: Answer
    layer: int
    mode: str
    colours: Colours
    quick: bool = False
    facts: FidelityFacts | None = None


@dataclass(frozen=True, eq=False)
class SectionWish:
    """A line to cut along."""

    answer: Answer
    cloud: Cloud
    line: ProfileLine
    colours: Colours


def map_picture(wish: MapWish, progress: Progress) -> MapPicture:
    """Draw a layer from above."""
    result, mode = _drawn_result(wish), cast("Any", wish.mode)
    grid = result.field.compartments.grid
    stride = stride_for(len(grid), QUICK_PIXELS) if wish.quick and mode != "gray" else 1
    grid = coarse_grid(grid, stride)
    drawn: Raster | Overlay
    if mode in OVERLAYS:
        errors = wish.facts.comparison.errors if wish.facts is not None else ()
        drawn = overlay(result, wish.layer, mode, errors, wish.colours, stride)
    else:
        drawn = raster(result, wish.layer, mode, stride=stride)
    return MapPicture(
        layer=wish.layer,
        name=_name(result, wish.layer),
        colour=hexed(wish.colours[wish.layer]),
        pixels=drawn.pixels,
        west=grid.west,
        south=grid.south,
        east=grid.west + grid.columns * grid.cell_size,
        north=grid.south + grid.rows * grid.cell_size,
        cell_size=grid.cell_size,
        legend=drawn.legend,
        values=drawn.values if isinstance(drawn, Overlay) else None,
        names=drawn.names if isinstance(drawn, Overlay) else (),
        mode=mode,
    )


def _drawn_result(wish: MapWish) -> Reconstruction:
    facts = wish.facts
    if wish.mode == "error" and facts is not None and wish.layer < len(facts.result.layers):
        return facts.result
    return wish.answer.result


class Cutting:
    """Cuts scans along lines, for one thread at a time; looks for the points again for another line only."""

    def __init__(self) -> None:
        self._of: tuple[Cloud, ProfileLine] | None = None
        self._band: Band | None = None

    def forget(self) -> None:
        """Give the memory of the last scan back."""
        self._of = self._band = None

    def __call__(self, wish: SectionWish, progress: Progress) -> Section:
        """Cut the scan and its pillars along a line."""
        line = wish.line
        if self._band is None or self._of is None or self._of[0] is not wish.cloud or self._of[1] != line:
            self._of, self._band = None, None  # the old points go before the new ones take their memory
            self._band = band(wish.cloud, line.start, line.end, line.width)
            self._of = wish.cloud, line
        return _section(wish, self._band)


def _section(wish: SectionWish, near: Band) -> Section:
    result, line = wish.answer.result, wish.line
    found = section(near, result)
    cut, last = found.cut, len(result.layers)
    foot = np.where(cut.standing, found.base_elevation, cut.low)
    return Section(
        start=line.start,
        end=line.end,
        width=line.width,
        distance=found.along.astype(np.float64),
        elevation=found.elevation,
        codes=np.where(found.codes == UNASSIGNED_CODE, last, found.codes).astype(np.uint8),
        spans=np.column_stack([cut.start, cut.end, foot, np.maximum(cut.high, cut.elevation)]),
        tops=cut.elevation,
        pillar_codes=np.where(cut.layer < 0, last, cut.layer).astype(np.uint8),
        colours=wish.colours,
        total=found.found,
        pillars=cut.pillar,
        field=result.field,
        vertical=cut.vertical,
    )


def _name(result: Reconstruction, layer: int) -> str:
    return "Unassigned" if layer == UNASSIGNED else result.layers[layer].name


def hexed(colour: NDArray[np.uint8]) -> str:
    """Write a colour as it is written in a style sheet."""
    red, green, blue = (int(part) for part in colour)
    return f"#{red:02x}{green:02x}{blue:02x}"
