"""Outlines in the 3-D views: that they are those of the selection, of what is shown, and of this scan."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot
from tests.app.scenes_made import UTM, table
from tests.app.stubs import Bench

from stepfield.layers import UNASSIGNED
from stepfield.moving import move_to
from stepfield_app.feeds.selection_feed import AtPlaces, Chosen, SelectionFeed
from stepfield_app.render.outline import PLACE, SELECTION
from stepfield_app.render.scene import CLOUD, PILLARS, VIEWS, Singles
from stepfield_app.selection import Selection


class Outlined(Bench):
    """A bench with a selection and what outlines it."""

    def __init__(self, qtbot: QtBot, folder: Path) -> None:
        super().__init__(qtbot)
        self.selection = Selection(self.document)
        self.feed = SelectionFeed(
            self.document,
            self.selection,
            self.scene_feed,
            self.client,  # type: ignore[arg-type]
        )
        path = folder / "table.npy"
        np.save(path, table(UTM))
        # By elevation, which needs no links: some tests look when they are found.
        self.answer = self.open(path, cell_size=0.5, layer_tolerance=0.3, alpha=0.5, layering="elevation")
        self.rest()

    def rest(self) -> None:
        """Wait until the selection and its outline are there."""
        self.qtbot.waitUntil(lambda: not self.selection.busy and self.feed.is_idle)

    def segments(self, view: str = PILLARS, kind: str = SELECTION) -> Singles | None:
        """Return the newest outline of a view."""
        return self.client.outlines.get((view, kind), (None, 0.0))[0]

    def close(self) -> None:
        """End every worker."""
        self.feed.close()
        self.selection.close()
        super().close()


@pytest.fixture
def bench(qtbot: QtBot, tmp_path: Path) -> Iterator[Outlined]:
    bench = Outlined(qtbot, tmp_path)
    yield bench
    bench.close()


def test_a_selection_is_outlined_in_all_views_at_local_coordinates(bench: Outlined) -> None:
    bench.selection.all_of(1)
    bench.rest()
    for view in VIEWS:
        lines = bench.segments(view)
        assert lines is not None
        assert lines[..., 0].min() == pytest.approx(2, abs=1e-4)
        assert lines[..., 1].max() == pytest.approx(4, abs=1e-4)
    assert bench.client.outlines[PILLARS, SELECTION][1] == 0
    assert bench.client.outlines[CLOUD, SELECTION][1] > 0, "points above their pillar's mean hide its outline"
    pillars, cloud = bench.segments(PILLARS), bench.segments(CLOUD)
    assert pillars is not None
    assert cloud is not None
    assert len(pillars) > len(cloud), "lines down a block that is not drawn stand in the air"


def test_the_outline_goes_with_the_selection(bench: Outlined) -> None:
    bench.selection.all_of(1)
    bench.rest()
    bench.selection.clear()
    bench.rest()
    assert bench.segments() is None


def test_hidden_layers_are_not_outlined(bench: Outlined) -> None:
    bench.selection.all_of(1)
    bench.rest()
    bench.feed.set_visible((0,))
    bench.rest()
    lines = bench.segments()
    assert lines is not None
    assert len(lines) == 0
    bench.feed.set_visible((-1, 0, 1))
    bench.rest()
    lines = bench.segments()
    assert lines is not None
    assert len(lines) > 0


def test_a_selection_that_is_carried_over_is_outlined_anew(bench: Outlined) -> None:
    bench.selection.all_of(1)
    bench.rest()
    before = bench.segments()
    bench.document.set_parameters("Cell size", cell_size=0.25)
    bench.settle()
    bench.rest()
    after = bench.segments()
    assert before is not None
    assert after is not None
    assert len(after) > len(before)


def test_an_edit_leaves_the_outline_unless_it_hides_some_of_it(bench: Outlined) -> None:
    """It costs as much as a new one, and the same processors are to show the edit."""
    bench.selection.all_of(1)
    bench.rest()
    before, result = bench.segments(), bench.answer.result

    def move() -> None:
        chosen = np.zeros(len(result.field), bool)
        chosen[result.layering.members(1)[:3]] = True
        plan = move_to(result, chosen, UNASSIGNED)
        bench.document.edit(plan.text, plan.applied(bench.document.project))
        bench.settle()
        bench.rest()

    move()
    assert bench.segments() is before
    bench.document.undo_stack.undo()
    bench.settle()
    bench.feed.set_visible((0, 1))
    bench.rest()
    move()
    after = bench.segments()
    assert before is not None
    assert after is not None
    assert not np.array_equal(after, before), "what went to Unassigned is not shown"


def test_a_place_has_an_outline_of_its_own_until_another_result_comes(bench: Outlined) -> None:
    bench.selection.all_of(0)
    result = bench.answer.result
    bench.feed.point_out(Chosen(result, result.layering.layer == 1))
    bench.rest()
    selected, place = bench.segments(kind=SELECTION), bench.segments(kind=PLACE)
    assert selected is not None
    assert place is not None
    assert not np.array_equal(selected, place)
    bench.document.set_parameters("Alpha", alpha=0.7)
    bench.settle()
    bench.rest()
    assert bench.segments(kind=PLACE) is None
    assert bench.segments(kind=SELECTION) is not None


def test_places_are_looked_at_again_in_every_result(bench: Outlined) -> None:
    field = bench.answer.result.field
    boxes = field.boxes(np.flatnonzero(bench.answer.result.layering.layer == 1))
    bench.feed.show_places(boxes)
    bench.rest()
    place = bench.segments(kind=PLACE)
    bench.document.set_parameters("Cell size", cell_size=0.25)
    bench.settle()
    bench.rest()
    finer = bench.segments(kind=PLACE)
    assert place is not None
    assert finer is not None
    assert len(finer) > len(place)
    bench.feed.show_places(None)
    bench.rest()
    assert bench.segments(kind=PLACE) is None


def test_the_pillars_at_places_are_those_at_their_boxes(bench: Outlined) -> None:
    result = bench.answer.result
    chosen = np.flatnonzero(result.layering.layer == 1)[:5]
    assert np.array_equal(np.flatnonzero(AtPlaces(result, result.field.boxes(chosen)).mask), chosen)


def test_a_closed_scan_leaves_no_outline(bench: Outlined) -> None:
    bench.selection.all_of(1)
    bench.feed.point_out(Chosen(bench.answer.result, bench.answer.result.layering.layer == 1))
    bench.rest()
    bench.document.close_scan()
    bench.rest()
    assert bench.segments(kind=PLACE) is None
    assert bench.segments(kind=SELECTION) is None


def test_links_are_found_while_a_selection_rests(bench: Outlined) -> None:
    """The first growing along a surface would wait for them."""
    assert "pairs" not in vars(bench.answer.result.linked)
    bench.selection.all_of(1)
    bench.rest()
    bench.qtbot.waitUntil(lambda: "pairs" in vars(bench.answer.result.linked))
