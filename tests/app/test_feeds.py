"""Between the document and the views: they show the newest answer, and nothing of an older one."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QObject
from PySide6.QtWidgets import QComboBox, QLabel
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import UTM, table
from tests.app.stubs import Bench

from stepfield.errors import ScanError
from stepfield.moving import move_to
from stepfield.progress import Progress
from stepfield_app import demo, runner
from stepfield_app.feeds import demo_feed
from stepfield_app.feeds.demo_feed import DemoFeed
from stepfield_app.feeds.plot_feed import PlotFeed
from stepfield_app.feeds.status_feed import StatusFeed
from stepfield_app.feeds.stray_feed import StrayFeed
from stepfield_app.panels.cleaning import CleaningPanel
from stepfield_app.panels.layers import LayersPanel
from stepfield_app.render.scene import CLOUD, EMPTY, PILLARS, RECONSTRUCTION, VIEWS
from stepfield_app.theme import LIGHT, rgb
from stepfield_app.views.histogram import HistogramView
from stepfield_app.views.line import ProfileLine
from stepfield_app.views.map import MapView
from stepfield_app.views.profile import ProfileView
from stepfield_app.views.status import Status

PARAMETERS = {"cell_size": 0.5, "layer_tolerance": 0.3, "alpha": 0.5}


@pytest.fixture
def near(tmp_path: Path) -> Path:
    path = tmp_path / "table.npy"
    np.save(path, table())
    return path


@pytest.fixture
def far(tmp_path: Path) -> Path:
    path = tmp_path / "far.npy"
    np.save(path, table(UTM))
    return path


@pytest.fixture
def coloured(tmp_path: Path) -> Path:
    """The table with a colour at every point."""
    points = table()
    lines = [f"{x} {y} {z} 10 20 30" for x, y, z in points]
    properties = [f"property float {name}" for name in "xyz"]
    properties += [f"property uchar {name}" for name in ("red", "green", "blue")]
    head = ["ply", "format ascii 1.0", f"element vertex {len(points)}", *properties, "end_header"]
    path = tmp_path / "coloured.ply"
    path.write_text("\n".join([*head, *lines]) + "\n")
    return path


@pytest.fixture
def bench(qtbot: QtBot) -> Iterator[Bench]:
    bench = Bench(qtbot)
    yield bench
    bench.close()


@pytest.fixture
def previews(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make even the smallest scan worth a preview."""
    monkeypatch.setattr(runner, "SMALL_SCAN", 0)
    monkeypatch.setattr(runner, "PREVIEW_POINTS", 200)


def offered(bench: Bench, view: str) -> list[str]:
    box = bench.trio.headers[view].findChildren(QComboBox)[0]
    return [box.itemData(place) for place in range(box.count())]


# --- 3-D views ----------------------------------------------------------------------------------------------


def test_an_answer_fills_every_view_and_frames_it(bench: Bench, near: Path) -> None:
    bench.open(near, **PARAMETERS)
    scenes = bench.client.scenes
    points = scenes[CLOUD].points
    assert points is not None
    assert len(points.places) == len(table())
    assert scenes[PILLARS].meshes
    assert scenes[RECONSTRUCTION].meshes
    assert bench.trio.viewpoint.camera.centre == pytest.approx((4, 3, 0.5))


def test_the_origin_is_the_corner_of_the_scan(bench: Bench, near: Path, far: Path) -> None:
    """If it failed, a scan in a national grid would be drawn in steps of half a metre."""
    bench.open(near, **PARAMETERS)
    at_home = bench.client.scenes[CLOUD].points
    bench.open(far, **PARAMETERS)
    assert bench.scene_feed.origin == pytest.approx(UTM)
    away = bench.client.scenes[CLOUD].points
    assert at_home is not None
    assert away is not None
    assert np.abs(np.sort(away.places, axis=0) - np.sort(at_home.places, axis=0)).max() < 1e-3
    assert bench.client.scenes[PILLARS].low == pytest.approx((0, 0, 0), abs=1e-6)


def test_a_preview_leaves_the_cloud(bench: Bench, near: Path, previews: None) -> None:
    """The cloud has all the points; a preview has few and would blink."""
    bench.open(near, **PARAMETERS)
    cloud, places = bench.scene_feed.cloud, bench.client.scenes[CLOUD].points
    changes: list[object] = []
    bench.scene_feed.cloud_changed.connect(lambda: changes.append(bench.scene_feed.cloud))
    gesture = bench.document.begin_gesture()
    bench.document.set_parameters("Cell", gesture, cell_size=0.7)
    bench.qtbot.waitUntil(lambda: not bench.document.busy and not bench.scene_feed._drawing.busy)
    assert bench.document.answer is not None
    assert bench.document.answer.request.quick
    assert bench.scene_feed.cloud is cloud
    shown = bench.client.scenes[CLOUD].points
    assert shown is not None
    assert places is not None
    assert shown.places is places.places
    bench.document.end_gesture(gesture)
    bench.settle()
    assert bench.scene_feed.cloud is cloud, "the same points were placed again"
    assert not changes


def test_a_new_answer_keeps_the_camera(bench: Bench, near: Path) -> None:
    bench.open(near, **PARAMETERS)
    camera = bench.trio.viewpoint.camera.orbited(100, 20)
    bench.trio.viewpoint.look(camera)
    bench.document.set_parameters("Alpha", alpha=0.9)
    bench.settle()
    assert bench.trio.viewpoint.camera == camera


def test_views_of_an_edit_are_handed_over_one_by_one(bench: Bench, near: Path) -> None:
    """The drawing process would wait for the last of them; of another scan no two are shown together."""
    handed: list[tuple[str, ...]] = []
    bench.scene_feed.handed_over.connect(lambda _, pictures: handed.append(tuple(pictures)))
    bench.open(near, **PARAMETERS)
    assert handed == [VIEWS]
    handed.clear()
    result = bench.document.answer.result  # type: ignore[union-attr]
    chosen = np.zeros(len(result.field), bool)
    chosen[result.layering.members(1)[:3]] = True
    plan = move_to(result, chosen, 0)
    bench.document.edit(plan.text, plan.applied(bench.document.project))
    bench.settle()
    assert handed == [(CLOUD,), (PILLARS,), (RECONSTRUCTION,), VIEWS]


def test_blocks_that_nobody_could_tell_apart_are_joined_until_the_camera_comes_nearer(
    bench: Bench, near: Path
) -> None:
    """The finest blocks of a million pillars are ten million triangles: seconds, for what no view shows."""
    bench.open(near, **PARAMETERS)
    bench.scene_feed.set_visible((0, 1))
    bench.settle()
    fitted = bench.trio.viewpoint.camera
    fine = len(bench.client.scenes[PILLARS].meshes[0].triangles)
    bench.trio.viewpoint.look(replace(fitted, distance=40 * fitted.distance))
    bench.document.set_parameters("Alpha", alpha=0.9)
    bench.settle()
    assert len(bench.client.scenes[PILLARS].meshes[0].triangles) < fine / 3
    bench.trio.viewpoint.look(fitted)
    bench.qtbot.waitUntil(lambda: len(bench.client.scenes[PILLARS].meshes[0].triangles) == fine)
    bench.settle()


def test_hidden_layers_leave_the_scenes(bench: Bench, near: Path) -> None:
    bench.open(near, **PARAMETERS)
    bench.scene_feed.set_visible((0, 1))
    bench.settle()
    both = len(bench.client.scenes[PILLARS].meshes[0].triangles)
    bench.scene_feed.set_visible((0,))
    bench.settle()
    one = len(bench.client.scenes[PILLARS].meshes[0].triangles)
    assert 0 < one < both
    legend = bench.trio.canvases[PILLARS]._legend
    assert legend is not None
    assert [name for _, name in legend.entries] == ["Layer 1"]


def test_a_layers_colour_is_its_colour_in_the_views(bench: Bench, near: Path) -> None:
    bench.open(near, **PARAMETERS)
    bench.scene_feed.set_visible((0, 1))
    bench.document.project_changed.connect(lambda _: bench.scene_feed.ask())
    bench.document.set_style("Colour", 0, color="#ff0000")
    bench.settle()
    legend = bench.trio.canvases[PILLARS]._legend
    assert legend is not None
    assert ((255, 0, 0), "Layer 1") in legend.entries


def test_a_theme_leads_to_new_scenes_on_a_new_ground(bench: Bench, near: Path) -> None:
    bench.open(near, **PARAMETERS)
    before = bench.client.scenes[CLOUD]
    bench.scene_feed.set_theme(LIGHT)
    bench.settle()
    assert bench.client.background == rgb(LIGHT.window)
    lines = bench.client.scenes[CLOUD].lines[0]
    assert not np.array_equal(lines.colours, before.lines[0].colours), "the ground keeps its old colours"


def test_only_colours_there_are_can_be_chosen(bench: Bench, near: Path, coloured: Path) -> None:
    bench.open(near, **PARAMETERS)
    assert offered(bench, CLOUD) == ["height", "layer", "single"]
    assert offered(bench, PILLARS) == ["layer", "height"]
    bench.open(coloured, **PARAMETERS)
    assert offered(bench, CLOUD) == ["height", "layer", "rgb", "single"]


def test_colours_of_the_last_scan_are_not_asked_of_the_next(bench: Bench, near: Path, coloured: Path) -> None:
    """If it failed, opening a scan without colours would end in an error."""
    failures: list[object] = []
    bench.scene_feed.failed.connect(failures.append)
    bench.open(coloured, **PARAMETERS)
    bench.trio.colour_chosen.emit(CLOUD, "rgb")
    bench.settle()
    points = bench.client.scenes[CLOUD].points
    assert points is not None
    assert points.palette is None
    assert points.codes[0].tolist() == [10, 20, 30]
    bench.open(near, **PARAMETERS)
    assert not failures
    box = bench.trio.headers[CLOUD].findChildren(QComboBox)[0]
    assert box.currentData() == "height"


def area(bench: Bench) -> float:
    """Ground that the reconstruction covers in its finest detail, square metres."""
    mesh = bench.client.scenes[RECONSTRUCTION].meshes[0]
    a, b, c = (mesh.vertices[mesh.triangles[:, i]].astype(float) for i in range(3))
    return float(np.maximum(np.cross(b - a, c - a)[:, 2], 0).sum() / 2)


def test_layers_are_drawn_as_the_parameters_say_until_another_way_is_looked_at(
    bench: Bench, near: Path
) -> None:
    bench.open(near, **PARAMETERS)
    bench.scene_feed.set_visible((0, 1))
    bench.settle()
    box = bench.trio.headers[RECONSTRUCTION].findChildren(QComboBox)[1]
    covered, cut = 8 * 6 + 3 * 2, 7.5 * 5.5 + 2.5 * 1.5
    assert box.currentData() == "edges"
    assert area(bench) == pytest.approx(covered)
    bench.trio.way_chosen.emit("simulator")
    bench.settle()
    assert box.currentData() == "simulator"
    assert area(bench) == pytest.approx(cut)
    bench.trio.way_chosen.emit("pillars")
    bench.document.set_parameters("Surface", reconstruction="simulator")
    bench.settle()
    assert box.currentData() == "simulator"
    assert area(bench) == pytest.approx(cut)
    bench.document.set_parameters("Surface", reconstruction="edges")
    bench.settle()
    assert box.currentData() == "edges"
    assert area(bench) == pytest.approx(covered)


def test_marks_lie_in_the_cloud_and_go_with_the_scan(bench: Bench, near: Path, far: Path) -> None:
    bench.open(far, **PARAMETERS)
    bench.scene_feed.set_marks(np.add([UTM], [(1.0, 2.0, 3.0)]))
    bench.settle()
    marks = bench.client.scenes[CLOUD].lines[-1]
    assert marks.ends.reshape(-1, 3).mean(axis=0) == pytest.approx((1, 2, 3), abs=1e-3)
    bench.open(near, **PARAMETERS)
    assert len(bench.client.scenes[CLOUD].lines) == 1


def test_a_closed_scan_empties_the_views(bench: Bench, near: Path) -> None:
    bench.open(near, **PARAMETERS)
    bench.scene_feed.ask()
    bench.document.close_scan()
    bench.qtbot.waitUntil(lambda: bench.scene_feed.is_idle)
    assert all(bench.client.scenes[view] is EMPTY for view in VIEWS)
    assert bench.scene_feed.cloud is None


def test_hidden_views_are_made_once_they_are_shown(bench: Bench, near: Path) -> None:
    bench.open(near, **PARAMETERS)
    bench.trio.arrange((CLOUD,))
    bench.settle()
    before = bench.client.scenes[PILLARS]
    bench.document.set_parameters("Alpha", alpha=0.9)
    bench.settle()
    assert bench.client.scenes[PILLARS] is before, "a view nobody sees was made"
    bench.trio.arrange(VIEWS)
    bench.settle()
    assert bench.client.scenes[PILLARS] is not before


# --- Map, profile, histogram, layers ------------------------------------------------------------------------


@dataclass
class Plots:
    """The plots around a bench."""

    bench: Bench
    feed: PlotFeed
    map: MapView
    profile: ProfileView
    histogram: HistogramView
    layers: LayersPanel
    sections: list[Any]
    pictures: list[Any]

    def settle(self) -> None:
        self.bench.qtbot.waitUntil(lambda: self.bench.is_settled() and self.feed.is_idle)


@pytest.fixture
def plots(bench: Bench, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> Iterator[Plots]:
    views = MapView(), ProfileView(), HistogramView(), LayersPanel(bench.document)
    for view in views:
        qtbot.addWidget(view)
    feed = PlotFeed(bench.document, bench.scene_feed, *views)
    plots = Plots(bench, feed, *views, sections=[], pictures=[])
    for view, name, seen in (
        (plots.profile, "set_section", plots.sections),
        (plots.map, "set_picture", plots.pictures),
    ):
        show = getattr(view, name)
        monkeypatch.setattr(view, name, lambda shown, show=show, seen=seen: (seen.append(shown), show(shown)))
    failures: list[object] = []
    feed.failed.connect(failures.append)
    yield plots
    assert not failures
    feed.close()


def test_the_map_follows_the_active_layer(plots: Plots, near: Path) -> None:
    plots.bench.open(near, **PARAMETERS)
    plots.settle()
    assert (plots.pictures[-1].layer, plots.pictures[-1].name) == (0, "Layer 1")
    for layer, name in ((1, "Layer 2"), (-1, "Unassigned")):
        plots.bench.document.set_active_layer(layer)
        plots.settle()
        assert (plots.pictures[-1].layer, plots.pictures[-1].name) == (layer, name)


def test_while_a_hand_moves_the_map_is_thin_and_then_whole_again(
    plots: Plots, far: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If it failed, a drag would leave the map of a large scan coarse, or shift it by half a compartment."""
    monkeypatch.setattr("stepfield_app.feeds.plots.QUICK_PIXELS", 50)
    plots.bench.open(far, **PARAMETERS)
    plots.settle()
    whole, document = plots.pictures[-1], plots.bench.document
    gesture = document.begin_gesture()
    document.set_parameters("Alpha", gesture, alpha=0.8)
    plots.bench.qtbot.waitUntil(lambda: not document.pending and plots.feed.is_idle)
    thin = plots.pictures[-1]
    step = round(thin.cell_size / whole.cell_size)
    assert step > 1
    assert np.array_equal(thin.pixels[:, :, 3], whole.pixels[::step, ::step, 3])
    assert thin.west + thin.cell_size / 2 == pytest.approx(whole.west + whole.cell_size / 2)
    assert thin.north - thin.cell_size / 2 == pytest.approx(whole.north - whole.cell_size / 2)
    document.end_gesture(gesture)
    plots.settle()
    assert plots.pictures[-1].pixels.shape == whole.pixels.shape


def test_the_map_lies_where_the_scan_lies(plots: Plots, far: Path) -> None:
    plots.bench.open(far, **PARAMETERS)
    plots.settle()
    picture = plots.pictures[-1]
    assert picture.west <= UTM[0] < UTM[0] + 8 <= picture.east
    assert picture.south <= UTM[1] < UTM[1] + 6 <= picture.north
    assert picture.east - picture.west == pytest.approx(picture.pixels.shape[1] * picture.cell_size)


def test_opening_draws_a_first_profile_through_the_middle(plots: Plots, near: Path) -> None:
    plots.bench.open(near, **PARAMETERS)
    plots.settle()
    section = plots.profile.section
    assert section is not None
    assert (section.start, section.end) == ((0.0, 3.0), (8.0, 3.0))
    assert section.width == pytest.approx(1.0)
    assert set(np.unique(section.codes)) == {0, 1}, "both surfaces are in the section"


def test_the_profile_is_cut_again_after_a_run(plots: Plots, near: Path) -> None:
    plots.bench.open(near, **PARAMETERS)
    plots.settle()
    plots.sections.clear()
    plots.bench.document.set_parameters("Tolerance", layer_tolerance=2.0)
    plots.settle()
    section = plots.sections[-1]
    assert set(np.unique(section.pillar_codes)) == {0}, "the profile shows pillars of older parameters"


def test_a_moved_line_cuts_elsewhere(plots: Plots, near: Path) -> None:
    plots.bench.open(near, **PARAMETERS)
    plots.settle()
    plots.map.plot.line_changed.emit(ProfileLine((0.0, 0.6), (8.0, 0.6), 0.5))
    plots.map.set_line(ProfileLine((0.0, 0.6), (8.0, 0.6), 0.5))
    plots.feed._cut()
    plots.settle()
    section = plots.profile.section
    assert section is not None
    assert section.start == (0.0, 0.6)
    assert set(np.unique(section.codes)) == {0}, "there is no table at the wall"


def test_a_removed_line_empties_the_profile(plots: Plots, near: Path) -> None:
    plots.bench.open(near, **PARAMETERS)
    plots.settle()
    plots.feed._cut()
    plots.map.set_line(None)
    plots.map.section_ended.emit()
    plots.settle()
    assert plots.profile.section is None, "a section that was under way came back"


def test_another_scan_has_a_profile_of_its_own(plots: Plots, near: Path, far: Path) -> None:
    plots.bench.open(near, **PARAMETERS)
    plots.settle()
    plots.bench.open(far, **PARAMETERS)
    plots.settle()
    section = plots.profile.section
    assert section is not None
    assert section.start == pytest.approx((UTM[0], UTM[1] + 3))
    assert section.elevation.min() == pytest.approx(UTM[2])
    assert len(section.distance) > 30
    assert plots.pictures[-1].west == pytest.approx(UTM[0], abs=0.5)


def test_a_renamed_layer_is_renamed_on_the_map(plots: Plots, near: Path) -> None:
    plots.bench.open(near, **PARAMETERS)
    plots.settle()
    plots.bench.document.set_style("Rename", 0, name="Floor", color="#112233")
    plots.settle()
    assert (plots.pictures[-1].name, plots.pictures[-1].colour) == ("Floor", "#112233")


def test_the_histogram_counts_every_point(plots: Plots, near: Path) -> None:
    answer = plots.bench.open(near, **PARAMETERS)
    plots.settle()
    shown = plots.histogram._histogram
    assert shown is not None
    assert int(np.asarray(shown.counts).sum()) == len(answer.result.scan)
    assert [name for name, _, _ in shown.levels] == ["Layer 1", "Layer 2"]


def test_a_closed_scan_gives_its_memory_back(plots: Plots, near: Path) -> None:
    """Workers remember what they made last: of ten million points that is more than a gigabyte."""
    plots.bench.open(near, **PARAMETERS)
    plots.settle()
    assert plots.bench.document.answer is not None
    scan = weakref.ref(plots.bench.document.answer.result.scan)
    plots.bench.document.close_scan()

    def is_gone() -> bool:
        gc.collect()
        return scan() is None

    plots.bench.qtbot.waitUntil(is_gone)


def test_nothing_under_way_fills_the_plots_of_a_closed_scan(plots: Plots, near: Path) -> None:
    plots.bench.open(near, **PARAMETERS)
    plots.settle()
    plots.feed._draw(1, "gray")
    plots.feed._cut()
    plots.pictures.clear()
    plots.bench.document.close_scan()
    plots.bench.qtbot.waitUntil(lambda: plots.feed.is_idle)
    assert not [picture for picture in plots.pictures if picture is not None]
    assert plots.profile.section is None
    assert plots.histogram._histogram is None
    assert plots.map.line is None


# --- Outliers -----------------------------------------------------------------------------------------------


@pytest.fixture
def stray(bench: Bench, qtbot: QtBot) -> Iterator[tuple[StrayFeed, CleaningPanel]]:
    panel = CleaningPanel(bench.document)
    qtbot.addWidget(panel)
    feed = StrayFeed(bench.document, panel, bench.scene_feed)
    yield feed, panel
    feed.close()


def test_stray_points_are_counted_and_marked(
    bench: Bench, tmp_path: Path, stray: tuple[StrayFeed, CleaningPanel]
) -> None:
    feed, panel = stray
    path = tmp_path / "birds.npy"
    np.save(path, np.vstack([table(), [[4.0, 3.0, 30.0], [1.0, 1.0, 25.0]]]))
    bench.open(path, **PARAMETERS)
    panel.preview_requested.emit("isolated")
    bench.qtbot.waitUntil(lambda: feed.is_idle and bench.is_settled())
    assert panel.outliers.count.text().startswith("2 points of ")
    marks = bench.client.scenes[CLOUD].lines[1]
    assert marks.ends.reshape(-1, 3)[:, 2].max() == pytest.approx(30, abs=0.5)
    panel.preview_requested.emit("off")
    bench.settle()
    assert len(bench.client.scenes[CLOUD].lines) == 1


def test_a_preview_that_was_ended_marks_nothing(
    bench: Bench, near: Path, stray: tuple[StrayFeed, CleaningPanel]
) -> None:
    feed, panel = stray
    bench.open(near, **PARAMETERS)
    panel.preview_requested.emit("isolated")
    panel.preview_requested.emit("off")
    bench.qtbot.waitUntil(lambda: feed.is_idle and bench.is_settled())
    assert len(bench.client.scenes[CLOUD].lines) == 1


def test_without_a_scan_nothing_is_looked_for(stray: tuple[StrayFeed, CleaningPanel]) -> None:
    feed, panel = stray
    panel.preview_requested.emit("radius")
    assert feed.is_idle


# --- Demo ---------------------------------------------------------------------------------------------------


@pytest.fixture
def parent(qtbot: QtBot) -> QObject:
    return QObject()


def test_the_demo_is_made_aside_and_says_where_it_is(
    parent: QObject, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def make(progress: Progress) -> Path:
        progress(0.5, "building")
        return tmp_path / "demo.laz"

    monkeypatch.setattr(demo_feed, "make_demo", make)
    feed = DemoFeed(parent)
    said: list[object] = []
    feed.progressed.connect(lambda share, what: said.append((share, what)))
    feed.made.connect(lambda files, parameters: said.append((files, parameters)))
    feed.start()
    assert feed.is_busy
    qtbot.waitUntil(lambda: not feed.is_busy)
    assert said == [(0.5, "building"), ((tmp_path / "demo.laz",), demo.PARAMETERS)]
    feed.close()


def test_a_demo_that_cannot_be_kept_is_one_sentence(
    parent: QObject, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    def make(progress: Progress) -> Path:
        raise ScanError("the demo cannot be kept there (no room)")

    monkeypatch.setattr(demo_feed, "make_demo", make)
    feed = DemoFeed(parent)
    with qtbot.waitSignal(feed.failed) as heard:
        feed.start()
    assert str(heard.args[0]) == "the demo cannot be kept there (no room)"
    feed.close()


def test_a_demo_can_be_stopped(parent: QObject, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> None:
    def make(progress: Progress) -> Path:
        while True:
            progress(0.5, "building")

    monkeypatch.setattr(demo_feed, "make_demo", make)
    feed, said = DemoFeed(parent), list[object]()
    feed.made.connect(said.append)
    feed.failed.connect(said.append)
    with qtbot.waitSignal(feed.progressed):
        feed.start()
    feed.cancel()
    qtbot.waitUntil(lambda: not feed.is_busy)
    assert not said
    feed.close()


# --- Status bar ---------------------------------------------------------------------------------------------


@pytest.fixture
def status(bench: Bench, qtbot: QtBot) -> tuple[Status, MapView]:
    status, map_view = Status(), MapView()
    for widget in (status, map_view):
        qtbot.addWidget(widget)
    StatusFeed(bench.document, status, bench.trio, map_view, bench.scene_feed)
    return status, map_view


def texts(status: Status) -> list[str]:
    found = [label.text() for label in status.findChildren(QLabel) if not label.isHidden()]
    return [text.replace("\N{NARROW NO-BREAK SPACE}", " ") for text in found if text]


def test_the_status_bar_says_what_the_result_holds(
    bench: Bench, near: Path, status: tuple[Status, MapView]
) -> None:
    answer = bench.open(near, **PARAMETERS)
    pillars = sum(len(layer.pillars) for layer in answer.result.layers)
    said = texts(status[0])
    assert f"{pillars} pillars, 2 layers" in said
    assert f"{len(table())} points" in said
    assert len(said) == 3, f"{said}: the third is the time"
    bench.document.close_scan()
    assert not texts(status[0])


def test_a_preview_does_not_claim_fewer_points(
    bench: Bench, near: Path, status: tuple[Status, MapView], previews: None
) -> None:
    bench.open(near, **PARAMETERS)
    bench.document.begin_gesture()
    bench.document.set_parameters("Cell", bench.document._gestures[0], cell_size=0.7)
    bench.qtbot.waitUntil(lambda: not bench.document.busy)
    assert bench.document.answer is not None
    assert bench.document.answer.request.quick
    assert f"{len(table())} points" in texts(status[0])


def test_a_filled_place_says_so_and_how_high_it_was_made(
    bench: Bench, near: Path, status: tuple[Status, MapView]
) -> None:
    points = table()
    hole = (np.abs(points[:, 0] - 6.25) < 0.25) & (np.abs(points[:, 1] - 2.25) < 0.25)
    np.save(near, points[~hole])
    bench.open(near, **PARAMETERS | {"fill": "nearest"})
    status[1].plot.hovered.emit(6.3, 2.3)
    said = texts(status[0])
    assert "x 6.30  y 2.30  z 0.00 m" in said
    assert any(text.endswith(": 1 filled") for text in said)


def test_places_are_in_scan_coordinates(bench: Bench, far: Path, status: tuple[Status, MapView]) -> None:
    bench.open(far, **PARAMETERS)
    bench.trio.hovered.emit((3.3, 2.6, 1.0))
    said = texts(status[0])
    assert "x 432 103.30  y 5 411 302.60  z 213.00 m" in said
    assert any(text.endswith(": 2 surfaces") for text in said)
    bench.trio.hovered.emit(None)
    assert not any(text.startswith(("x ", "cell ")) for text in texts(status[0]))


def test_over_the_map_the_height_is_that_of_the_active_layer(
    bench: Bench, far: Path, status: tuple[Status, MapView]
) -> None:
    bar, map_view = status
    bench.open(far, **PARAMETERS)
    for layer, height in ((0, "212.00"), (1, "213.00")):
        bench.document.set_active_layer(layer)
        map_view.cursor_moved.emit(UTM[0] + 3.3, UTM[1] + 2.6)
        assert any(text.endswith(f"z {height} m") for text in texts(bar)), texts(bar)
    map_view.cursor_moved.emit(UTM[0] + 0.3, UTM[1] + 0.3)
    assert not any("  z " in text for text in texts(bar)), "there is no table over the corner"
    map_view.cursor_left.emit()
    assert not any(text.startswith("x ") for text in texts(bar))


def test_beyond_the_scan_there_is_no_compartment(
    bench: Bench, near: Path, status: tuple[Status, MapView]
) -> None:
    bench.open(near, **PARAMETERS)
    status[1].cursor_moved.emit(-500.0, 12.0)
    assert not any(text.startswith("cell ") for text in texts(status[0]))
