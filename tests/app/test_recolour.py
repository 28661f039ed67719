"""An edit recolours the pictures that are there: what moved, as its new layer, and nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import table
from tests.app.stubs import Bench, floor_frame
from tests.core.edited import Window, random_plan, write_shelves

from stepfield import moving
from stepfield.project import Project
from stepfield.reconstruction import Reconstruction
from stepfield_app.feeds.recolour_feed import RecolourFeed
from stepfield_app.render.camera import Camera
from stepfield_app.render.scene import CLOUD, PILLARS, Frame
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.scenes.recolour import Coloured, Recolouring, recoloured

Bytes = NDArray[np.uint8]
SIZE = (120, 90)
#: Height of the eye above the lowest point, metres.
EYE = 10.0


@pytest.fixture
def window(tmp_path: Path) -> Window:
    return Window(write_shelves(tmp_path / "shelves.npy"))


def coloured(result: Reconstruction, *hidden: int) -> Coloured:
    visible = [layer for layer in range(-1, len(result.layers)) if layer not in hidden]
    return Coloured(result, layer_colours(len(result.layers), ()), visible)


class FromAbove:
    """Pictures of the tops of pillars from above: the highest shown one of each compartment."""

    def __init__(self, result: Reconstruction) -> None:
        grid = result.field.compartments.grid
        self.origin = np.array([grid.west, grid.south, result.field.compartments.lowest])
        middle = grid.columns * grid.cell_size / 2, grid.rows * grid.cell_size / 2, 0.0
        self.camera = Camera(middle, 0.0, 90.0, EYE, parallel=True)
        metres = self.camera.metres_per_pixel(SIZE)
        column, row = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
        self.x, self.y = middle[0] + (column - SIZE[0] / 2) * metres, middle[1] + (SIZE[1] / 2 - row) * metres
        self.inside = (self.x > 0) & (self.x < 2 * middle[0]) & (self.y > 0) & (self.y < 2 * middle[1])
        self.compartment = grid.compartment(self.x.ravel(), self.y.ravel()).reshape(self.x.shape)
        self.light = 0.6 + 0.4 * np.random.default_rng(0).random(self.x.shape)

    def draw(self, shown: Coloured) -> tuple[Bytes, NDArray[np.float32]]:
        """Return pixels and depth."""
        field, layer = shown.result.field, shown.result.layering.layer
        seen = np.flatnonzero(np.isin(layer, list(shown.visible)))
        top = np.full(len(field.compartments.grid), -1)
        top[field.compartment[seen]] = seen  # of several the last one is the highest
        pillar = np.where(self.inside, top[self.compartment], -1)
        there = pillar >= 0
        depth = np.where(there, EYE - field.elevation[pillar], 0).astype(np.float32)
        pixels = np.zeros((*there.shape, 4), np.uint8)
        lit = shown.colours[layer[pillar]] * self.light[..., np.newaxis]
        pixels[..., 2::-1][there] = np.rint(lit[there])
        return pixels, depth


@pytest.mark.parametrize("seed", range(6))
def test_a_picture_looks_as_if_it_were_drawn_after_the_edit(window: Window, seed: int) -> None:
    """Shown from above, with moves over one another; blocks that change places look as they did."""
    rng, before = np.random.default_rng(seed), coloured(window.result)
    above = FromAbove(window.result)
    pixels, depth = above.draw(before)
    while len(window.project.moves) < 3:
        plan = random_plan(window.result, (), rng)
        if plan.numbers == () and plan.made is None:
            window.do(plan)
    now = coloured(window.result)
    change = Recolouring.between(before, now, above.origin)
    assert change is not None
    made = recoloured(pixels, depth, above.camera, change)
    wanted, _ = above.draw(now)
    off = np.abs(made[..., :3].astype(int) - wanted[..., :3]).max(axis=2)
    assert np.count_nonzero(off > 3) <= 0.01 * np.count_nonzero(depth)
    assert np.array_equal(made[depth == 0], pixels[depth == 0])


def test_lines_over_a_picture_stay_as_they_are(window: Window) -> None:
    before, above = coloured(window.result), FromAbove(window.result)
    pixels, depth = above.draw(before)
    pixels[40:42, :, :3] = 255
    window.do(moving.move_to(window.result, window.result.layering.layer == 1, 0))
    change = Recolouring.between(before, coloured(window.result), above.origin)
    assert change is not None
    assert (recoloured(pixels, depth, above.camera, change)[40:42, :, :3] == 255).all()


def test_hidden_layers_and_other_parameters_are_left_to_the_drawing(window: Window) -> None:
    before = window.result
    window.do(moving.move_to(before, before.layering.layer == 1, "A"))
    now, origin = window.result, np.zeros(3)
    assert Recolouring.between(coloured(before), coloured(now), origin) is not None
    assert Recolouring.between(coloured(now), coloured(now), origin) is None
    assert Recolouring.between(coloured(before, 1), coloured(now), origin) is None
    assert Recolouring.between(coloured(before), coloured(now, len(now.layers) - 1), origin) is None
    other = replace(now, parameters=now.parameters.model_copy(update={"alpha": 0.7}))
    assert Recolouring.between(coloured(before), coloured(other), origin) is None


def test_a_perspective_is_recoloured_where_the_moved_pillars_are(tmp_path: Path) -> None:
    """On a level floor, seen aslant, pixels over the moved compartments change and no others."""
    rng, path = np.random.default_rng(1), tmp_path / "floor.npy"
    np.save(path, np.c_[rng.random((5000, 2)) * 4, np.zeros(5000)])
    window = Window(path)
    grid = window.result.field.compartments.grid
    before, origin = coloured(window.result), np.array([grid.west, grid.south, 0.0])
    camera = Camera((2.0, 2.0, 0.0), 30.0, 50.0, 6.0)
    red, green, blue = (int(part) for part in before.colours[0])
    frame = floor_frame(camera, SIZE, (red, green, blue))
    middle = grid.centres(window.result.field.compartment)
    window.do(moving.move_to(window.result, middle[:, 0] - grid.west < 1.5, "A"))
    change = Recolouring.between(before, coloured(window.result), origin)
    assert change is not None
    assert frame.depth is not None
    made = recoloured(frame.pixels, frame.depth, camera, change)
    new = coloured(window.result).colours[1][::-1]
    for row, column in np.argwhere(frame.depth > 0)[::37]:
        x, y, _ = camera.unproject(column + 0.5, row + 0.5, float(frame.depth[row, column]), SIZE)
        if abs(x - 1.6) < 0.05 or not (0.1 < x < 3.9 and 0.1 < y < 3.9):
            continue
        assert (made[row, column, :3] == new).all() == (x < 1.6)


class Edited(Bench):
    """A bench with a table, whose pictures are recoloured."""

    def __init__(self, qtbot: QtBot, folder: Path) -> None:
        super().__init__(qtbot)
        self.feed = RecolourFeed(self.document, self.trio, self.client, self.scene_feed)  # type: ignore[arg-type]
        path = folder / "table.npy"
        np.save(path, table())
        self.open(path, cell_size=0.5, layer_tolerance=0.3, alpha=0.5)
        self.scene_feed.set_visible((-1, 0, 1))
        self.settle()

    def deliver(self, view: str) -> Frame:
        """Let a picture arrive of what the renderer was given: a floor in the colour of the lowest layer."""
        red, green, blue = (int(part) for part in layer_colours(2, ())[0])
        camera = self.trio.viewpoint.camera
        frame = floor_frame(camera, self.trio.canvases[view].pixels, (red, green, blue))
        self.client.deliver(view, frame)
        return frame

    def edit(self) -> None:
        """Move the floor to a new layer and wait for the result, not for its scenes."""
        answer = self.document.answer
        assert answer is not None
        plan = moving.move_to(answer.result, answer.result.layering.layer == 0, 1)
        self.document.edit(plan.text, plan.applied(self.document.project))
        self.qtbot.waitUntil(lambda: self.document.answer is not answer)

    def is_recoloured(self, view: str) -> bool:
        frame = self.trio.canvases[view].frame
        return frame is not None and frame is not self.client.frame(view)

    def close(self) -> None:
        """End every worker."""
        self.feed.close()
        super().close()


@pytest.fixture
def bench(qtbot: QtBot, tmp_path: Path) -> Iterator[Edited]:
    bench = Edited(qtbot, tmp_path)
    yield bench
    bench.close()


def test_a_view_shows_an_edit_until_its_own_picture_comes(bench: Edited) -> None:
    drawn = bench.deliver(PILLARS)
    bench.deliver(CLOUD)
    assert not bench.is_recoloured(PILLARS)
    bench.edit()
    bench.qtbot.waitUntil(lambda: bench.is_recoloured(PILLARS))
    shown = bench.trio.canvases[PILLARS].frame
    assert shown is not None
    assert not np.array_equal(shown.pixels, drawn.pixels)
    assert shown.depth is drawn.depth
    assert not bench.is_recoloured(CLOUD), "it is coloured by height, which no edit changes"
    bench.settle()
    assert bench.is_recoloured(PILLARS), "its own picture is not drawn yet"
    bench.deliver(PILLARS)
    assert not bench.is_recoloured(PILLARS)


def test_an_edit_that_is_undone_before_it_was_drawn_leaves_the_picture_as_it_was(bench: Edited) -> None:
    bench.deliver(PILLARS)
    before: Project = bench.document.project
    bench.edit()
    bench.qtbot.waitUntil(lambda: bench.is_recoloured(PILLARS))
    bench.document.undo_stack.undo()
    bench.qtbot.waitUntil(lambda: not bench.is_recoloured(PILLARS))
    assert bench.document.project == before
    bench.settle()


def test_outlines_painted_over_a_picture_meanwhile_do_not_bring_the_old_colours_back(bench: Edited) -> None:
    bench.deliver(PILLARS)
    bench.edit()
    bench.qtbot.waitUntil(lambda: bench.is_recoloured(PILLARS))
    client, canvas = bench.client, bench.trio.canvases[PILLARS]
    scene, frame = client.drawn_scene(PILLARS), client.frame(PILLARS)
    assert frame is not None
    client.scenes[PILLARS] = scene
    client.deliver(PILLARS, replace(frame, pixels=frame.pixels.copy()))
    assert bench.is_recoloured(PILLARS)
    bench.qtbot.waitUntil(lambda: bench.feed.is_idle)
    assert bench.is_recoloured(PILLARS)
    assert canvas.frame is not None
