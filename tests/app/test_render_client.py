"""The drawing process, started for real: what it draws, how it dies, and that it leaves nothing."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from numpy.typing import NDArray
from pytestqt.qtbot import QtBot

from stepfield_app.render.camera import Camera
from stepfield_app.render.client import RenderClient
from stepfield_app.render.scene import CLOUD, EMPTY, PILLARS, RECONSTRUCTION, Frame, Points, Scene, Triangles
from stepfield_app.render.store import PREFIX, Store

BACKGROUND = (0x1E, 0x1F, 0x22)
MANY = 400_000
SIZE = (200, 150)
CAMERA = Camera((0.0, 0.0, 0.0), 30, 60, 6)


@pytest.fixture(scope="module")
def shared(qapp: object, request: pytest.FixtureRequest) -> Iterator[RenderClient]:
    """One running client for all that do not end it."""
    client = RenderClient()
    client.set_background(BACKGROUND)
    client.start()
    bot = QtBot(request)
    bot.waitUntil(lambda: client.state in ("running", "failed"))
    if client.state == "failed":
        client.close()
        pytest.skip(client.reason)
    client.show([CLOUD])
    client.set_scene(CLOUD, plane(MANY))  # large enough to be written by a thread, which stays
    client.set_camera(CLOUD, CAMERA, SIZE, False)
    bot.waitUntil(client.is_at_rest)
    yield client
    client.close()


@pytest.fixture
def client(shared: RenderClient) -> RenderClient:
    """Give the shared client, showing nothing."""
    shared.show([])
    for view in (CLOUD, PILLARS, RECONSTRUCTION):
        shared.set_scene(view, EMPTY)
    return shared


@pytest.fixture
def own(qtbot: QtBot, shared: RenderClient) -> Iterator[RenderClient]:
    """Give a client that a test may ruin."""
    client = RenderClient()
    yield client
    client.close()


def plane(count: int) -> Scene:
    places = np.random.default_rng(1).uniform(-2, 2, (count, 3)).astype(np.float32)
    places[:, 2] = 0
    codes = np.full(count, 7, np.uint8)
    palette = np.full((256, 3), (0, 158, 115), np.uint8)
    return Scene(Points(places, codes, palette), low=places.min(0), high=places.max(0))


def red_point(place: tuple[float, float, float]) -> Scene:
    places = np.array([place], np.float32)
    return Scene(Points(places, np.array([[255, 0, 0]], np.uint8)), low=places[0] - 1, high=places[0] + 1)


def drawn(
    qtbot: QtBot, client: RenderClient, scene: Scene, camera: Camera, size: tuple[int, int] = SIZE
) -> Frame:
    """Show a scene and wait for its full picture."""
    client.show([CLOUD])
    client.set_scene(CLOUD, scene)
    client.set_camera(CLOUD, camera, size, False)
    qtbot.waitUntil(client.is_at_rest)
    frame = client.frame(CLOUD)
    assert frame is not None
    assert frame.pixels.shape == (size[1], size[0], 4)
    return frame


def rgb(frame: Frame) -> NDArray[np.uint8]:
    return frame.pixels[..., 2::-1]


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("size", [(64, 48), (201, 133), (137, 300), (640, 100)])
def test_a_point_is_drawn_where_the_camera_says(
    qtbot: QtBot, client: RenderClient, size: tuple[int, int], parallel: bool
) -> None:
    place = (0.4, -0.3, 0.5)
    camera = Camera((0.1, 0.2, 0.1), 33, 24, 4, parallel)
    frame = drawn(qtbot, client, red_point(place), camera, size)
    rows, columns = np.nonzero(rgb(frame)[..., 0] > 200)
    pixels, depth = camera.project(place, size)
    assert np.allclose([[columns.mean() + 0.5, rows.mean() + 0.5]], pixels, atol=1)
    assert frame.depth is not None
    seen = frame.depth[frame.depth != 0]
    assert np.allclose(seen, depth, rtol=1e-3), "depth is not in metres from the eye"
    assert np.allclose(
        camera.unproject(float(pixels[0, 0]), float(pixels[0, 1]), float(seen[0]), size), place, atol=0.01
    )


def test_a_parallel_view_shows_what_is_behind_its_eye(qtbot: QtBot, client: RenderClient) -> None:
    camera = Camera((0.0, 0.0, 0.0), 0, 0, 1, True)
    frame = drawn(qtbot, client, red_point((0.1, -5.0, 0.1)), camera)
    assert (rgb(frame)[..., 0] > 200).any()


def test_colours_are_the_palettes_and_the_background_the_themes(qtbot: QtBot, client: RenderClient) -> None:
    frame = drawn(qtbot, client, plane(3000), CAMERA)
    colours = {tuple(colour) for colour in np.unique(rgb(frame).reshape(-1, 3), axis=0).tolist()}
    assert BACKGROUND in colours
    assert (0, 158, 115) in colours
    assert np.all(frame.pixels[..., 3] == 255)


def test_a_resting_picture_has_a_point_for_every_pixel(qtbot: QtBot, client: RenderClient) -> None:
    frame = drawn(qtbot, client, plane(MANY), CAMERA)
    corners, _ = CAMERA.project([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], SIZE)
    x, y = corners.T
    area = abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
    assert not frame.moving
    assert frame.covered > 0.99 * area, "background shows through a dense cloud"
    assert frame.points == frame.covered, "hidden points were drawn, or points in each other's pixels"


def test_a_moving_picture_leaves_points_out_and_the_next_resting_one_does_not(
    qtbot: QtBot, client: RenderClient
) -> None:
    drawn(qtbot, client, plane(MANY), CAMERA)
    with qtbot.waitSignal(client.frame_arrived):
        client.set_camera(CLOUD, CAMERA.orbited(40, 0), SIZE, True)
    frame = client.frame(CLOUD)
    assert frame is not None
    assert frame.moving
    assert 0 < frame.points < MANY
    assert not client.is_at_rest()
    assert not drawn(qtbot, client, client._views[CLOUD].scene, CAMERA.orbited(40, 0)).moving


def test_the_newest_camera_wins(qtbot: QtBot, client: RenderClient) -> None:
    drawn(qtbot, client, plane(2000), CAMERA)
    arrived: list[str] = []
    client.frame_arrived.connect(arrived.append)
    for step in range(200):
        client.set_camera(CLOUD, CAMERA.orbited(step, 0), SIZE, True)
    client.set_camera(CLOUD, CAMERA.orbited(200, 0), SIZE, False)
    qtbot.waitUntil(client.is_at_rest)
    client.frame_arrived.disconnect(arrived.append)
    frame = client.frame(CLOUD)
    assert frame is not None
    assert frame.camera == CAMERA.orbited(200, 0)
    assert len(arrived) < 10, "requests have queued up"


def test_a_frame_someone_holds_does_not_change(qtbot: QtBot, client: RenderClient) -> None:
    held = drawn(qtbot, client, plane(2000), CAMERA)
    copy = held.pixels.copy()
    for step in range(8):
        drawn(qtbot, client, plane(2000), CAMERA.orbited(50 * step, 0))
    assert np.array_equal(held.pixels, copy)


def test_hidden_views_are_not_drawn(qtbot: QtBot, client: RenderClient) -> None:
    client.set_scene(PILLARS, plane(500))
    client.set_camera(PILLARS, CAMERA, SIZE, False)
    before = client.frame(PILLARS)
    drawn(qtbot, client, plane(500), CAMERA)
    assert client.frame(PILLARS) is before
    client.show([PILLARS])
    assert not client.is_at_rest()
    qtbot.waitUntil(client.is_at_rest)
    assert client.frame(PILLARS) is not before


def test_views_of_different_sizes_do_not_disturb_each_other(qtbot: QtBot, client: RenderClient) -> None:
    client.show([CLOUD, PILLARS, RECONSTRUCTION])
    sizes = {CLOUD: (300, 80), PILLARS: (100, 200), RECONSTRUCTION: (64, 64)}
    for turn in range(3):
        for view, (width, height) in sizes.items():
            client.set_scene(view, plane(20_000))
            client.set_camera(view, CAMERA, (width + 70 * turn, height), False)
        qtbot.waitUntil(client.is_at_rest)
        for view in sizes:
            frame = client.frame(view)
            assert frame is not None
            middle = rgb(frame)[frame.pixels.shape[0] // 2, frame.pixels.shape[1] // 2]
            assert middle[1] > 60, f"{view} is empty after a resize"
            assert frame.covered > 500


def test_a_new_palette_does_not_send_the_places_again(
    qtbot: QtBot, client: RenderClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = plane(5000)
    assert scene.points is not None
    drawn(qtbot, client, scene, CAMERA)
    written: list[int] = []
    write = Store.write

    def noted(store: Store, array: NDArray[Any]) -> dict[str, Any]:
        written.append(array.nbytes)
        return write(store, array)

    monkeypatch.setattr(Store, "write", noted)
    palette = np.full((256, 3), (230, 159, 0), np.uint8)
    frame = drawn(qtbot, client, Scene(Points(scene.points.places, scene.points.codes, palette)), CAMERA)
    assert not written
    assert (rgb(frame) == (230, 159, 0)).all(axis=2).any()


def test_meshes_keep_their_baked_colours_beside_lit_points(qtbot: QtBot, client: RenderClient) -> None:
    corners = np.array([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], np.float32)
    blue = np.full((4, 3), (0, 114, 178), np.uint8)
    mesh = Triangles(corners, np.array([[0, 1, 2], [0, 3, 2]], np.int32), blue)  # one from each side
    above = plane(3000).points
    assert above is not None
    places = (above.places * 0.3 + [0, 0, 0.5]).astype(np.float32)
    points = Points(places, above.codes, above.palette)
    frame = drawn(qtbot, client, Scene(points, (mesh,), low=corners[0], high=corners[2]), CAMERA)
    blues = rgb(frame)[rgb(frame)[..., 2] > 130]
    assert (frame.triangles, frame.points) == (2, 3000)
    assert len(blues) > 3000
    assert (blues == (0, 114, 178)).all(), "a mesh was darkened"


def test_an_empty_view_is_background(qtbot: QtBot, client: RenderClient) -> None:
    frame = drawn(qtbot, client, EMPTY, CAMERA)
    assert (rgb(frame) == BACKGROUND).all()
    assert frame.covered == 0


def test_scenes_and_cameras_come_and_go_without_leaving_anything(qtbot: QtBot, client: RenderClient) -> None:
    def files() -> int:
        return sum(len(list(folder.iterdir())) for folder in client._store.folders)

    for warm in range(10):
        drawn(qtbot, client, plane(20_000 + warm), CAMERA.orbited(warm, 0))
    process, count = psutil.Process(client.process_id), files()
    memory, handles = process.memory_info().rss, process.num_fds()
    for step in range(40):
        drawn(qtbot, client, plane(20_000 + step), CAMERA.orbited(step, 0))
    assert files() <= count + 1
    assert process.num_fds() <= handles + 2
    assert process.memory_info().rss - memory < 30e6


def test_a_killed_process_comes_back_with_everything(qtbot: QtBot, own: RenderClient) -> None:
    states: list[str] = []
    own.state_changed.connect(states.append)
    own.set_background(BACKGROUND)
    own.start()
    before = rgb(drawn(qtbot, own, plane(3000), CAMERA))
    os.kill(own.process_id, signal.SIGKILL)
    qtbot.waitUntil(lambda: "stopped" in states)
    assert not own.is_at_rest()
    qtbot.waitUntil(own.is_at_rest)
    assert states == ["starting", "running", "stopped", "starting", "running"]
    frame = own.frame(CLOUD)
    assert frame is not None
    assert np.array_equal(rgb(frame), before)


def test_after_many_deaths_it_gives_up_until_started_again(qtbot: QtBot, own: RenderClient) -> None:
    def kill() -> bool:
        if own.process_id and own.state == "starting":
            os.kill(own.process_id, signal.SIGKILL)
        return own.state == "failed"

    own.start()
    qtbot.waitUntil(kill)
    assert own.reason.endswith(".")
    own.start()
    drawn(qtbot, own, plane(100), CAMERA)


def test_without_open3d_it_says_so(
    qtbot: QtBot, own: RenderClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "open3d.py").write_text("raise ImportError('libGL.so.1 is missing')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    own.start()
    qtbot.waitUntil(lambda: own.state == "failed")
    assert "libGL.so.1 is missing" in own.reason
    assert own.process_id == 0


def test_closing_leaves_no_process_and_no_file(qtbot: QtBot, own: RenderClient) -> None:
    own.start()
    drawn(qtbot, own, plane(100), CAMERA)
    process, folders = psutil.Process(own.process_id), own._store.folders
    own.close()
    assert not process.is_running()
    assert not any(folder.exists() for folder in folders)
    own.set_scene(CLOUD, plane(50))  # late signals of a closing window do no harm


WINDOW = """
import sys
from PySide6.QtCore import QCoreApplication
from stepfield_app.render.client import RenderClient
application = QCoreApplication([])
client = RenderClient()
client.state_changed.connect(lambda state: print(client.process_id, *client._store.folders, flush=True))
client.start()
application.exec()
"""


def test_a_killed_window_takes_the_drawing_process_and_its_files_along(qtbot: QtBot) -> None:
    window = subprocess.Popen([sys.executable, "-c", WINDOW], stdout=subprocess.PIPE, text=True)
    assert window.stdout is not None
    window.stdout.readline()
    number, *folders = window.stdout.readline().split()
    process = psutil.Process(int(number))
    window.kill()
    window.wait()
    window.stdout.close()
    process.wait(10)
    assert all(PREFIX in folder for folder in folders)
    assert not any(Path(folder).exists() for folder in folders)


def test_the_drawing_process_needs_no_qt() -> None:
    check = "import stepfield_app.render.server, sys; sys.exit('PySide6' in sys.modules)"
    subprocess.run([sys.executable, "-c", check], check=True)
