"""Files both processes map, and the lines they exchange."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stepfield_app.render import protocol, store
from stepfield_app.render.camera import Camera
from stepfield_app.render.protocol import Draw, Drawn, arrays_of, line, message, scene_of, scene_tree
from stepfield_app.render.scene import Lines, Points, Scene, Triangles
from stepfield_app.render.shared import LEAST, Shared
from stepfield_app.render.slots import Slots
from stepfield_app.render.store import PREFIX, Store, mapped


def test_arrays_come_back_as_they_were() -> None:
    shelf = Store()
    for array in (
        np.arange(12, dtype=np.float32).reshape(4, 3),
        np.arange(6, dtype=np.int32).reshape(2, 3)[:, ::2],
        np.empty((0, 3), np.uint8),
    ):
        back = mapped(shelf.write(array))
        assert back.dtype == array.dtype
        assert np.array_equal(back, array)
        assert back.size == 0 or not back.flags.writeable
    shelf.close()
    assert not any(folder.exists() for folder in shelf.folders)


def test_a_shared_array_is_in_its_file_for_as_long_as_somebody_has_it() -> None:
    files = Store()
    shelf = Shared(files)
    given = np.arange(3 * LEAST, dtype=np.float32).reshape(-1, 3)
    array = shelf.share(given)
    where = shelf.where(array)
    assert where is not None
    assert array.dtype == given.dtype
    assert np.array_equal(array, given)
    assert not array.flags.writeable
    assert np.array_equal(mapped(where), given), "the drawing process reads something else"
    assert shelf.share(array) is array, "it is shared already"
    assert Path(where["file"]).exists()
    del array
    assert not Path(where["file"]).exists(), "nobody has the array, and the file stays"
    small = np.zeros(3)
    assert shelf.share(small) is small
    assert shelf.where(small) is None
    files.close()


def test_without_room_an_array_stays_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(store: Store, array: object) -> None:
        raise OSError(28, "No space left on device")

    files = Store()
    monkeypatch.setattr(Store, "write", full)
    given = np.zeros(LEAST)
    assert Shared(files).share(given) is given
    files.close()


def test_what_a_killed_window_left_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store, "_places", lambda: [tmp_path])
    child = os.fork() if hasattr(os, "fork") else pytest.skip("needs a process that has ended")
    if child == 0:
        os._exit(0)
    os.waitpid(child, 0)
    stale, mine = tmp_path / f"{PREFIX}{child}-x", tmp_path / f"{PREFIX}{os.getpid()}-x"
    stale.mkdir()
    mine.mkdir()
    Store().close()
    assert not stale.exists()
    assert mine.exists(), "a running window's files must stay"


def test_a_picture_that_is_looked_at_is_never_drawn_over() -> None:
    shelf = Store()
    slots = Slots(shelf)
    first = slots.free(1000)
    pixels, depth = first.picture((5, 4), True)
    assert depth is not None
    part = pixels[1:3]
    del pixels, depth
    assert slots.free(1000) is not first, "a part of the picture is still in use"
    del part
    assert slots.free(1000) is first, "nobody looks at it any more, yet it is not used again"
    assert slots.free(10_000) is not first, "too small"
    assert len(list(first.path.parent.iterdir())) == 1, "files that are not used stay"
    shelf.close()


def test_messages_come_back_as_they_were() -> None:
    camera = Camera((1.0, 2.5, -3.0), 40, 30, 7, True)
    tree = protocol.camera_tree(camera)
    draw = Draw("cloud", 3, tree, (640, 400), True, "/a/b")
    drawn = Drawn("cloud", 3, (640, 400), False, True, 5, 6, 0, 0.25)
    back = message(line(draw))
    assert isinstance(back, Draw)
    assert replace(back, camera=tree) == draw
    assert protocol.camera_of(back.camera) == camera
    assert message(line(drawn)) == drawn


def test_a_scene_comes_back_as_it_was() -> None:
    shelf = Store()
    places = np.zeros((5, 3), np.float32)
    palette = np.arange(768, dtype=np.uint32).reshape(256, 3).astype(np.uint8)
    scene = Scene(
        Points(places, np.arange(5, dtype=np.uint8), palette, 2.0),
        (Triangles(places, np.array([[0, 1, 2]], np.int32), places.astype(np.uint8)),),
        (Lines(np.ones((2, 2, 3), np.float32), np.ones((2, 3), np.uint8)),),
        np.array([1.0, 2.0, 3.0]),
        np.array([4.0, 5.0, 6.0]),
    )
    back = scene_of(scene_tree(scene, shelf.write), mapped)
    for one, other in zip(arrays_of(scene), arrays_of(back), strict=True):
        assert np.array_equal(one, other)
    assert back.points is not None
    assert back.points.palette is not None
    assert np.array_equal(back.points.palette, palette)
    assert (back.points.size, back.low.tolist(), back.high.tolist()) == (2.0, [1, 2, 3], [4, 5, 6])
    shelf.close()
