"""What is left out of a full picture of many triangles: nothing that could be seen in it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from pytestqt.qtbot import QtBot

from stepfield_app.render import seen as part
from stepfield_app.render.camera import Camera
from stepfield_app.render.client import RenderClient
from stepfield_app.render.detail import Overtaken
from stepfield_app.render.picture import FEW
from stepfield_app.render.scene import PILLARS, Bytes, Scene, Triangles
from stepfield_app.render.seen import seen
from stepfield_app.scenes.blocks import meshes
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.scenes.stacks import Lattice, Stack
from stepfield_app.scenes.surfaces import merged

SIZE = (64, 48)
NEAR = 0.5
ABOVE = Camera((0.0, 0.0, 0.0), 30, 40, 6)


def quiet() -> None:
    """Say that nothing newer is there."""


def soup(count: int, side: float, seed: int, *, solid: bool = False) -> Triangles:
    """Triangles anywhere, some of them behind the eye."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-7, 7, (count, 1, 3)) + rng.normal(0, side, (count, 3, 3))
    order = np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    colours = np.repeat(np.arange(count)[:, np.newaxis] % 251, 3, axis=1).repeat(3, axis=0).astype(np.uint8)
    return Triangles(corners.reshape(-1, 3).astype(np.float32), order, colours, solid)


def tower(rows: int = 60) -> Stack:
    """Blocks of any height side by side, 4 m wide in all."""
    rng = np.random.default_rng(3)
    edges = np.linspace(-2, 2, rows + 1)
    top = rng.uniform(0, 0.3, rows**2)
    index = np.arange(rows**2)
    foot = np.zeros(len(top))
    return Stack(Lattice(edges, edges[::-1]), foot.astype(int), index, foot, top, foot == 0, foot > 0)


def covers_a_middle(corners: NDArray[np.float64]) -> bool:
    """Whether the middle of a pixel of the picture lies in a triangle, shape (3, 2), pixel by pixel."""
    across, down = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    sides = []
    for one, other in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = other - one
        sides.append(along[0] * (down - one[1]) - along[1] * (across - one[0]))
    return bool((np.all(np.array(sides) > 0, axis=0) | np.all(np.array(sides) < 0, axis=0)).any())


@given(st.integers(0, 10_000), st.sampled_from([0.02, 0.2, 2.0]), st.booleans())
def test_what_covers_the_middle_of_a_pixel_is_kept(seed: int, side: float, parallel: bool) -> None:
    mesh, camera = soup(60, side, seed), Camera((0.0, 0.0, 0.0), 40, 30, 6, parallel)
    kept = seen(mesh, camera, SIZE, NEAR, quiet)
    there = {tuple(corner) for corner in kept.vertices[kept.triangles].reshape(-1, 9)}
    for corners in mesh.vertices[mesh.triangles]:
        pixels, depth = camera.project(corners, SIZE)
        if (depth > NEAR).all() and covers_a_middle(pixels):
            assert tuple(corners.ravel()) in there, "a triangle that shows is not drawn"


def test_small_triangles_and_those_beside_the_picture_are_left_out() -> None:
    mesh = soup(5000, 0.01, 1)
    kept = seen(mesh, ABOVE, SIZE, NEAR, quiet)
    assert 0 < len(kept.triangles) < len(mesh.triangles) / 4
    assert len(kept.vertices) == 3 * len(kept.triangles)
    known = {(*corner, *colour) for corner, colour in zip(mesh.vertices, mesh.colours, strict=True)}
    assert {(*corner, *colour) for corner, colour in zip(kept.vertices, kept.colours, strict=True)} <= known


@pytest.mark.parametrize("parallel", [False, True])
def test_faces_of_a_solid_that_look_away_are_left_out_from_above_only(parallel: bool) -> None:
    mesh = meshes(tower(4), layer_colours(1), None, 1)[0]
    above = Camera((0.0, 0.0, 0.0), 30, 40, 6, parallel)
    below = Camera((0.0, 0.0, 0.0), 30, -40, 6, parallel)
    half = len(seen(mesh, above, (640, 480), NEAR, quiet).triangles)
    assert half < 0.8 * len(mesh.triangles)
    whole = len(seen(mesh, below, (640, 480), NEAR, quiet).triangles)
    assert whole > 0.9 * len(mesh.triangles), "columns have no underside: one sees into them"


def test_a_newer_request_stops_the_choice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(part, "CHUNK", 100)
    looks = iter(range(5))

    def look_up() -> None:
        if next(looks, None) is None:
            raise Overtaken

    with pytest.raises(Overtaken):
        seen(soup(2000, 0.1, 0), ABOVE, SIZE, NEAR, look_up)


def test_no_triangle_at_all_is_no_fault() -> None:
    nothing = soup(0, 1, 0)
    assert seen(nothing, ABOVE, SIZE, NEAR, quiet) is nothing
    beside = seen(soup(10, 0.01, 0), Camera((0.0, 900.0, 0.0), 0, 0, 6), SIZE, NEAR, quiet)
    assert beside.triangles.shape == (0, 3)


@pytest.fixture
def client(qtbot: QtBot) -> Iterator[RenderClient]:
    client = RenderClient()
    client.show([PILLARS])
    client.start()
    qtbot.waitUntil(lambda: client.state in ("running", "failed"))
    if client.state == "failed":
        client.close()
        pytest.skip(client.reason)
    yield client
    client.close()


def picture(qtbot: QtBot, client: RenderClient, mesh: Triangles, camera: Camera) -> tuple[Bytes, int]:
    client.set_scene(PILLARS, Scene(meshes=(mesh,), low=np.full(3, -2.0), high=np.full(3, 2.0)))
    client.set_camera(PILLARS, camera, (321, 240), False)
    qtbot.waitUntil(client.is_at_rest)
    frame = client.frame(PILLARS)
    assert frame is not None
    return frame.pixels[..., :3].copy(), frame.triangles


def test_pictures_are_the_same_with_and_without_leaving_out(qtbot: QtBot, client: RenderClient) -> None:
    """The same blocks, once and so many times that not all of them are drawn."""
    few = meshes(tower(), layer_colours(1), None, 1)[0]
    many = merged([few] * (FEW // len(few.triangles) + 1))
    many = Triangles(many.vertices, many.triangles, many.colours, solid=True)
    for elevation, distance, parallel in ((50, 5, False), (25, 1.5, False), (35, 5, True), (-20, 5, False)):
        camera = Camera((0.0, 0.0, 0.0), 30, elevation, distance, parallel)
        whole, count = picture(qtbot, client, few, camera)
        some, chosen = picture(qtbot, client, many, camera)
        assert count == len(few.triangles)
        assert chosen < len(many.triangles)
        differing = np.count_nonzero((whole != some).any(axis=2))
        assert differing < 5e-3 * whole[..., 0].size, f"from {elevation} degrees above"
