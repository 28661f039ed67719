"""A vertical section along a line: the points near it, and the pillars it cuts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.grid import Grid
from stepfield.pillars import StepField
from stepfield.reconstruction import Reconstruction
from stepfield.scan import Scan
from stepfield_app.scenes.arrays import CHUNK, frozen, in_chunks
from stepfield_app.scenes.cloud import Cloud
from stepfield_app.scenes.membership import point_codes

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: More points than this show nothing more in a profile.
MOST_POINTS = 200_000


@dataclass(frozen=True, eq=False)
class Cut:
    """Pillars that the line passes over, in the order it does, from the lowest up.

    Attributes
    ----------
    pillar, layer : ndarray of shape (n,), int64
        Index into the step-field; layer, -1 for none.
    start, end : ndarray of shape (n,), float64
        Metres along the line.
    low, high, elevation : ndarray of shape (n,), float64
        Scan coordinates, metres.
    standing : ndarray of shape (n,), bool
        Whether it is the lowest of its compartment, which stands on the base plane.
    vertical : ndarray of shape (n,), bool
        Whether it is a wall.
    """

    pillar: Integers
    layer: Integers
    start: Floats
    end: Floats
    low: Floats
    high: Floats
    elevation: Floats
    standing: NDArray[np.bool_]
    vertical: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Section:
    """What a line through a scan cuts.

    Attributes
    ----------
    length : float
        Of the line, metres.
    along : ndarray of shape (n,), float32
        Metres from the start of the line.
    elevation : ndarray of shape (n,), float64
        Scan coordinates, metres.
    codes : ndarray of shape (n,), uint8
        Rows of :func:`~stepfield_app.scenes.palette.layer_palette`.
    found : int
        Points near the line; more than n when only an even subset is given.
    cut : Cut
    base_elevation : float
        Of the base plane, metres.
    """

    length: float
    along: NDArray[np.float32]
    elevation: Floats
    codes: NDArray[np.uint8]
    found: int
    cut: Cut
    base_elevation: float


@dataclass(frozen=True, eq=False)
class Band:
    """The points near a line, whatever the pillars: all of them are looked at to find these.

    Attributes
    ----------
    scan : Scan
    tail, tip : ndarray of shape (2,), float64
        Ends of the line, scan coordinates, metres.
    rows : ndarray of shape (n,), int64
        Which points of the scan.
    along : ndarray of shape (n,), float32
        Metres from the start of the line.
    elevation : ndarray of shape (n,), float64
        Scan coordinates, metres.
    found : int
        How many there are; more than n when only an even subset is given.
    """

    scan: Scan
    tail: Floats
    tip: Floats
    rows: Integers
    along: NDArray[np.float32]
    elevation: Floats
    found: int


def band(
    cloud: Cloud, start: Sequence[float], end: Sequence[float], width: float, most: int = MOST_POINTS
) -> Band:
    """Find the points near a line.

    Parameters
    ----------
    cloud : Cloud
    start, end : sequence of float
        x and y in scan coordinates, metres.
    width : float
        Points within half of it on either side are taken, metres.
    most : int
        Points at most; beyond that an even subset in the scan's order.
    """
    tail, tip = np.array(start[:2], np.float64), np.array(end[:2], np.float64)
    near, along = _near(cloud, tail - cloud.origin[:2], tip - cloud.origin[:2], width)
    found = len(near)
    if found > most:
        kept = np.linspace(0, found - 1, most).astype(np.int64)
        near, along = near[kept], along[kept]
    elevation = cloud.scan.z.values(near)
    return Band(cloud.scan, tail, tip, frozen(near), frozen(along), frozen(elevation), found)


def section(band: Band, result: Reconstruction) -> Section:
    """Cut the pillars along the line of a band, and tell which of them its points belong to."""
    return Section(
        length=float(np.hypot(*(band.tip - band.tail))),
        along=band.along,
        elevation=band.elevation,
        codes=point_codes(band.scan, result, band.rows),
        found=band.found,
        cut=cut(result, band.tail, band.tip),
        base_elevation=result.base_elevation,
    )


def cut(result: Reconstruction, tail: Floats, tip: Floats) -> Cut:
    """Find the pillars under a line from ``tail`` to ``tip``, x and y in scan coordinates, metres."""
    field, length = result.field, float(np.hypot(*(tip - tail)))
    compartment, enter, leave = _crossed(field.compartments.grid, tail, tip)
    crossing, pillar = _standing_in(field, compartment)
    lowest = field.compartments.lowest
    return Cut(
        pillar=frozen(pillar),
        layer=frozen(result.layering.layer[pillar]),
        start=frozen(enter[crossing] * length),
        end=frozen(leave[crossing] * length),
        low=frozen(field.lows(pillar) + lowest),
        high=frozen(field.highs(pillar) + lowest),
        elevation=frozen(field.elevation[pillar] + lowest),
        standing=frozen(_is_lowest(field, pillar)),
        vertical=frozen(field.vertical[pillar]),
    )


def _is_lowest(field: StepField, pillar: Integers) -> NDArray[np.bool_]:
    """Mask of the pillars that are the lowest of their compartment."""
    below = np.maximum(pillar - 1, 0)
    lowest: NDArray[np.bool_] = (field.compartment[below] != field.compartment[pillar]) | (pillar == 0)
    return lowest


def _near(cloud: Cloud, tail: Floats, tip: Floats, width: float) -> tuple[Integers, NDArray[np.float32]]:
    """Points within half the width of the line and between its ends, and how far along they are."""
    length = float(np.hypot(*(tip - tail)))
    if not length:
        return np.zeros(0, np.int64), np.zeros(0, np.float32)
    east, north = ((tip - tail) / length).astype(np.float32)
    (left, low), (right, high) = np.minimum(tail, tip) - width / 2, np.maximum(tail, tip) + width / 2
    found: dict[int, tuple[Integers, NDArray[np.float32]]] = {}

    def look(part: slice) -> None:
        x, y = cloud.places[part, 0], cloud.places[part, 1]
        at = np.flatnonzero((x >= left) & (x <= right) & (y >= low) & (y <= high))
        x, y = x[at] - np.float32(tail[0]), y[at] - np.float32(tail[1])
        along = x * east + y * north
        aside = np.abs(x * north - y * east)
        inside = (aside <= width / 2) & (along >= 0) & (along <= length)
        found[part.start // CHUNK] = at[inside] + part.start, along[inside]

    in_chunks(len(cloud), look)
    parts = [found[i] for i in sorted(found)]
    return np.concatenate([at for at, _ in parts]), np.concatenate([along for _, along in parts])


def _crossed(grid: Grid, tail: Floats, tip: Floats) -> tuple[Integers, Floats, Floats]:
    """Compartments under a line, and the shares of the line (0 to 1) where it enters and leaves each."""
    corner, sides = np.array([grid.west, grid.south]), (grid.columns, grid.rows)
    begin, step = (tail - corner) / grid.cell_size, (tip - tail) / grid.cell_size
    stops = [np.array([0.0, 1.0])]
    for at, by, count in zip(begin, step, sides, strict=True):
        if by:
            stops.append((np.arange(count + 1) - at) / by)
    share = np.unique(np.clip(np.concatenate(stops), 0, 1))
    share = share[np.append(np.diff(share) > 1e-12, True)]
    middle = begin + (share[:-1] + share[1:])[:, np.newaxis] / 2 * step
    inside = ((middle >= 0) & (middle <= sides)).all(axis=1) & step.any()
    east, north = middle[inside].T * grid.cell_size
    return grid.compartment(east, north), share[:-1][inside], share[1:][inside]


def _standing_in(field: StepField, compartment: Integers) -> tuple[Integers, Integers]:
    """Pair the place in ``compartment`` with each of the pillars there."""
    occupied = field.compartments.occupied
    at = np.minimum(np.searchsorted(occupied, compartment), len(occupied) - 1)
    held = np.where(occupied[at] == compartment, np.diff(field.first)[at], 0)
    crossing = np.repeat(np.arange(len(at)), held)
    nth = np.arange(len(crossing)) - np.repeat(np.cumsum(held) - held, held)
    return crossing, field.first[at[crossing]] + nth
