"""Choosing what to draw: samples, the nearest points, sizes, pace, light."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from stepfield_app.render import detail, eyedome
from stepfield_app.render.camera import Camera
from stepfield_app.render.detail import Overtaken, is_speckled, nearest, point_size, shuffled
from stepfield_app.render.pace import FIRST, STEPS, Pace

SIZE = (160, 120)
NEAR = 0.5


def cloud(count: int, seed: int = 0) -> NDArray[np.float32]:
    return np.random.default_rng(seed).uniform(-2, 2, (count, 3)).astype(np.float32)


def quiet() -> None:
    """Say that nothing newer is there."""


@pytest.mark.parametrize("parallel", [False, True])
def test_nearest_agrees_with_looking_at_every_point(parallel: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(detail, "CHUNK", 700)
    places, camera = cloud(5000), Camera((0.0, 0.0, 0.0), 40, 30, 6, parallel)
    rows, front = nearest(places, camera, SIZE, NEAR, quiet)
    pixels, depth = camera.project(places, SIZE)
    inside = ((pixels >= 0) & (pixels < SIZE)).all(axis=1) & (depth >= NEAR)
    expected: dict[tuple[int, int], int] = {}
    for row in np.flatnonzero(inside)[np.argsort(-depth[inside])]:
        x, y = np.floor(pixels[row]).astype(int)
        expected[y, x] = row
    places_of = {tuple(np.floor(pixels[row]).astype(int)[::-1]): row for row in rows}
    # a point on the border of two pixels may fall into either one in single precision
    assert len(set(places_of.items()) ^ set(expected.items())) <= 4
    assert np.isfinite(front).sum() == len(rows)
    assert np.allclose(np.sort(front[np.isfinite(front)]), np.sort(depth[rows]), atol=1e-4)


def test_a_newer_request_stops_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(detail, "CHUNK", 100)
    looks = iter(range(5))

    def look_up() -> None:
        if next(looks, None) is None:
            raise Overtaken

    with pytest.raises(Overtaken):
        nearest(cloud(5000), Camera((0.0, 0.0, 0.0), 0, 30, 6), SIZE, NEAR, look_up)


def test_nothing_in_the_picture_is_no_point() -> None:
    rows, front = nearest(cloud(100), Camera((0.0, 900.0, 0.0), 0, 0, 6), SIZE, NEAR, quiet)
    assert len(rows) == 0
    assert not np.isfinite(front).any()


@pytest.mark.parametrize(("count", "most"), [(10, 100), (1000, 100), (1001, 1000)])
def test_any_first_few_of_the_shuffled_rows_are_a_sample(count: int, most: int) -> None:
    rows = shuffled(count, most)
    assert len(rows) == min(count, most) == len(np.unique(rows)), "a point is drawn twice"
    assert 0 <= rows.min() <= rows.max() < count
    few = rows[: len(rows) // 2]
    assert abs(few.mean() / count - 0.5) < 0.3, "the first few come from one end"


def test_sparse_points_are_drawn_larger() -> None:
    camera = Camera((0.0, 0.0, 0.0), 0, 90, 6)
    sizes = [point_size(cloud(2000), count, camera, SIZE, NEAR, 1.0) for count in (500, 10_000, 10_000_000)]
    assert sizes == sorted(sizes, reverse=True)
    assert (sizes[0], sizes[-1]) == (3.0, 1.0)
    assert point_size(cloud(2000), 10_000_000, camera, SIZE, NEAR, 5.0) == 5.0, "the scene asked for more"


def test_holes_in_a_surface_are_noticed() -> None:
    whole = np.full((100, 100), 10, np.float32)
    assert not is_speckled(whole)
    holes = whole.copy()
    holes[::9, ::9] = np.inf
    assert is_speckled(holes)


def test_pace_slows_down_and_recovers() -> None:
    slow = Pace().after(0.2, limited=True)
    assert slow.points < Pace().points
    assert Pace().after(0.01, limited=True).points > Pace().points
    assert Pace().after(0.01, limited=False) == Pace(), "there is nothing more to draw"
    for _ in range(20):
        slow = slow.after(1.0, limited=True)
    assert slow.step == 0
    assert STEPS[FIRST][1] == 1, "a picture begins sharp"


@pytest.mark.parametrize("parallel", [False, True])
def test_only_what_lies_behind_is_darkened(parallel: bool) -> None:
    depth = np.full((40, 60), 10, np.float32)
    depth[:, 30:] = 8
    depth[30:] = 0
    light = eyedome.shade(eyedome.relief_of(depth, 0.002, parallel, 0.02))
    assert light.min() >= eyedome.DARKEST
    assert light[10, 29] < 0.8 < light[10, 5], "the far side of a step must be darker"
    assert light[10, 30] == 1, "the near side must not"
    assert (light[29, :28] == 1).all(), "a border to the background must not"
    assert (light[30:] == 1).all(), "the background must not"
