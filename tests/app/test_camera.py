"""The turntable camera: what an operator's hand expects of it, for any camera."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from stepfield_app.render.camera import LEAST_DISTANCE, LEAST_PARALLEL, MARGIN, NEAREST, Camera

SIZE = (640, 400)


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False)


POINTS = st.tuples(*[numbers(-50, 50)] * 3)
CAMERAS = st.builds(Camera, POINTS, numbers(-400, 400), numbers(-90, 90), numbers(0.1, 500), st.booleans())
SIZES = st.tuples(st.integers(20, 3000), st.integers(20, 3000))


@pytest.mark.parametrize(
    ("azimuth", "elevation", "forward", "right", "up"),
    [
        (0, 0, (0, 1, 0), (1, 0, 0), (0, 0, 1)),
        (90, 0, (1, 0, 0), (0, -1, 0), (0, 0, 1)),
        (0, 90, (0, 0, -1), (1, 0, 0), (0, 1, 0)),
    ],
)
def test_azimuth_and_elevation_are_a_compass_and_a_height(
    azimuth: float,
    elevation: float,
    forward: tuple[float, ...],
    right: tuple[float, ...],
    up: tuple[float, ...],
) -> None:
    camera = Camera((0.0, 0.0, 0.0), azimuth, elevation, 10)
    assert np.allclose([camera.forward, camera.right, camera.up], [forward, right, up])
    assert np.allclose(camera.eye, -10 * np.asarray(forward))


@given(CAMERAS, SIZES, numbers(0, 1), numbers(0, 1), numbers(0.01, 1000))
def test_unproject_is_the_inverse_of_project(
    camera: Camera, size: tuple[int, int], across: float, down: float, depth: float
) -> None:
    x, y = across * size[0], down * size[1]
    point = camera.unproject(x, y, depth, size)
    pixels, depths = camera.project(point, size)
    assert np.allclose(pixels, [[x, y]], atol=1e-4 * max(size))
    assert np.allclose(depths, depth, atol=1e-6 * (1 + camera.distance + depth))


@given(CAMERAS, SIZES)
def test_the_centre_is_in_the_middle(camera: Camera, size: tuple[int, int]) -> None:
    pixels, depth = camera.project(camera.centre, size)
    assert np.allclose(pixels, np.array([size]) / 2, atol=1e-6 * max(size))
    assert np.allclose(depth, camera.distance)


@given(CAMERAS, numbers(0.2, 5), numbers(0, 1), numbers(0, 1), numbers(0.2, 4))
def test_zooming_keeps_the_point_under_the_cursor(
    camera: Camera, factor: float, across: float, down: float, share: float
) -> None:
    x, y = across * SIZE[0], down * SIZE[1]
    point = camera.unproject(x, y, share * camera.distance, SIZE)
    pixels, _ = camera.zoomed(factor, point).project(point, SIZE)
    assert np.allclose(pixels, [[x, y]], atol=1e-3)


@given(CAMERAS, numbers(0.2, 5))
def test_zooming_in_makes_pixels_smaller(camera: Camera, factor: float) -> None:
    assert camera.zoomed(factor).metres_per_pixel(SIZE) == pytest.approx(
        camera.metres_per_pixel(SIZE) / factor
    )


def test_zooming_ends_before_the_numbers_do() -> None:
    camera = Camera((1.0, 2.0, 3.0), 0, 0, 1)
    assert camera.zoomed(1e30, (9.0, 9.0, 9.0)).distance == NEAREST


@given(CAMERAS, numbers(-300, 300), numbers(-300, 300))
def test_the_scene_follows_a_panning_hand(camera: Camera, dx: float, dy: float) -> None:
    pixels, _ = camera.panned(dx, dy, SIZE).project(camera.centre, SIZE)
    assert np.allclose(pixels, [[SIZE[0] / 2 + dx, SIZE[1] / 2 + dy]], atol=1e-4)


def test_the_near_side_follows_an_orbiting_hand() -> None:
    camera = Camera((0.0, 0.0, 0.0), 0, 20, 10)
    near = (0.0, -1.0, 0.0)
    before, after = (view.project(near, SIZE)[0][0] for view in (camera, camera.orbited(10, 10)))
    assert (after > before).all(), "a drag right and down must move the near side right and down"


@given(CAMERAS, numbers(-2000, 2000), numbers(-2000, 2000))
def test_orbiting_never_goes_over_the_top(camera: Camera, dx: float, dy: float) -> None:
    turned = camera.orbited(dx, dy)
    assert -90 <= turned.elevation <= 90
    assert turned.right[2] == 0, "the horizon must stay level"
    assert turned.centre == camera.centre


@given(
    POINTS,
    st.tuples(*[numbers(0, 30)] * 3),
    SIZES,
    numbers(0, 360),
    numbers(-90, 90),
    st.booleans(),
)
@example((0, 0, 0), (0, 1, 0), (350, 20), 18, 0, False)  # so wide that only the eye's distance counts
def test_fitting_frames_the_bounds_with_a_margin(
    low: tuple[float, float, float],
    extent: tuple[float, float, float],
    size: tuple[int, int],
    azimuth: float,
    elevation: float,
    parallel: bool,
) -> None:
    high = np.add(low, extent)
    camera = Camera.fitting(low, high, size, azimuth, elevation, parallel)
    corners = np.array(list(product(*zip(low, high, strict=True))))
    pixels, _ = camera.project(corners, size)
    free = np.minimum(pixels, np.asarray(size) - pixels).min(axis=0) / size
    assert (free > MARGIN - 1e-3).all(), "a corner is cut off"
    seen = corners - np.mean(corners, axis=0)
    across = np.abs(seen @ np.array([camera.right, camera.up]).T).max()
    nearest = np.abs(seen @ camera.forward).max() * (LEAST_PARALLEL if parallel else LEAST_DISTANCE)
    if across > 0.05 and camera.distance > nearest * (1 + 1e-9):  # or the eye is about to enter the box
        assert free.min() < MARGIN + 1e-3, "the bounds could be shown larger"


def test_points_behind_the_eye_have_no_pixel() -> None:
    pixels, depth = Camera((0.0, 0.0, 0.0), 0, 0, 1).project([[0, -5, 0]], SIZE)
    assert np.isnan(pixels).all()
    assert depth[0] == -4
