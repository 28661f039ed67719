"""Outlines as pixels: where lines fall, what hides them, and that they show on every colour."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from stepfield_app.render.camera import Camera
from stepfield_app.render.outline import KINDS, SELECTION, Outline, paint
from stepfield_app.render.strokes import BORDER, strokes
from stepfield_app.theme import OUTLINES, rgb

SIZE = (160, 120)
CAMERA = Camera((0.0, 0.0, 0.0), 0, 0, 4)
LIGHT = rgb(OUTLINES[SELECTION])
LEVEL = np.array([[[-1, 0, 0.2], [1, 0, 0.2]]], np.float32)


def picture(colour: tuple[int, int, int] = (0, 114, 178)) -> NDArray[np.uint8]:
    pixels = np.empty((SIZE[1], SIZE[0], 4), np.uint8)
    pixels[:] = (*reversed(colour), 255)
    return pixels


def wall(metres: float) -> NDArray[np.float32]:
    return np.full((SIZE[1], SIZE[0]), metres, np.float32)


def is_light(pixels: NDArray[np.uint8]) -> NDArray[np.bool_]:
    light: NDArray[np.bool_] = (pixels[..., 2::-1] == LIGHT).all(axis=2)
    return light


@pytest.mark.parametrize("parallel", [False, True])
def test_samples_lie_on_the_projected_line_at_its_depth(parallel: bool) -> None:
    camera = Camera((0.1, 0.2, 0.3), 35, 25, 3, parallel)
    segment = np.array([[[-0.5, -0.4, 0.1], [0.6, 0.5, 0.4]]], np.float32)
    lines = strokes(segment, camera, SIZE)
    row, column = np.divmod(lines.pixel, SIZE[0])
    shares = np.linspace(0, 1, 20_000)[:, np.newaxis]
    pixels, depth = camera.project(segment[0, 0] + shares * (segment[0, 1] - segment[0, 0]), SIZE)
    gap = np.hypot(pixels[:, 0] - column[:, np.newaxis] - 0.5, pixels[:, 1] - row[:, np.newaxis] - 0.5)
    assert gap.min(axis=1).max() < 0.75, "a sample is off the line"
    assert np.abs(depth[gap.argmin(axis=1)] - lines.depth).max() < 0.02
    step = np.maximum(np.abs(np.diff(row)), np.abs(np.diff(column)))
    assert step.max() == 1, "the line has holes"


@pytest.mark.parametrize("parallel", [False, True])
def test_lines_are_cut_at_the_frame_and_at_the_eye(parallel: bool) -> None:
    rng = np.random.default_rng(3)
    camera = Camera((0.0, 0.0, 0.0), 20, 10, 1, parallel)
    segments = rng.uniform(-50, 50, (3000, 2, 3)).astype(np.float32)
    segments[:5] = camera.eye
    lines = strokes(segments, camera, SIZE)
    assert len(lines.pixel) < 3000 * sum(SIZE), "what is beyond the frame is sampled"
    row, column = np.divmod(lines.pixel, SIZE[0])
    assert row.min() >= BORDER
    assert row.max() < SIZE[1] - BORDER
    assert column.min() >= BORDER
    assert column.max() < SIZE[0] - BORDER
    assert np.isfinite(lines.depth).all()
    if not parallel:
        assert lines.depth.min() > 0


def test_a_line_through_the_whole_picture_stays_whole_when_cut() -> None:
    far = np.array([[[-500, 0, 0], [500, 0, 0]]], np.float32)
    column = strokes(far, CAMERA, SIZE).pixel % SIZE[0]
    assert np.array_equal(np.unique(column), np.arange(BORDER, SIZE[0] - BORDER))


def test_a_seen_line_is_light_within_dark_on_every_colour() -> None:
    for colour in [(255, 255, 255), (0, 0, 0), (240, 228, 66)]:
        pixels = picture(colour)
        paint(pixels, wall(5), CAMERA, Outline(LEVEL), SELECTION)
        column = pixels[:, SIZE[0] // 2, 2::-1].astype(int)
        row = int(CAMERA.project(LEVEL[0, 0], SIZE)[0][0, 1])
        assert tuple(column[row]) == LIGHT
        for beside in (row - 1, row + 1):
            assert np.abs(column[row] - column[beside]).sum() > 250, f"it does not show on {colour}"
        assert (pixels[..., 3] == 255).all()


def test_a_hidden_line_is_dotted_faintly() -> None:
    pixels = picture()
    paint(pixels, wall(3), CAMERA, Outline(LEVEL), SELECTION)
    changed = (pixels != picture()).any(axis=2)
    assert not is_light(pixels).any(), "a line behind a wall is drawn as if before it"
    assert 10 < changed.sum() < 60, "a hidden line should be some dots"


def test_slack_lets_lines_show_a_little_behind_the_surface() -> None:
    pixels = picture()
    paint(pixels, wall(3.9), CAMERA, Outline(LEVEL, slack=0.2), SELECTION)
    assert is_light(pixels).sum() > 50


def test_an_edge_beside_its_own_block_is_seen() -> None:
    depth = wall(3)
    depth[: SIZE[1] // 2] = 0
    pixels = picture()
    edge = np.array([[[-1, 0, -0.01], [1, 0, -0.01]]], np.float32)  # in the first row of the block
    paint(pixels, depth, CAMERA, Outline(edge), SELECTION)
    assert is_light(pixels).sum() > 50, "the silhouette of a block vanishes in its own wall"


def test_a_crowd_of_lines_lets_the_picture_through() -> None:
    across = np.linspace(-1, 1, 400, dtype=np.float32)
    crowd = np.zeros((400, 2, 3), np.float32)
    crowd[:, :, 0], crowd[:, 0, 2], crowd[:, 1, 2] = across[:, np.newaxis], -1, 1
    pixels = picture((0, 0, 200))
    paint(pixels, None, CAMERA, Outline(crowd), SELECTION)
    middle = pixels[40:80, 60:100, :3].astype(int)
    assert (middle[..., 0] - middle[..., 2] > 60).mean() > 0.9, "the colour of what is selected is gone"


@pytest.mark.parametrize("kind", KINDS)
def test_lines_around_the_whole_frame_are_painted_within_it(kind: str) -> None:
    rng = np.random.default_rng(8)
    pixels = picture()
    paint(pixels, None, CAMERA, Outline(rng.uniform(-9, 9, (500, 2, 3)).astype(np.float32)), kind)
    assert (pixels[..., 3] == 255).all()
    paint(np.zeros((3, 2, 4), np.uint8), None, CAMERA, Outline(LEVEL), kind)  # a view may be tiny


def test_no_segment_changes_nothing() -> None:
    behind = np.array([[[0, -9, 0], [1, -9, 0]]], np.float32)
    for segments in (np.zeros((0, 2, 3), np.float32), behind):
        pixels = picture()
        paint(pixels, wall(3), CAMERA, Outline(segments), SELECTION)
        assert np.array_equal(pixels, picture())
