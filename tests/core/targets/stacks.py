"""Stacks made by hand, whose every height is known: what goes in must come out of each target."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from stepfield.heightmap import GrayScale
from stepfield.parameters import Parameters, Way
from stepfield.stack.entries import GridEntry, ImageEntry, LayerEntry, Source
from stepfield.stack.manifest import Manifest, image_name, mask_name

Raster = NDArray[np.float64]

CELL = 0.25
#: West and south edge: no half compartment of it is a whole number, so that every shift shows.
WEST, SOUTH = 3.1, -7.4

_LETTERS = {
    "F": ("####", "#...", "###.", "#...", "#..."),
    "R": ("###.", "#..#", "###.", "#.#.", "#..#"),
}


def stack_of(
    folder: Path,
    layers: Sequence[Raster],
    *,
    cell: float = CELL,
    west: float = WEST,
    south: float = SOUTH,
    base: float = -0.5,
    names: Sequence[str] = (),
    name: str = "made.ply",
    crs: str | None = None,
    unit: str = "m",
    unit_factor: float = 1.0,
    up: str = "z",
    bits: int = 16,
    reconstruction: Way = "simulator",
) -> Path:
    """Write a stack of layers: elevations in metres, shape (rows, columns), row 0 north, NaN a hole."""
    folder.mkdir(parents=True)
    rows, columns = layers[0].shape
    height = max(float(np.nanmax(layer)) if np.isfinite(layer).any() else 0.0 for layer in layers) - base
    scale = GrayScale(height, 16 if bits == 16 else 8)
    entries = []
    for index, elevations in enumerate(layers):
        entry = _entry(index, elevations, base, scale, names[index] if names else f"Layer {index + 1}")
        _draw(folder, entry, elevations - base, scale)
        entries.append(entry)
    source = {
        "files": [{"name": name, "sha256": "0" * 64, "points": 1}],
        "crs": crs,
        "unit": unit,
        "unit_factor": unit_factor,
        "up": up,
    }
    manifest = Manifest(
        generator="stepfield 0.0.0",
        source=Source.model_validate(source),
        parameters=Parameters(
            cell_size=cell, alpha=0.5, layer_tolerance=0.5, link_step=0.5, reconstruction=reconstruction
        ),
        grid=GridEntry(origin=(west, south), cell_size=cell, columns=columns, rows=rows),
        base_elevation=base,
        max_height=height,
        image=ImageEntry(width=columns + 3, height=rows + 5, bits=scale.bits, offset=(1, 2)),
        layers=tuple(entries),
        **dict.fromkeys(("unassigned", "moves", "moves_unresolved", "seams", "links", "rounds"), 0),
        converged=True,
        warnings=(),
    )
    (folder / "manifest.json").write_text(manifest.text(), encoding="utf-8")
    return folder


def _entry(index: int, elevations: Raster, base: float, scale: GrayScale, name: str) -> LayerEntry:
    heights = elevations[np.isfinite(elevations)] - base
    low, high, mean = (
        (float(heights.min()), float(heights.max()), float(heights.mean())) if heights.size else (None,) * 3
    )
    return LayerEntry(
        index=index, name=name, image=image_name(index), mask=mask_name(index), pillars=heights.size,
        height_min=low, height_max=high, height_mean=mean, scale=scale.step, offset=base + scale.zero,
    )  # fmt: skip


def _draw(folder: Path, entry: LayerEntry, heights: Raster, scale: GrayScale) -> None:
    mask = np.isfinite(heights)
    gray = np.where(mask, np.maximum(scale.encode(np.nan_to_num(heights)), 1), 0)
    for file, pixels in ((entry.image, gray), (entry.mask, mask * 255)):
        kind = np.uint16 if scale.bits == 16 and file == entry.image else np.uint8
        Image.fromarray(np.pad(pixels, ((2, 3), (1, 2))).astype(kind)).save(folder / file)


def asymmetric() -> list[Raster]:
    """Return two layers that no flip, transposition or shift by half a compartment leaves the same.

    The lower one is whole and rises east- and, more steeply, northwards, an R and an F standing on it in
    relief; the upper one is a ramp with an F cut out of it, an R let into it, and a corner missing.
    """
    rows, columns = 24, 37
    row, column = np.indices((rows, columns)).astype(np.float64)
    lower = 0.03 * column + 0.11 * (rows - 1 - row)
    _stamp(lower, "R", 3, 4, +0.8)
    _stamp(lower, "F", 11, 20, +0.4)
    upper = 4.0 + 0.05 * column - 0.02 * row
    _stamp(upper, "F", 4, 5, np.nan)
    _stamp(upper, "R", 12, 22, -0.3)
    upper[-5:, :9] = np.nan
    upper[:3, -2:] = np.nan
    return [lower, upper]


def _stamp(raster: Raster, letter: str, row: int, column: int, by: float) -> None:
    """Raise a letter, two compartments a stroke."""
    strokes = np.array([[mark == "#" for mark in line] for line in _LETTERS[letter]])
    strokes = strokes.repeat(2, axis=0).repeat(2, axis=1)
    raster[row : row + strokes.shape[0], column : column + strokes.shape[1]][strokes] += by


def large(side: int = 1024, layers: int = 4) -> list[Raster]:
    """Return layers as a large real scan has them: rough, stepped, with many holes in the upper ones."""
    random = np.random.default_rng(7)
    row, column = np.indices((side, side)).astype(np.float64)
    made = []
    for index in range(layers):
        rough = 3.0 * index + 0.3 * np.sin(column / 90 + index) * np.cos(row / 130)
        rough += random.normal(scale=0.01, size=rough.shape)
        if index:
            rough[np.sin(row / 37 + index) * np.sin(column / 53) > 0.4] = np.nan
            rough[random.random(rough.shape) < 0.01] = np.nan
        made.append(rough)
    return made


def height_at(elevations: Raster, corner: tuple[float, float], cell: float, places: Raster) -> Raster:
    """Return the height of the surface of section 6 at places (x, y), shape (n, 2), NaN where there is none.

    Parameters
    ----------
    elevations : ndarray of shape (rows, columns)
    corner : tuple of float
        West and south edge of the raster.
    cell : float
    places : ndarray of shape (n, 2)
    """
    east = (places[:, 0] - corner[0]) / cell - 0.5
    south = len(elevations) - 0.5 - (places[:, 1] - corner[1]) / cell
    row, column = (
        np.clip(np.floor(steps).astype(int), 0, side - 2)
        for steps, side in zip((south, east), elevations.shape, strict=True)
    )
    v, u = south - row, east - column
    nw, ne = elevations[row, column], elevations[row, column + 1]
    sw, se = elevations[row + 1, column], elevations[row + 1, column + 1]
    height = np.where(u > v, nw + u * (ne - nw) + v * (se - ne), nw + v * (sw - nw) + u * (se - sw))
    whole = np.isfinite(nw + ne + sw + se) & (np.minimum(u, v) >= 0) & (np.maximum(u, v) <= 1)
    return np.where(whole, height, np.nan)


def rays(vertices: Raster, triangles: NDArray[np.int64], places: Raster) -> Raster:
    """Look down on a mesh: the heights at places (x, y), NaN where there is nothing."""
    import open3d

    library: Any = open3d  # its stubs know no numpy
    core, t = library.core, library.t

    scene = t.geometry.RaycastingScene()
    scene.add_triangles(core.Tensor(vertices.astype(np.float32)), core.Tensor(triangles.astype(np.uint32)))
    top = float(vertices[:, 2].max()) + 1
    down = np.column_stack([places, np.full(len(places), top), np.tile([0, 0, -1], (len(places), 1))])
    hit: Raster = scene.cast_rays(core.Tensor(down.astype(np.float32)))["t_hit"].numpy().astype(np.float64)
    return np.where(np.isfinite(hit), top - hit, np.nan)


def places_in(corner: tuple[float, float], cell: float, shape: tuple[int, ...], count: int = 500) -> Raster:
    """Draw places over a raster, and a little beyond it on every side."""
    random = np.random.default_rng(11)
    size = np.array([shape[1], shape[0]]) * cell
    return np.array(corner) - cell + random.random((count, 2)) * (size + 2 * cell)
