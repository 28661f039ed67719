"""Suspicious places in the window: looked for when wanted, marked in the map, gone to in every view."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PySide6.QtCore import QRect
from PySide6.QtGui import QTransform
from pytestqt.qtbot import QtBot
from tests.app.stubs import Bench

from stepfield.suspects import CLOSE, KINDS, SEAMS
from stepfield_app.feeds.lead import Lead
from stepfield_app.feeds.plots import MapWish, map_picture
from stepfield_app.feeds.selection_feed import SelectionFeed
from stepfield_app.feeds.suspect_feed import SuspectFeed
from stepfield_app.panels.suspects import CLEAR, EMPTY, SuspectsPanel
from stepfield_app.render.outline import PLACE
from stepfield_app.render.scene import PILLARS
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.scenes.suspects import ORDER, Cells, cells
from stepfield_app.selection import Selection
from stepfield_app.theme import DARK, HALO, LIGHT, rgb
from stepfield_app.views.map import MapView
from stepfield_app.views.marks import CHOICES, MarkBox, Marks, colours
from stepfield_app.views.pixels import Place, packed


def storeys(doubtful: float = 1.9) -> NDArray[np.float64]:
    """Return two floors, a ramp from one to the other, and some pillars half-way up."""
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(30) + 0.5, np.arange(12) + 0.5))
    floor, above = (np.column_stack([x, y, np.full(x.shape, z)]) for z in (0.0, 4.0))
    above = above[x < 10]
    ramp = np.column_stack([x, y + 12, np.clip(0.4 * (x - 10), 0, 4)])
    lone = np.array([[35.5, 3.5, doubtful], [36.5, 3.5, doubtful], [40.0, 24.0, 0.0]])
    shift = np.array([5000.0, 7000.0, 50.0])
    points: NDArray[np.float64] = np.vstack([floor, above, ramp, lone]) + shift
    return points


class Searched(Bench):
    """A bench with a map, a selection, and what looks for suspicious places."""

    def __init__(self, qtbot: QtBot) -> None:
        super().__init__(qtbot)
        self.map, self.marks, self.box, self.panel = MapView(), Marks(), MarkBox(), SuspectsPanel()
        for widget in (self.map, self.box, self.panel):
            qtbot.addWidget(widget)
        self.map.plot.addItem(self.marks, ignoreBounds=True)
        self.map.resize(400, 300)
        self.map.picture_wanted.connect(self.draw_map)
        self.document.active_layer_changed.connect(self.map.set_layer)
        self.selection = Selection(self.document)
        self.outlines = SelectionFeed(
            self.document,
            self.selection,
            self.scene_feed,
            self.client,  # type: ignore[arg-type]
        )
        lead = Lead(self.document, self.map, self.trio, self.scene_feed, self.outlines)
        self.feed = SuspectFeed(
            self.document, self.selection, self.map, self.marks, self.box, self.panel, lead
        )
        self.told: list[str] = []
        self.feed.told.connect(self.told.append)

    def draw_map(self, layer: int, mode: str) -> None:
        """Show a map at once."""
        answer = self.document.answer
        if answer is not None:
            wish = MapWish(answer, layer, mode, layer_colours(len(answer.result.layers)))
            self.map.set_picture(map_picture(wish, lambda share, what: None))

    def load(self, folder: Path, points: NDArray[np.float64]) -> None:
        """Open points as a scan."""
        path = folder / "storeys.npy"
        np.save(path, points)
        self.open(path, cell_size=1.0, layer_tolerance=1.0, link_step=1.0, alpha=0.5)
        self.map.ask()
        self.rest()

    def rest(self) -> None:
        """Wait until all that is wanted is shown."""
        workers = (self.feed, self.outlines)
        self.qtbot.waitUntil(lambda: not self.selection.busy and all(feed.is_idle for feed in workers))

    def close(self) -> None:
        """End every worker."""
        self.feed.close()
        self.outlines.close()
        self.selection.close()
        super().close()


@pytest.fixture
def bench(qtbot: QtBot, tmp_path: Path) -> Iterator[Searched]:
    bench = Searched(qtbot)
    bench.load(tmp_path, storeys())
    yield bench
    bench.close()


def test_nothing_is_looked_for_until_somebody_wants_to_know(bench: Searched) -> None:
    assert bench.feed._found is None
    bench.box.setCurrentIndex(1)
    bench.rest()
    assert bench.feed._found is not None


def test_the_next_place_is_shown_in_every_view(bench: Searched) -> None:
    bench.feed.step(1)
    bench.rest()
    place = bench.feed.place
    assert place is not None
    assert bench.told == [place.sentence]
    assert bench.panel.number.text().startswith("1 of ")
    assert bench.panel.sentence.text() == f"{place.sentence}."
    assert bench.document.active_layer == place.layer == bench.map.layer
    seen = bench.map.plot.visible
    assert seen.left < place.box[0] < place.box[2] < seen.right
    assert seen.bottom < place.box[1] < place.box[3] < seen.top
    centre = np.array(bench.trio.viewpoint.camera.centre) + bench.scene_feed.origin
    assert np.allclose(centre, place.centre, atol=1e-3)
    line = bench.map.line
    assert line is not None
    middle = (np.array(line.start) + line.end) / 2
    assert place.box[0] <= middle[0] <= place.box[2]
    assert place.box[1] <= middle[1] <= place.box[3]
    outline, _ = bench.client.outlines[PILLARS, PLACE]
    assert outline is not None
    assert len(outline)


def test_steps_go_round_all_places_both_ways(bench: Searched) -> None:
    bench.feed.step(1)
    bench.rest()
    first, seen = bench.feed.place, []
    count = len(bench.feed._places)
    assert count > 1
    for _ in range(count):
        seen.append(bench.feed.place)
        bench.panel.next.click()
    assert len({id(place) for place in seen}) == count
    assert bench.feed.place is first
    bench.panel.previous.click()
    assert bench.feed.place is seen[-1]


def test_the_box_chooses_the_kind_of_places(bench: Searched) -> None:
    for at, (_, kinds, _) in enumerate(CHOICES):
        bench.box.setCurrentIndex(at)
        bench.rest()
        assert {place.kind for place in bench.feed._places} <= set(kinds or KINDS)
    bench.box.setCurrentIndex([kinds for _, kinds, _ in CHOICES].index((CLOSE,)))
    bench.feed.step(1)
    bench.rest()
    assert bench.feed.place is not None
    assert bench.feed.place.kind == CLOSE


def test_a_place_can_be_selected(bench: Searched) -> None:
    bench.feed.step(1)
    bench.rest()
    bench.panel.select.click()
    bench.rest()
    assert bench.feed.place is not None
    assert bench.selection.mask is not None
    assert np.array_equal(np.flatnonzero(bench.selection.mask), bench.feed.place.pillars)


def test_a_new_result_keeps_the_place_or_says_how_many_there_are(bench: Searched) -> None:
    bench.box.setCurrentIndex(len(CHOICES) - 1)
    bench.feed.step(1)
    bench.rest()
    shown, camera = bench.panel.sentence.text(), bench.trio.viewpoint.camera
    bench.document.set_parameters("Alpha", alpha=0.8)
    bench.settle()
    bench.rest()
    assert bench.panel.sentence.text() == shown
    assert bench.feed.place is not None
    assert bench.trio.viewpoint.camera is camera, "a new result moves the views without being asked"
    bench.document.set_parameters("Link step", link_step=0.1)
    bench.settle()
    bench.rest()
    assert bench.feed.place is None or bench.feed.place.kind != SEAMS
    assert "place" in bench.panel.number.text() or " of " in bench.panel.number.text()


def test_marks_are_of_the_layer_that_is_shown(bench: Searched) -> None:
    bench.box.setCurrentIndex(len(CHOICES) - 1)
    bench.rest()
    assert bench.feed._found is not None
    found = bench.feed._found
    for layer in (1, 0):
        bench.document.set_active_layer(layer)
        bench.rest()
        wanted = cells(found.result, found.suspects.masks, KINDS, layer)
        assert bench.marks.cells is not None
        assert np.array_equal(bench.marks.cells.west, wanted.west)
    bench.box.setCurrentIndex(0)
    bench.rest()
    assert bench.marks.cells is None


def test_a_closed_scan_leaves_nothing(bench: Searched) -> None:
    bench.box.setCurrentIndex(len(CHOICES) - 1)
    bench.feed.step(1)
    bench.rest()
    bench.document.close_scan()
    bench.rest()
    assert bench.marks.cells is None
    assert bench.panel.sentence.text() == EMPTY
    assert not bench.panel.next.isEnabled()
    bench.feed.step(1)  # a key does no harm


def test_a_clean_scan_says_so(qtbot: QtBot, tmp_path: Path) -> None:
    clean = Searched(qtbot)
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(9) + 0.5, np.arange(9) + 0.5))
    clean.load(tmp_path, np.column_stack([x, y, np.zeros(81)]))
    clean.feed.step(1)
    clean.rest()
    assert clean.panel.sentence.text() == CLEAR
    assert clean.feed.place is None
    clean.close()


def marked(side: float, kinds: list[int]) -> NDArray[np.uint32]:
    """Write marks ten compartments apart into a picture, a compartment ``side`` pixels wide."""
    west: NDArray[np.float64] = np.arange(len(kinds), dtype=np.float64) * 10 + 1
    marks = Marks()
    marks.set_cells(Cells(west, np.full(len(kinds), 3.0), np.array(kinds, np.uint8), 1.0))
    pixels = np.zeros((round(6 * side) + 9, round(side * 10 * len(kinds)) + 9), np.uint32)
    marks.write(pixels, Place(QTransform(side, 0, 0, -side, 0, 5 * side), QRect(0, 0, 1, 1), 1.0))
    return pixels


@pytest.mark.parametrize("side", [0.9, 3.0, 6.0, 9.0, 40.0])
def test_marks_show_their_colour_at_every_zoom(qapp: object, side: float) -> None:
    pixels = marked(side, [0, 1, 2])
    for colour in colours(DARK):
        ink = packed(np.array([rgb(colour)], np.uint8))[0]
        assert (pixels == ink).sum() >= 9, f"a mark of {side} pixels does not show"
    if side < 7:
        assert (pixels == packed(np.array([rgb(HALO)], np.uint8))[0]).any()


def test_colours_are_told_apart_in_both_themes() -> None:
    for theme in (DARK, LIGHT):
        assert len(set(colours(theme))) == len(ORDER)


def test_every_choice_says_what_it_marks(qtbot: QtBot) -> None:
    box = MarkBox()
    qtbot.addWidget(box)
    assert box.accessibleName()
    assert box.kinds == ()
    with qtbot.waitSignal(box.chosen) as told:
        box.setCurrentIndex(2)
    assert told.args == [(SEAMS,)]
