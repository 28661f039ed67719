"""The crop box in the views: a drag of a handle is one step, exact, and never beyond the scan."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import UTM, table
from tests.app.stubs import Bench, floor_frame

from stepfield_app import runner
from stepfield_app.render.scene import CLOUD, PILLARS, VIEWS
from stepfield_app.scenes import crop
from stepfield_app.theme import DARK
from stepfield_app.tools.crop import CropTool
from stepfield_app.views.view3d import Canvas

LEFT = Qt.MouseButton.LeftButton
EAST, WEST, CORNER = (1, 0, 0), (-1, 0, 0), (1, 1, 1)
PARAMETERS = {"cell_size": 0.5, "layer_tolerance": 0.3, "alpha": 0.5}


@pytest.fixture(params=[(0.0, 0.0, 0.0), UTM], ids=["near", "far"])
def scan(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """The table at home, and in a national grid."""
    path = tmp_path / "table.npy"
    np.save(path, table(request.param))
    return path


@pytest.fixture
def bench(qtbot: QtBot, scan: Path) -> Iterator[Bench]:
    bench = Bench(qtbot)
    bench.open(scan, **PARAMETERS)
    bench.trio.set_parallel(True)
    bench.trio.look_from("top")
    yield bench
    bench.close()


@pytest.fixture
def tool(bench: Bench) -> CropTool:
    tool = CropTool(bench.document, bench.trio, bench.scene_feed)
    tool.set_theme(DARK)
    tool.set_active(True)
    return tool


def held(
    bench: Bench, tool: CropTool, side: tuple[int, int, int], view: str = CLOUD
) -> tuple[Canvas, QPoint]:
    """Press a handle; where the hand is."""
    canvas = bench.trio.canvases[view]
    at = tool.place_of(canvas, side).toPoint()
    QTest.mousePress(canvas, LEFT, pos=at)
    return canvas, at


def drag(
    bench: Bench, tool: CropTool, side: tuple[int, int, int], way: tuple[int, int], view: str = CLOUD
) -> None:
    canvas, at = held(bench, tool, side, view)
    for share in (0.25, 0.5, 1.0):
        QTest.mouseMove(canvas, at + QPoint(round(way[0] * share), round(way[1] * share)))
    QTest.mouseRelease(canvas, LEFT, pos=at + QPoint(*way))


def test_a_drag_of_a_face_moves_it_with_the_hand_in_one_step(bench: Bench, tool: CropTool) -> None:
    facts = bench.document.facts
    assert facts is not None
    canvas, camera = bench.trio.canvases[CLOUD], bench.trio.viewpoint.camera
    drag(bench, tool, EAST, (-60, 3))
    box = bench.document.project.parameters.crop
    assert box is not None
    metres = 60 * camera.metres_per_pixel(canvas.pixels)
    assert box[3] == pytest.approx(facts.bounds[3] - metres, abs=1e-6)
    assert (*box[:3], *box[4:]) == (*facts.bounds[:3], *facts.bounds[4:]), "another face has moved"
    assert bench.document.undo_stack.count() == 1
    assert bench.trio.viewpoint.camera == camera, "the camera has moved too"
    answer = bench.settle()
    assert answer.result.scan.bounds()[1][0] <= box[3]
    bench.document.undo_stack.undo()
    assert bench.document.project.parameters.crop is None


@pytest.mark.parametrize("view", VIEWS)
def test_handles_are_in_every_view(bench: Bench, tool: CropTool, view: str) -> None:
    drag(bench, tool, WEST, (30, 0), view)
    assert bench.document.undo_stack.count() == 1


def test_the_box_never_reaches_beyond_the_scan(bench: Bench, tool: CropTool) -> None:
    facts = bench.document.facts
    assert facts is not None
    drag(bench, tool, EAST, (-60, 0))
    drag(bench, tool, EAST, (500, 0))
    assert bench.document.project.parameters.crop == facts.bounds
    drag(bench, tool, EAST, (-5000, 0))
    box = bench.document.project.parameters.crop
    assert box is not None
    assert box[3] > box[0], "the box is turned inside out"
    assert facts.bounds[0] <= box[0]


def test_a_corner_moves_two_sides(bench: Bench, tool: CropTool) -> None:
    facts = bench.document.facts
    assert facts is not None
    drag(bench, tool, CORNER, (-30, 20))
    box = bench.document.project.parameters.crop
    assert box is not None
    assert box[3] < facts.bounds[3]
    assert box[4] < facts.bounds[4]
    assert (box[2], box[5]) == (facts.bounds[2], facts.bounds[5])


def test_two_drags_are_two_steps(bench: Bench, tool: CropTool) -> None:
    drag(bench, tool, EAST, (-40, 0))
    drag(bench, tool, WEST, (40, 0))
    stack = bench.document.undo_stack
    assert [stack.text(i) for i in range(stack.count())] == ["Crop", "Crop"]


def test_the_exact_result_comes_when_the_hand_lets_go(
    bench: Bench, tool: CropTool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If it failed, a preview of some of the points would be exported."""
    monkeypatch.setattr(runner, "SMALL_SCAN", 0)
    monkeypatch.setattr(runner, "PREVIEW_POINTS", 200)
    quick: list[bool] = []
    bench.document.answer_changed.connect(lambda answer: quick.append(answer.request.quick))
    canvas, at = held(bench, tool, EAST)
    QTest.mouseMove(canvas, at + QPoint(-50, 0))
    bench.qtbot.waitUntil(lambda: quick == [True] and not bench.document.busy)
    assert bench.document.pending
    QTest.mouseRelease(canvas, LEFT, pos=at + QPoint(-50, 0))
    assert not bench.settle().request.quick


def test_leaving_the_tool_ends_the_drag(
    bench: Bench, tool: CropTool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Esc in the middle of a drag: without it the exact result would never come again."""
    monkeypatch.setattr(runner, "SMALL_SCAN", 0)
    monkeypatch.setattr(runner, "PREVIEW_POINTS", 200)
    canvas, at = held(bench, tool, EAST)
    QTest.mouseMove(canvas, at + QPoint(-50, 0))
    tool.set_active(False)
    assert not bench.settle().request.quick
    box = bench.document.project.parameters.crop
    QTest.mouseMove(canvas, at + QPoint(-90, 0))
    QTest.mouseRelease(canvas, LEFT, pos=at + QPoint(-90, 0))
    assert bench.document.project.parameters.crop == box, "a tool that was left goes on"


def test_beside_the_handles_the_camera_has_the_mouse(bench: Bench, tool: CropTool) -> None:
    canvas, camera = bench.trio.canvases[CLOUD], bench.trio.viewpoint.camera
    QTest.mousePress(canvas, LEFT, pos=QPoint(3, 3))
    QTest.mouseMove(canvas, QPoint(40, 3))
    QTest.mouseRelease(canvas, LEFT, pos=QPoint(40, 3))
    assert bench.trio.viewpoint.camera != camera
    assert bench.document.undo_stack.count() == 0


def test_a_click_on_a_handle_is_no_step(bench: Bench, tool: CropTool) -> None:
    canvas, at = held(bench, tool, EAST)
    QTest.mouseRelease(canvas, LEFT, pos=at)
    assert bench.document.undo_stack.count() == 0
    assert not bench.document._gestures


def test_a_handle_lights_up_under_the_cursor(bench: Bench, tool: CropTool) -> None:
    canvas = bench.trio.canvases[PILLARS]
    QTest.mouseMove(canvas, tool.place_of(canvas, EAST).toPoint())
    assert canvas.cursor().shape() == Qt.CursorShape.PointingHandCursor
    assert tool._hovered is not None
    assert tool._hovered.side[0] == 1
    QTest.mouseMove(canvas, QPoint(3, 3))
    assert canvas.cursor().shape() == Qt.CursorShape.ArrowCursor


def test_the_box_is_painted_and_goes_with_the_tool(bench: Bench, tool: CropTool) -> None:
    canvas = bench.trio.canvases[CLOUD]
    bench.client.deliver(CLOUD, floor_frame(bench.trio.viewpoint.camera, canvas.pixels, (20, 20, 20)))
    with_box = canvas.grab().toImage()
    at = tool.place_of(canvas, EAST)
    tool.set_active(False)
    without = canvas.grab().toImage()
    assert with_box != without
    assert with_box.pixelColor(round(at.x()) + 5, round(at.y())).blue() > 150, "no handle where it is taken"


def test_handles_lie_where_the_box_is(bench: Bench, tool: CropTool) -> None:
    """Whole numbers of a national grid must not be rounded to float32 on the way."""
    canvas, facts = bench.trio.canvases[CLOUD], bench.document.facts
    assert facts is not None
    size = np.array(facts.bounds[3:]) - facts.bounds[:3]
    corner = crop.Handle((-1, -1, -1))
    assert tool.box == facts.bounds
    expected, _ = bench.trio.viewpoint.camera.project([[0, 0, 0], size], canvas.pixels)
    for handle, place in ((corner, expected[0]), (crop.Handle((1, 1, 1)), expected[1])):
        at = tool.place_of(canvas, handle.side)
        assert (at.x(), at.y()) == pytest.approx(tuple(place), abs=1e-3)


def test_without_a_scan_there_is_no_box(qtbot: QtBot) -> None:
    bench = Bench(qtbot)
    tool = CropTool(bench.document, bench.trio, bench.scene_feed)
    tool.set_theme(DARK)
    tool.set_active(True)
    assert tool.box is None
    canvas = bench.trio.canvases[CLOUD]
    bench.client.deliver(CLOUD, floor_frame(bench.trio.viewpoint.camera, canvas.pixels))
    canvas.grab()
    QTest.mouseMove(canvas, QPoint(50, 50))
    QTest.mouseClick(canvas, LEFT)
    bench.close()
