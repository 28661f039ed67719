"""Lengths, the ground grid, and the crop box in the hand."""

from __future__ import annotations

import numpy as np
import pytest

from stepfield_app.render.camera import Camera
from stepfield_app.scenes import crop
from stepfield_app.scenes.ground import ground
from stepfield_app.scenes.units import format_length, nice_step, scale_bar
from stepfield_app.theme import DARK, LIGHT, Theme, rgb

BOX: crop.Box = (0.0, 0.0, 0.0, 4.0, 2.0, 1.0)
SIZE = (800, 600)


@pytest.mark.parametrize(
    ("metres", "text"),
    [
        (0.0032, "3.2 mm"),
        (0.45, "45 cm"),
        (0.2, "20 cm"),
        (12.431, "12.4 m"),
        (0.9999, "1 m"),
        (999.9, "1 km"),
        (1350, "1.35 km"),
        (100_000, "100 km"),
        (0, "0 m"),
        (-2.5, "-2.5 m"),
        (0.0001, "0.1 mm"),
        (float("nan"), "–"),
    ],
)
def test_lengths_have_the_unit_that_suits_them(metres: float, text: str) -> None:
    assert format_length(metres) == text


@pytest.mark.parametrize("scale", np.geomspace(1e-6, 1e4, 57).tolist())
def test_scale_bars_are_round_and_neither_short_nor_long(scale: float) -> None:
    metres, pixels, label = scale_bar(scale)
    assert 60 <= pixels <= 160.001
    assert metres == pytest.approx(pixels * scale)
    assert f"{metres:.9e}"[0] in "125"
    assert label.split()[0].rstrip("0").rstrip(".").lstrip("0.") in {"1", "2", "5"}


@pytest.mark.parametrize("span", np.geomspace(1e-3, 1e6, 43).tolist())
def test_a_grid_has_eight_to_twenty_steps(span: float) -> None:
    assert 8 - 1e-6 <= span / nice_step(span) <= 20 + 1e-6


def test_steps_of_nothing_are_still_steps() -> None:
    assert nice_step(0) == nice_step(float("nan")) == 1


@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_the_ground_lies_under_the_box_at_round_scan_coordinates(theme: Theme) -> None:
    made = ground([0, 0, -0.5], [8, 6, 3], theme, (432_100.3, 50.0, 0.0))
    assert (made.ends[:, :, 2] == -0.5).all()
    assert (made.ends[:, :, :2].min(axis=(0, 1)) <= 0).all()
    assert (made.ends[:, :, :2].max(axis=(0, 1)) >= [8, 6]).all()
    meridians = made.ends[made.ends[:, 0, 0] == made.ends[:, 1, 0]][:, 0, 0] + 432_100.3
    assert np.allclose(meridians / 0.5, np.rint(meridians / 0.5), atol=1e-4)
    assert (made.colours == rgb(theme.line)).all(axis=1).any()


def test_handles_sit_on_faces_and_corners() -> None:
    places = {tuple(handle.point(BOX).tolist()) for handle in crop.FACES}
    assert places == {(0, 1, 0.5), (4, 1, 0.5), (2, 0, 0.5), (2, 2, 0.5), (2, 1, 0), (2, 1, 1)}
    assert {tuple(handle.point(BOX).tolist()) for handle in crop.CORNERS} == {
        (x, y, z) for x in (0, 4) for y in (0, 2) for z in (0, 1)
    }
    assert len(crop.EDGES) == 12


def test_a_face_moves_along_its_axis_only() -> None:
    east = next(handle for handle in crop.FACES if handle.side == (1, 0, 0))
    assert crop.dragged(BOX, east, (4, 1, 0.5), (6, 7, 8)) == (0, 0, 0, 6, 2, 1)


@pytest.mark.parametrize("handle", crop.HANDLES)
def test_a_box_keeps_an_inside_however_it_is_dragged(handle: crop.Handle) -> None:
    inward = -100.0 * np.array(handle.side)
    made = crop.dragged(BOX, handle, (0, 0, 0), inward)
    assert all(low < high for low, high in zip(made[:3], made[3:], strict=True))


def test_a_slab_changes_the_elevations_only_and_takes_either_order() -> None:
    assert crop.slab(BOX, 0.7, 0.2) == (0, 0, 0.2, 4, 2, 0.7)
    made = crop.slab(BOX, 0.3, 0.3)
    assert made[2] < made[5]


def test_a_moved_box_keeps_its_size_and_a_box_stays_within_bounds() -> None:
    assert crop.moved(BOX, (1, 2, 3)) == (1, 2, 3, 5, 4, 4)
    assert crop.within((-1, 1, -1, 9, 1.5, 9), BOX) == (0, 1, 0, 4, 1.5, 1)
    beyond = crop.within((10, 10, 10, 11, 11, 11), BOX)
    assert all(low < high for low, high in zip(beyond[:3], beyond[3:], strict=True))
    assert beyond[3:] == (4, 2, 1)


@pytest.mark.parametrize("parallel", [True, False])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_face_follows_the_hand(parallel: bool, axis: int) -> None:
    camera = Camera.fitting((0, 0, 0), (4, 2, 1), SIZE, 30, 35, parallel)
    point = np.array([2.0, 1.0, 1.0])
    step = np.eye(3)[axis] * 0.01
    pixels, _ = camera.project(np.vstack([point, point + step]), SIZE)
    dx, dy = (pixels[1] - pixels[0]).tolist()
    assert crop.along_axis(camera, SIZE, point, axis, dx, dy) == pytest.approx(0.01, rel=0.02)


def test_an_axis_seen_end_on_does_not_leap() -> None:
    above = Camera.fitting((0, 0, 0), (4, 2, 1), SIZE)
    assert crop.along_axis(above, SIZE, (2, 1, 1), 2, 30, 40) == 0


def test_a_corner_follows_the_hand_level_in_the_plan() -> None:
    above = Camera.fitting((0, 0, 0), (4, 2, 1), SIZE, 0, 90, parallel=True)
    corner = next(handle for handle in crop.CORNERS if handle.side == (1, 1, 1))
    metre = 1 / above.metres_per_pixel(SIZE)
    made = crop.dragged_on_screen(BOX, corner, above, SIZE, metre, -metre / 2)
    assert made == pytest.approx((0, 0, 0, 5, 2.5, 1))
