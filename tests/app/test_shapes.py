"""Shapes drawn by hand: what lies in them and what they touch, against arithmetic one point at a time."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from stepfield_app.scenes.brushing import DOTS
from stepfield_app.scenes.shapes import Shape

Floats = NDArray[np.float64]
coordinates = st.integers(-40, 40).map(lambda tenths: tenths / 10)
paths = st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=12)


def cloud(count: int = 500, seed: int = 0) -> Floats:
    points: Floats = np.random.default_rng(seed).uniform(-4.5, 4.5, (count, 2))
    return points


def winding(path: Floats, point: Floats) -> float:
    """Turns of a closed path around a point: the sum of the angles its edges are seen under."""
    seen = np.vstack([path, path[:1]]) - point
    x, y = seen.T
    crossed = x[:-1] * y[1:] - y[:-1] * x[1:]
    return float(np.arctan2(crossed, (seen[:-1] * seen[1:]).sum(axis=1)).sum() / math.tau)


def distance(path: Floats, point: Floats, half: float) -> float:
    """Distance of a square from a path, by very many places of the path."""
    share = np.linspace(0, 1, 400)[:, np.newaxis]
    pieces = [a + share * (b - a) for a, b in pairwise(path)] or [path]
    beyond = np.maximum(np.abs(np.vstack(pieces) - point) - half, 0)
    return float(np.hypot(*beyond.T).min())


@settings(max_examples=60, deadline=None)
@given(paths, st.integers(0, 99))
def test_a_lasso_takes_what_it_winds_round(path: list[tuple[float, float]], seed: int) -> None:
    lasso, points = Shape("lasso", np.array(path)), cloud(200, seed)
    expected = [abs(winding(lasso.path, point)) > 0.5 for point in points]
    assert lasso.covers(points).tolist() == expected


def test_a_lasso_drawn_round_twice_has_no_hole() -> None:
    angle = np.linspace(0, 2 * math.tau, 300)
    twice = Shape("lasso", np.column_stack([np.cos(angle), np.sin(angle)]) * np.linspace(2, 3, 300)[:, None])
    within = twice.covers(np.array([[0.0, 0.0], [1.5, 0.0], [2.9, -0.01], [3.2, 0.0]]))
    assert within.tolist() == [True, True, True, False]


@settings(max_examples=60, deadline=None)
@given(paths, st.sampled_from([0.0, 0.05, 0.4, 2.0]), st.sampled_from([0.0, 0.1, 0.7]))
def test_a_brush_takes_the_squares_it_touches(
    path: list[tuple[float, float]], radius: float, half: float
) -> None:
    """It is made of dots, so a corner may be missed that it grazes by less than half their distance."""
    brush, points = Shape("brush", np.array(path), radius), cloud(60)
    assume(radius or half)
    missed = max(radius, half) / DOTS / 2
    touched = brush.touches(points, half)
    for point, taken in zip(points, touched, strict=True):
        gap = distance(brush.path, point, half) - radius
        assert taken or gap > -missed - 1e-6, "a square within the stroke is left out"
        assert not taken or gap <= 1e-6 + 0.01, "a square beside the stroke is taken"


def test_a_thin_brush_takes_every_square_it_passes() -> None:
    middles = np.array([[x + 0.5, y + 0.5] for y in range(20) for x in range(20)])
    brush = Shape("brush", np.array([[0.2, 0.1], [19.8, 19.3]]), 0.001)
    touched = brush.touches(middles, 0.5).reshape(20, 20)
    crossed = [
        [distance(brush.path, middle, 0.5) <= 0 for middle in row] for row in middles.reshape(20, 20, 2)
    ]
    missed = np.array(crossed) & ~touched
    assert missed.sum() <= 1
    assert touched.sum() >= 38


@pytest.mark.parametrize("kind", ["rectangle", "lasso", "brush"])
def test_what_is_quick_for_many_points_says_the_same_of_few(kind: Any) -> None:
    """The answer about a pillar must not depend on how many others there are."""
    path = np.array([[-3, -3], [2.5, -2], [3, 3], [0, 0.5], [-2, 3.5]])
    shape, many = Shape(kind, path, 0.3), cloud(300_000)
    covered = shape.covers(many)
    assert 0 < covered.sum() < len(many)
    few = slice(None, None, 1000)
    assert np.array_equal(covered[few], shape.covers(many[few]))


def test_a_rectangle_takes_what_lies_on_its_edge() -> None:
    """Keys draw it from the middle of a cell to the middle of another."""
    rectangle = Shape("rectangle", np.array([[2.0, 1.0], [0.0, 3.0]]))
    points = np.array([[0.0, 1.0], [2.0, 3.0], [1.0, 2.0], [2.1, 2.0], [1.0, 0.9]])
    assert rectangle.covers(points).tolist() == [True, True, True, False, False]
    assert Shape("rectangle", points[:1]).covers(points).sum() == 1


@pytest.mark.parametrize("kind", ["rectangle", "lasso", "brush", "click"])
def test_nothing_comes_of_no_path_no_points_and_points_at_no_place(kind: Any) -> None:
    nowhere = np.full((3, 2), np.nan)
    path = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    assert not Shape(kind, np.zeros((0, 2)), 1.0).covers(cloud(10)).any()
    assert not Shape(kind, path, 1.0).covers(nowhere).any()
    assert len(Shape(kind, path, 1.0).covers(np.zeros((0, 2)))) == 0
    assert len(Shape(kind, path, 1.0).touches(np.zeros((0, 2)), 0.5)) == 0


def test_a_path_is_made_of_whatever_lists_two_numbers_a_place() -> None:
    assert Shape("click", [(1, 2)]).path.dtype == np.float64  # type: ignore[arg-type]
    assert Shape("lasso", []).path.shape == (0, 2)  # type: ignore[arg-type]
