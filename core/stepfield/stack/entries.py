"""What manifest.json says of files, grid, images and layers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from stepfield.parameters import Frozen, Unit, Up


def _plain(name: str) -> str:
    """Keep a manifest from pointing outside its own folder."""
    if name != Path(name).name or name in {"", ".", ".."} or "\\" in name:
        raise ValueError("a file name without folders is needed")
    return name


FileName = Annotated[str, AfterValidator(_plain)]
Natural = Annotated[int, Field(ge=0)]
Positive = Annotated[int, Field(ge=1)]
Metres = Annotated[float, Field(allow_inf_nan=False)]


class SourceEntry(Frozen):
    """A file of the scan."""

    name: str
    sha256: str
    points: Natural


class Source(Frozen):
    """Where the points came from."""

    files: tuple[SourceEntry, ...]
    crs: str | None
    unit: Unit
    unit_factor: Metres
    up: Up


class GridEntry(Frozen):
    """The grid of compartments; ``origin`` is its west and south edge."""

    origin: tuple[Metres, Metres]
    cell_size: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    columns: Positive
    rows: Positive


class ImageEntry(Frozen):
    """The images' size; ``offset`` is the column and row of the grid's north-west compartment."""

    width: Positive
    height: Positive
    bits: Literal[8, 16]
    offset: tuple[Natural, Natural]


class ClearanceEntry(Frozen):
    """The room above a layer: clearance = offset + scale * gray, and less than a level more.

    Gray 0 is where nothing is above, and in holes. ``pillars`` have something above, ``least`` and
    ``greatest`` metres higher.
    """

    image: FileName
    scale: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    offset: Metres = 0.0
    pillars: Natural
    least: Metres | None
    greatest: Metres | None


class LayerEntry(Frozen):
    """One layer: elevation = offset + scale * gray, within half a level.

    ``mask`` is where pillars are; ``filled_mask``, where holes were filled: there the image has a height
    that nobody measured, in ``filled`` pixels. ``pillars`` and heights are of what was measured.
    Obstacles are solid: ``bottom`` is an image of their lower ends, of the same scale, offset and mask.
    """

    index: Natural
    name: str
    image: FileName
    mask: FileName
    pillars: Natural
    height_min: Metres | None
    height_max: Metres | None
    height_mean: Metres | None
    scale: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    offset: Metres
    kind: Literal["surface", "obstacles"] = "surface"
    bottom: FileName | None = None
    clearance: ClearanceEntry | None = None
    filled_mask: FileName | None = None
    filled: Natural = 0


class ComplexEntry(Frozen):
    """The mesh of what height-maps cannot hold; they have holes where it stands in for ``pillars``.

    A binary PLY in scan coordinates, metres, float64.
    """

    mesh: FileName
    vertices: Natural
    triangles: Natural
    pillars: Natural
