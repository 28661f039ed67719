"""Fidelity in the window: the figures are those of the newest result, and each leads to its overlay."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import table, table_result

from stepfield.complex_parts import ComplexParts
from stepfield.fidelity import FilledFigures, Hidden, compare_result, result_filled_figures
from stepfield.parameters import Parameters
from stepfield.progress import silent
from stepfield.surface import Mesh
from stepfield_app.document import Document
from stepfield_app.feeds import fidelity_feed
from stepfield_app.feeds.fidelity_feed import FidelityFeed
from stepfield_app.feeds.plots import MapWish, map_picture
from stepfield_app.panels.fidelity import FidelityPanel
from stepfield_app.requests import Answer, Request
from stepfield_app.runner import Runner
from stepfield_app.scenes.complex_parts import Meshed
from stepfield_app.scenes.fidelity import FidelityFacts, fidelity_facts
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.views.map import MapView
from stepfield_app.views.pictures import MODES, OVERLAYS
from stepfield_app.views.strip import Strip
from stepfield_app.wording import area, distance, reading, share

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks


class Compared:
    """A document, the panel, and what keeps it true."""

    def __init__(self, qtbot: QtBot, folder: Path) -> None:
        self.qtbot, self.path = qtbot, folder / "table.npy"
        np.save(self.path, table())
        self.document = Document(Runner(threaded=False))
        self.panel = FidelityPanel(Strip("Fidelity"))
        qtbot.addWidget(self.panel)
        self.feed = FidelityFeed(self.document, self.panel)
        self.seen: list[FidelityFacts | None] = []
        self.feed.changed.connect(self.seen.append)

    def open(self) -> None:
        self.document.open([self.path], Parameters(cell_size=0.5, layer_tolerance=0.3))
        self.rest()

    def rest(self) -> None:
        def is_shown() -> bool:
            answer, facts = self.document.answer, self.seen[-1] if self.seen else None
            return answer is not None and facts is not None and facts.result is answer.result

        self.qtbot.waitUntil(is_shown)

    def text(self, name: str) -> str:
        return self.panel.values[name].text()


@pytest.fixture
def compared(qtbot: QtBot, tmp_path: Path) -> Iterator[Compared]:
    made = Compared(qtbot, tmp_path)
    yield made
    made.feed.close()
    made.document.close()


def test_the_panel_says_what_it_will_show(compared: Compared) -> None:
    assert not compared.panel.values["seams"].isVisibleTo(compared.panel)
    compared.open()
    assert compared.panel.values["seams"].isVisibleTo(compared.panel)
    compared.document.close_scan()
    assert not compared.panel.values["seams"].isVisibleTo(compared.panel)
    assert compared.seen[-1] is None


def test_figures_are_those_of_the_core(compared: Compared) -> None:
    compared.open()
    assert compared.document.answer is not None
    found = compare_result(compared.document.answer.result).fidelity
    assert found.explained == 1
    assert compared.text("vertical explained") == "100.0 %"
    assert compared.text("vertical rmse") == "0.0 mm"
    assert compared.text("clearance") == "1.00 m"
    assert compared.text("holes") == "none"
    assert compared.text("seams").startswith("0 of ")
    assert "surfaces vanish" in compared.panel.values["lost"].toolTip()
    assert "RMSE 0.0 mm, 100.0 %" in compared.panel.strip.detail  # type: ignore[attr-defined]


def test_what_was_filled_is_there_only_when_holes_are_filled(compared: Compared) -> None:
    floor = np.indices((40, 60)).reshape(2, -1).T * 0.5 + 0.25
    column, row = (floor[:, axis] // 0.5 for axis in (0, 1))
    points = np.column_stack([floor, np.random.default_rng(3).normal(0, 0.05, len(floor))])
    np.save(compared.path, points[(column % 6 != 3) | (row % 8 != 4)])
    compared.open()
    rows = [compared.panel.values[name] for name in ("filled", "off")]
    assert not any(row.isVisibleTo(compared.panel) for row in rows)
    compared.document.set_parameters("Fill holes", fill="nearest")
    compared.rest()
    assert all(row.isVisibleTo(compared.panel) for row in rows)
    assert compared.document.answer is not None
    (figures,) = result_filled_figures(compared.document.answer.result)
    assert figures.hidden is not None
    assert compared.text("filled") == f"{figures.holes}, {area(figures.area)}"
    assert compared.text("off") == f"≈ {distance(figures.hidden.rmse)}, {distance(figures.hidden.p95)}"
    tip = rows[1].toolTip()
    assert f"Estimated from {figures.hidden.patches} patches of measured ground" in tip
    assert "Layer 1 ≈ " in tip
    compared.document.set_parameters("Fill holes", fill="none")
    compared.rest()
    assert not any(row.isVisibleTo(compared.panel) for row in rows)


def test_a_dash_stands_where_nothing_is_known_of_most_of_what_was_filled(tmp_path: Path) -> None:
    facts = fidelity_facts(table_result(tmp_path), None, silent)
    known = Hidden.of(8, np.array([0.1]), np.array([1.0]))
    some, none = FilledFigures(9, 2.25, 1, 0, 0.0, known), FilledFigures(10, 2.5, 1, 1, 0.5, None)
    assert replace(facts, filled=(some, none)).hidden is None
    assert replace(facts, filled=(replace(some, pixels=11), none)).hidden is not None
    assert replace(facts, filled=(some, none)).filled_holes == (2, 4.75)


def test_new_parameters_bring_new_figures(compared: Compared) -> None:
    compared.open()
    before = compared.text("seams")
    compared.document.set_parameters("Cell size", cell_size=0.25)
    assert compared.panel.values["seams"].property("pending")  # of an older result as yet
    compared.rest()
    assert compared.text("seams") != before
    assert not compared.panel.values["seams"].property("pending")


def test_a_large_scan_is_drawn_first_and_compared_whole_at_rest(
    compared: Compared, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in (("DRAWN", 100), ("FEW", 200), ("QUIET", 1)):
        monkeypatch.setattr(fidelity_feed, name, value)
    compared.open()
    first = compared.seen[0]
    assert first is not None
    assert first.comparison.fidelity.is_drawn
    compared.qtbot.waitUntil(lambda: len(compared.seen) == 2)
    assert not compared.seen[1].comparison.fidelity.is_drawn  # type: ignore[union-attr]


def test_of_a_very_large_scan_no_more_than_very_many_points_are_compared(
    compared: Compared, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All of them would keep the processors from the views for tens of seconds."""
    for name, value in (("DRAWN", 50), ("FEW", 100), ("QUIET", 1), ("MOST", 200)):
        monkeypatch.setattr(fidelity_feed, name, value)
    compared.open()
    compared.qtbot.waitUntil(lambda: len(compared.seen) == 2)
    few, many = (facts.comparison.fidelity for facts in compared.seen if facts is not None)
    assert few.points < many.points <= 200 < many.of
    assert many.is_drawn
    assert not compared.feed._quiet.isActive(), "it would be compared again and again"


def test_a_drawn_figure_says_so(qtbot: QtBot, tmp_path: Path) -> None:
    panel = FidelityPanel(strip := Strip("Fidelity"))
    qtbot.addWidget(panel)
    panel.set_facts(fidelity_facts(table_result(tmp_path), 100, silent))
    assert strip.detail.startswith("≈")
    assert "even draw" in panel.values["nearest rmse"].toolTip()


def test_while_a_hand_moves_only_a_draw_is_compared(
    compared: Compared, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fidelity_feed, "DRAWN", 100)
    compared.open()
    gesture = compared.document.begin_gesture()
    compared.document.set_parameters("Tolerance", gesture, layer_tolerance=0.4)
    compared.rest()
    last = compared.seen[-1]
    assert last is not None
    assert last.comparison.fidelity.is_drawn
    compared.document.end_gesture(gesture)


def test_of_very_many_pillars_the_figures_wait_for_the_hand(
    compared: Compared, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They would take the processors from the pictures that follow it."""
    compared.open()
    monkeypatch.setattr(fidelity_feed, "FOLLOWED", 10)
    document, seen = compared.document, len(compared.seen)
    gesture = document.begin_gesture()
    document.set_parameters("Tolerance", gesture, layer_tolerance=0.25)
    assert not compared.feed._worker.busy
    assert len(compared.seen) == seen
    document.end_gesture(gesture)
    compared.rest()


def test_a_mesh_of_complex_parts_is_counted_in_and_out(compared: Compared) -> None:
    compared.open()
    assert compared.document.answer is not None
    compared.document.set_parameters("Complex parts", complex_parts="mesh")
    compared.rest()
    result = compared.document.answer.result
    none = np.zeros(len(result.field), bool)
    parts = ComplexParts(none, none, Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64)))
    compared.feed.set_meshed(meshed := Meshed(result, parts))
    compared.qtbot.waitUntil(lambda: compared.seen[-1] is not None and compared.seen[-1].meshed is meshed)
    compared.feed.set_meshed(None)
    compared.qtbot.waitUntil(lambda: compared.seen[-1] is not None and compared.seen[-1].meshed is None)


@pytest.mark.parametrize(
    ("name", "mode"),
    [
        ("vertical rmse", "error"),
        ("nearest p95", "error"),
        ("off", "holes"),
        *((mode, mode) for mode in OVERLAYS[1:]),
    ],
)
def test_a_number_leads_to_where_it_comes_from(compared: Compared, name: str, mode: str) -> None:
    compared.open()
    with compared.qtbot.waitSignal(compared.panel.map_wanted) as wanted:
        compared.panel.values[name].click()
    assert wanted.args == [mode]
    assert mode in MODES


def picture_of(folder: Path, mode: str, facts: FidelityFacts | None = None) -> MapWish:
    result = table_result(folder)
    answer = Answer(Request((folder / "scan.npy",)), result, 0.0)
    return MapWish(answer, 0, mode, layer_colours(len(result.layers)), facts=facts)


def test_the_map_says_what_is_under_the_cursor(qtbot: QtBot, tmp_path: Path) -> None:
    view = MapView()
    qtbot.addWidget(view)
    view.set_picture(map_picture(picture_of(tmp_path, "clearance"), silent))
    view.plot.hovered.emit(3.0, 3.0)
    assert view.strip.detail == "Layer 1: 1.00 m of room"
    view.plot.hovered.emit(7.0, 5.0)
    assert view.strip.detail == "Layer 1"
    view.plot.hovered.emit(3.0, 3.0)
    view.plot.hover_ended.emit()
    assert view.strip.detail == "Layer 1"


def test_errors_are_drawn_of_the_result_they_are_of(tmp_path: Path) -> None:
    """A newer result may have other compartments: its errors are still being found out."""
    (tmp_path / "old").mkdir()
    old = fidelity_facts(table_result(tmp_path / "old"), None, silent)
    wish = picture_of(tmp_path, "error", old)
    assert map_picture(wish, silent).values is not None
    finer = replace(wish, facts=None)
    drawn = map_picture(finer, silent)
    assert drawn.values is not None
    assert np.isnan(drawn.values).all()


@pytest.mark.parametrize(
    ("mode", "value", "names", "said"),
    [
        ("error", 0.012, (), "scan 1.2 cm above"),
        ("error", -0.0047, (), "scan 4.7 mm below"),
        ("clearance", 0.7, (), "70.0 cm of room"),
        ("gaps", 1.5, (), "gap of 1.50 m"),
        ("lost", 75.0, (), "75 % not drawn"),
        ("holes", 0.0, ("hole",), "hole"),
        ("error", np.nan, (), ""),
    ],
)
def test_overlays_are_read_in_words(mode: str, value: float, names: tuple[str, ...], said: str) -> None:
    assert reading(mode, value, names) == said


@pytest.mark.parametrize(
    ("value", "said"),
    [(0.0, "0.0 %"), (0.991, "99.1 %"), (0.9996, "99.96 %"), (0.9999999, "99.999 %"), (1.0, "100.0 %")],
)
def test_a_share_is_whole_only_where_nothing_is_missing(value: float, said: str) -> None:
    assert share(value) == said


@pytest.mark.parametrize(
    ("value", "said"),
    [(0.0047, "4.7 mm"), (0.012, "1.2 cm"), (0.301, "30.1 cm"), (1.584, "1.58 m"), (np.inf, "–")],
)
def test_small_lengths_have_a_unit_that_suits_them(value: float, said: str) -> None:
    assert distance(value) == said


def test_areas_are_square_metres() -> None:
    assert (area(0.301), area(896.4)) == ("0.30 m²", "896 m²")
