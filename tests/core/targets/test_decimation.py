"""Fewer triangles, and what is promised of them: the bound, the holes, and no cracks."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.core.targets.stacks import asymmetric, height_at, places_in, rays

from stepfield.targets.decimation import triangles


def rough(seed: int, shape: tuple[int, int], holes: float) -> NDArray[np.float32]:
    """Make a raster of slopes, a step, noise, and scattered holes."""
    random = np.random.default_rng(seed)
    row, column = np.indices(shape)
    heights = 0.02 * column - 0.01 * row + (column > shape[1] // 3) * 0.7 + random.normal(0, 0.01, shape)
    heights[random.random(shape) < holes] = np.nan
    heights[shape[0] // 4 : shape[0] // 2, shape[1] // 2 : -3] = np.nan
    raster: NDArray[np.float32] = heights.astype(np.float32)
    return raster


RASTERS = [
    rough(1, (70, 131), 0.0),
    rough(2, (64, 64), 0.02),
    rough(3, (5, 200), 0.1),
    rough(4, (2, 2), 0),
    *(layer.astype(np.float32) for layer in asymmetric()),
]


def points(raster: NDArray[np.float32], corners: NDArray[np.int64]) -> NDArray[np.float64]:
    """Places of samples, a metre apart, the south-west corner of the raster in the origin."""
    row, column = np.divmod(corners, raster.shape[1])
    return np.stack([column + 0.5, len(raster) - 0.5 - row, raster.ravel()[corners]], -1).astype(np.float64)


@pytest.mark.parametrize("raster", RASTERS)
@pytest.mark.parametrize("tolerance", [0.0, 0.005, 0.03, 1.0])
def test_it_stays_within_the_tolerance_everywhere(raster: NDArray[np.float32], tolerance: float) -> None:
    """Not only at the samples: between them, too, and never where there is no surface."""
    made = triangles(raster, tolerance)
    places = places_in((0, 0), 1.0, raster.shape, 4000)
    expected = height_at(raster.astype(np.float64), (0, 0), 1.0, places)
    vertices = points(raster, np.arange(raster.size))
    found = rays(np.nan_to_num(vertices), made, places) if len(made) else np.full(len(places), np.nan)
    np.testing.assert_array_equal(np.isfinite(found), np.isfinite(expected))
    assert np.abs(found - expected)[np.isfinite(expected)].max(initial=0) <= tolerance + 1e-4


@pytest.mark.parametrize("raster", RASTERS)
def test_it_covers_the_quads_once_and_opens_no_crack(raster: NDArray[np.float32]) -> None:
    there = np.isfinite(raster)
    whole = there[:-1, :-1] & there[:-1, 1:] & there[1:, :-1] & there[1:, 1:]
    made = triangles(raster, 0.03)
    a, b, c = np.moveaxis(points(raster, made)[..., :2], 1, 0)
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    assert areas.min() > 0, "a triangle is seen from below"
    assert areas.sum() == whole.sum()
    # Edges of one triangle only are the rim: were there a crack, it would add to the rim's length.
    edges = Counter(tuple(sorted(edge)) for corner in made.tolist() for edge in zip(corner, np.roll(corner, 1), strict=True))  # fmt: skip  # noqa: E501
    alone = np.array([edge for edge, count in edges.items() if count == 1])
    assert set(edges.values()) <= {1, 2}
    ends = points(raster, alone)[..., :2]
    padded = np.pad(whole, 1).astype(int)
    rim = np.abs(np.diff(padded, axis=0)).sum() + np.abs(np.diff(padded, axis=1)).sum()
    assert np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).sum() == pytest.approx(rim)


def test_nothing_is_lost_at_tolerance_zero_and_planes_need_few() -> None:
    noisy = rough(5, (40, 40), 0.01)
    there = np.isfinite(noisy)
    whole = there[:-1, :-1] & there[:-1, 1:] & there[1:, :-1] & there[1:, 1:]
    assert len(triangles(noisy, 0.0)) == 2 * whole.sum()
    row, column = np.indices((257, 257))
    slope = (row * 0.5 - column * 0.25).astype(np.float32)
    assert len(triangles(slope, 1e-6)) == 2 * 4 * 4, "a plane is two triangles a square"


def test_where_nothing_is_nothing_comes() -> None:
    assert triangles(np.full((30, 30), np.nan, np.float32), 0.1).shape == (0, 3)
    assert triangles(np.ones((1, 30), np.float32), 0.1).shape == (0, 3)
