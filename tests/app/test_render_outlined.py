"""Outlines painted by the drawing process: over the very picture, without drawing it again."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray
from pytestqt.qtbot import QtBot

from stepfield_app.render.camera import Camera
from stepfield_app.render.client import RenderClient
from stepfield_app.render.outline import PLACE, SELECTION
from stepfield_app.render.scene import PILLARS, Frame, Scene, Triangles
from stepfield_app.theme import OUTLINES, rgb

SIZE = (320, 240)
CAMERA = Camera((0.0, 0.0, 0.0), 30, 60, 6)
RING = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
SEGMENTS = np.stack([RING, np.roll(RING, -1, axis=0)], axis=1)
MANY: NDArray[np.float32] = np.repeat(SEGMENTS, 20_000, axis=0)


def floor(height: float = 0.0) -> Scene:
    corners = np.array([[-2, -2, height], [2, -2, height], [2, 2, height], [-2, 2, height]], np.float32)
    colours = np.full((4, 3), (0, 114, 178), np.uint8)
    mesh = Triangles(corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32), colours)
    return Scene(meshes=(mesh,), low=corners.min(0), high=corners.max(0) + 1)


@pytest.fixture(scope="module")
def shared(qapp: object, request: pytest.FixtureRequest) -> Iterator[RenderClient]:
    """One running client for the whole module."""
    client = RenderClient()
    client.start()
    QtBot(request).waitUntil(lambda: client.state in ("running", "failed"))
    if client.state == "failed":
        client.close()
        pytest.skip(client.reason)
    client.set_outline(PILLARS, MANY)  # large enough to be written by a thread, which stays
    client.set_scene(PILLARS, floor())
    client.set_camera(PILLARS, CAMERA, SIZE, False)
    client.show([PILLARS])
    QtBot(request).waitUntil(client.is_at_rest)
    yield client
    client.close()


@pytest.fixture
def client(qtbot: QtBot, shared: RenderClient) -> RenderClient:
    """Give the client at rest over a floor without outlines."""
    for kind in (SELECTION, PLACE):
        shared.set_outline(PILLARS, None, kind=kind)
    shared.show([PILLARS])
    shared.set_scene(PILLARS, floor())
    shared.set_camera(PILLARS, CAMERA, SIZE, False)
    settle(qtbot, shared)
    return shared


def settle(qtbot: QtBot, client: RenderClient) -> Frame:
    qtbot.waitUntil(client.is_at_rest)
    frame = client.frame(PILLARS)
    assert frame is not None
    return frame


def count(frame: Frame, kind: str = SELECTION) -> int:
    return int((frame.pixels[..., 2::-1] == rgb(OUTLINES[kind])).all(axis=2).sum())


def test_an_outline_comes_and_goes_over_the_same_picture(qtbot: QtBot, client: RenderClient) -> None:
    before = settle(qtbot, client)
    client.set_outline(PILLARS, SEGMENTS)
    assert not client.is_at_rest()
    outlined = settle(qtbot, client)
    assert count(outlined) > 200
    assert outlined.depth is not None
    assert before.depth is not None
    assert np.array_equal(outlined.depth, before.depth), "the scene was drawn anew, or its depth lost"
    assert not outlined.moving
    client.set_outline(PILLARS, None)
    assert np.array_equal(settle(qtbot, client).pixels, before.pixels)


def test_outlines_follow_a_moving_camera(qtbot: QtBot, client: RenderClient) -> None:
    client.set_outline(PILLARS, SEGMENTS)
    settle(qtbot, client)
    with qtbot.waitSignal(client.frame_arrived):
        client.set_camera(PILLARS, CAMERA.orbited(60, 0), SIZE, True)
    frame = client.frame(PILLARS)
    assert frame is not None
    assert frame.moving
    assert count(frame) > 100, "the outline vanishes while the hand moves"
    assert frame.depth is None


def test_what_hides_is_what_is_drawn_now(qtbot: QtBot, client: RenderClient) -> None:
    client.set_outline(PILLARS, SEGMENTS)
    assert count(settle(qtbot, client)) > 200
    client.set_scene(PILLARS, floor(0.5))
    assert count(settle(qtbot, client)) == 0
    client.set_outline(PILLARS, SEGMENTS, slack=1.0)
    assert count(settle(qtbot, client)) > 200


def test_two_kinds_have_two_colours(qtbot: QtBot, client: RenderClient) -> None:
    client.set_outline(PILLARS, SEGMENTS)
    client.set_outline(PILLARS, SEGMENTS * np.float32(0.5), kind=PLACE)
    frame = settle(qtbot, client)
    assert count(frame, SELECTION) > 200
    assert count(frame, PLACE) > 100


def test_the_newest_of_many_outlines_wins_and_none_is_left_behind(qtbot: QtBot, client: RenderClient) -> None:
    def files() -> int:
        return sum(len(list(folder.iterdir())) for folder in client._store.folders)

    settle(qtbot, client)
    before = files()
    arrived: list[str] = []
    client.frame_arrived.connect(arrived.append)
    for step in range(40):
        client.set_outline(PILLARS, MANY * np.float32(1 - step / 80))
    client.set_outline(PILLARS, SEGMENTS)
    frame = settle(qtbot, client)
    client.frame_arrived.disconnect(arrived.append)
    few = settle(qtbot, client)
    assert count(frame) == count(few) > 200
    assert len(arrived) < 12, "outlines have queued up"
    client.set_outline(PILLARS, None)
    settle(qtbot, client)
    qtbot.waitUntil(lambda: files() <= before + 2)


def test_a_view_that_was_hidden_shows_the_outline_it_was_given(qtbot: QtBot, client: RenderClient) -> None:
    client.show([])
    client.set_outline(PILLARS, SEGMENTS)
    client.show([PILLARS])
    assert not client.is_at_rest()
    assert count(settle(qtbot, client)) > 200


def test_a_new_drawing_process_paints_the_outlines_too(qtbot: QtBot, client: RenderClient) -> None:
    client.set_outline(PILLARS, SEGMENTS)
    before = settle(qtbot, client).pixels.copy()
    os.kill(client.process_id, signal.SIGKILL)
    qtbot.waitUntil(lambda: not client.is_at_rest())
    assert np.array_equal(settle(qtbot, client).pixels, before)
