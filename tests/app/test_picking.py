"""From shapes over the three kinds of view to pillars: the table on its floor, whose answers are known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.app.scenes_made import UTM, reconstruct, table, table_result

from stepfield.reconstruction import Reconstruction
from stepfield.selecting import Reach, of_layer
from stepfield_app.render.camera import Camera, Point
from stepfield_app.scenes import lens
from stepfield_app.scenes.lens import Lens
from stepfield_app.scenes.picking import InSection, InView, OnMap, Pick, Shape, picked

Floats = NDArray[np.float64]
SIZE = (800, 600)
#: Pillars of the floor, and of the table-top above its rows 4 to 7 and columns 4 to 9.
FLOOR, TOP = 12 * 16, 4 * 6
BOTH = (0, 1)
ORIGIN = np.array(UTM)


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Reconstruction:
    return table_result(tmp_path_factory.mktemp("table"), UTM)


def camera(elevation: float = 90.0, **chosen: Any) -> Camera:
    return Camera.fitting((0, 0, 0), (8, 6, 1), SIZE, 0.0, elevation, **chosen)


def in_view(
    shape: Shape,
    place: Point | None = None,
    visible: tuple[int, ...] = BOTH,
    seen_from: Camera | None = None,
) -> InView:
    return InView(seen_from or camera(), SIZE, ORIGIN, visible, shape, place)


def pixels(local: Any, seen_from: Camera | None = None) -> Floats:
    found, _ = (seen_from or camera()).project(np.array(local, float), SIZE)
    return found


def on_map(kind: Any, local: Any, radius: float = 0.0, layer: int = 0) -> OnMap:
    return OnMap(Shape(kind, np.array(local, float) + ORIGIN[:2], radius), layer)


def in_section(kind: Any, local: Any, radius: float = 0.0, width: float = 0.0, **chosen: Any) -> InSection:
    """A shape over the profile from west to east through the middle of row 5."""
    start, end = ((float(ORIGIN[0] + x), float(ORIGIN[1] + 3.25)) for x in (0, 8))
    path = np.array(local, float) + np.array([0, ORIGIN[2]])
    return InSection(start, end, width, Shape(kind, path, radius), **{"visible": BOTH, **chosen})


def counts(result: Reconstruction, pick: Pick, reach: Reach | None = None) -> tuple[int, int]:
    """How many pillars of floor and table-top a pick takes."""
    mask = picked(result, pick, reach or Reach())
    assert not mask.flags.writeable
    floor, top = (int((mask & of_layer(result, layer)).sum()) for layer in BOTH)
    return floor, top


# --- 3-D views ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["rectangle", "lasso"])
def test_a_shape_in_the_view_takes_the_tops_it_shows(result: Reconstruction, kind: Any) -> None:
    seen_from = camera(parallel=True)
    corners = [[2, 2, 1], [5, 2, 1], [5, 4, 1], [2, 4, 1]]
    pick = in_view(Shape(kind, pixels(corners, seen_from)), seen_from=seen_from)
    assert counts(result, pick) == (TOP, TOP), "from straight above, top and floor are in one place"
    assert counts(result, pick, Reach(layer=1)) == (0, TOP)
    assert counts(result, pick, Reach(high=UTM[2] + 0.5)) == (TOP, 0)


def test_what_is_hidden_in_the_view_is_never_taken(result: Reconstruction) -> None:
    everywhere = Shape("rectangle", np.array([[0, 0], SIZE]))
    assert counts(result, in_view(everywhere)) == (FLOOR, TOP)
    assert counts(result, in_view(everywhere, visible=(0,))) == (FLOOR, 0)
    assert counts(result, in_view(everywhere, visible=(0, 7))) == (FLOOR, 0), "a layer there is no more"
    assert counts(result, in_view(everywhere, visible=())) == (0, 0)


def test_what_lies_behind_the_eye_is_never_taken(result: Reconstruction) -> None:
    """Seen from the middle of the table-top towards the north."""
    inside = Camera((3.5, 3.0, 1.5), 0.0, 10.0, 0.1)
    floor, top = counts(result, in_view(Shape("rectangle", np.array([[0, 0], SIZE])), seen_from=inside))
    assert 0 < floor < FLOOR / 2
    assert top < TOP
    stroke = Shape("brush", np.array([[0, 300], [800, 300]]), 50.0)
    assert sum(counts(result, in_view(stroke, seen_from=inside))) < FLOOR / 2


def test_a_brush_takes_the_tops_it_touches_however_near_they_are(result: Reconstruction) -> None:
    near = Camera((3.0, 3.0, 1.0), 0.0, 90.0, 1.5)
    beside = pixels([[2.75 + 0.1, 3.25, 1.0]], near)  # a hand's breadth from the middle of a cell
    stroke = Shape("brush", beside, 2.0)
    assert counts(result, in_view(stroke, seen_from=near), Reach(layer=1)) == (0, 1)
    along = Shape("brush", pixels([[2.75, 3.25, 1], [4.25, 3.25, 1]], near), 2.0)
    assert counts(result, in_view(along, seen_from=near), Reach(layer=1)) == (0, 4)


def test_a_click_takes_the_pillar_whose_block_is_there(result: Reconstruction) -> None:
    click = Shape("click", np.array([[1.0, 1.0]]))
    assert counts(result, in_view(click, (3.2, 3.2, 1.0))) == (0, 1)
    assert counts(result, in_view(click, (1.2, 1.2, 0.0))) == (1, 0)
    assert counts(result, in_view(click, (1.2, 0.0, -0.3))) == (1, 0), "the wall of a column to the base"
    assert counts(result, in_view(click)) == (0, 0), "the background"
    assert counts(result, in_view(click, (90.0, 3.0, 0.0))) == (0, 0)


def test_a_click_on_what_is_out_of_reach_does_not_go_through_it(result: Reconstruction) -> None:
    click = Shape("click", np.array([[1.0, 1.0]]))
    assert counts(result, in_view(click, (3.2, 3.2, 1.0)), Reach(layer=0)) == (0, 0)
    assert counts(result, in_view(click, (3.2, 3.2, 1.0), visible=(0,)), Reach(layer=0)) == (1, 0)
    beside = (5.01, 3.2, 1.0)  # a depth image is rounded: just off the edge of the table-top
    assert counts(result, in_view(click, beside), Reach(layer=1)) == (0, 1)


def test_a_surface_is_taken_whole_within_reach(result: Reconstruction) -> None:
    surface = Shape("surface", np.array([[1.0, 1.0]]))
    assert counts(result, in_view(surface, (3.2, 3.2, 1.0))) == (0, TOP)
    assert counts(result, in_view(surface, (1.2, 1.2, 0.0))) == (FLOOR, 0)
    assert counts(result, in_view(surface)) == (0, 0)


# --- The map ------------------------------------------------------------------------------------------------


def test_on_the_map_compartments_are_taken_by_their_middles(result: Reconstruction) -> None:
    corners = [[2.3, 2.3], [3.3, 2.3], [3.3, 3.8], [2.3, 3.8]]  # 1 x 1.5 m hold 2 x 3 middles
    for kind in ("rectangle", "lasso"):
        assert counts(result, on_map(kind, corners)) == (2 * 3, 2 * 3)
        assert counts(result, on_map(kind, corners), Reach(layer=1)) == (0, 2 * 3)


def test_a_rectangle_between_middles_takes_both_ends(result: Reconstruction) -> None:
    """Otherwise the keyboard could not select a single cell."""
    assert counts(result, on_map("rectangle", [[0.25, 0.25], [1.25, 0.75]])) == (3 * 2, 0)
    assert counts(result, on_map("rectangle", [[0.25, 0.25]])) == (1, 0)


def test_a_brush_takes_every_compartment_it_touches(result: Reconstruction) -> None:
    assert counts(result, on_map("brush", [[0.1, 0.1], [7.9, 0.1]], 0.05)) == (16, 0)
    assert counts(result, on_map("brush", [[0.1, 0.45], [7.9, 0.45]], 0.1)) == (32, 0)


def test_a_click_takes_the_compartment_it_is_in(result: Reconstruction) -> None:
    assert counts(result, on_map("click", [[3.2, 3.2]])) == (1, 1)
    assert counts(result, on_map("click", [[3.2, 3.2]]), Reach(layer=0)) == (1, 0)
    assert counts(result, on_map("click", [[0.1, 0.1]]), Reach(layer=1)) == (0, 0)
    assert counts(result, on_map("click", [[-1.0, 0.1]])) == (0, 0), "beside the grid"


def test_a_surface_on_the_map_begins_with_the_layer_it_shows(result: Reconstruction) -> None:
    assert counts(result, on_map("surface", [[3.2, 3.2]], layer=1)) == (0, TOP)
    assert counts(result, on_map("surface", [[3.2, 3.2]], layer=0)) == (FLOOR, 0)
    assert counts(result, on_map("surface", [[3.2, 3.2]], layer=-1)) == (0, TOP), "the highest is seen there"
    assert counts(result, on_map("surface", [[3.2, 3.2]], layer=1), Reach(layer=0)) == (FLOOR, 0)


def test_an_empty_compartment_holds_nothing_to_take(tmp_path: Path) -> None:
    two = reconstruct(tmp_path, [[0, 0, 0], [5, 5, 0]], cell_size=0.5, layer_tolerance=0.3, alpha=0.5)
    middle = OnMap(Shape("click", np.array([[2.6, 2.6]])), 0)
    assert not picked(two, middle, Reach()).any()


# --- The profile --------------------------------------------------------------------------------------------


def test_in_the_profile_pillars_are_taken_by_the_middle_of_their_top(result: Reconstruction) -> None:
    assert counts(result, in_section("rectangle", [[1.9, 0.5], [5.1, 1.5]])) == (0, 6)
    assert counts(result, in_section("lasso", [[0, -0.2], [4, -0.2], [4, 0.2], [0, 0.2]])) == (8, 0)
    both = in_section("rectangle", [[0, -1], [8, 2]])
    assert counts(result, both) == (16, 6)
    assert counts(result, both, Reach(layer=1)) == (0, 6)
    assert counts(result, in_section("rectangle", [[0, -1], [8, 2]], visible=(1,))) == (0, 6)


def test_the_band_of_the_profile_is_taken_with_the_line(result: Reconstruction) -> None:
    """Its points are shown, so what they belong to is not taken unseen."""
    assert counts(result, in_section("rectangle", [[1.9, 0.5], [5.1, 1.5]], width=1.2)) == (0, 3 * 6)
    assert counts(result, in_section("rectangle", [[-9, -9], [99, 99]], width=99.0)) == (FLOOR, TOP)


def test_a_brush_in_the_profile_takes_the_blocks_it_touches(result: Reconstruction) -> None:
    assert counts(result, in_section("brush", [[2.6, 1.05], [3.8, 1.05]], 0.1)) == (0, 3)
    assert counts(result, in_section("brush", [[2.65, -0.3], [3.8, -0.3]], 0.1)) == (3, 0), "below their tops"


def test_a_brush_is_round_on_a_stretched_profile(result: Reconstruction) -> None:
    """A tenth of a metre across is a hundredth up where heights are ten times as long."""
    above = [[3.0, 1.05], [3.2, 1.05]]
    assert counts(result, in_section("brush", above, 0.1)) == (0, 2)
    assert counts(result, in_section("brush", above, 0.1, exaggeration=10.0)) == (0, 0)


def test_a_click_in_the_profile_takes_the_block_there(result: Reconstruction) -> None:
    assert counts(result, in_section("click", [[3.2, 1.0]])) == (0, 1)
    assert counts(result, in_section("click", [[3.2, -0.2]])) == (1, 0)
    assert counts(result, in_section("click", [[3.2, 5.0]])) == (0, 0), "far above everything"
    assert counts(result, in_section("click", [[3.2, 1.0]], visible=(0,))) == (0, 0)
    assert counts(result, in_section("surface", [[3.2, 1.0]])) == (0, TOP)


def test_a_line_without_length_takes_nothing(result: Reconstruction) -> None:
    shape = Shape("rectangle", np.array([[-9.0, -9.0], [999.0, 999.0]]))
    here = (float(ORIGIN[0]), float(ORIGIN[1]))
    assert not picked(result, InSection(here, here, 0.0, shape, BOTH), Reach()).any()


def test_the_view_says_the_same_of_a_scan_at_its_own_origin(tmp_path: Path, result: Reconstruction) -> None:
    """Places far from zero must not lose pillars to rounding."""
    here = reconstruct(tmp_path, table(), cell_size=0.5, layer_tolerance=0.3, alpha=0.5)
    lasso = Shape("lasso", np.array([[200, 100], [700, 220], [400, 540]]))
    seen_from = camera(35.0)
    there = picked(result, in_view(lasso, seen_from=seen_from), Reach())
    assert np.array_equal(picked(here, InView(seen_from, SIZE, np.zeros(3), BOTH, lasso), Reach()), there)
    assert 0 < there.sum() < FLOOR


@pytest.mark.parametrize("seed", range(20))
def test_a_stroke_takes_the_same_dab_by_dab(result: Reconstruction, seed: int) -> None:
    """With what it remembers of the dabs before, of another radius and of another camera."""
    path, used = np.random.default_rng(seed).random((12, 2)) * SIZE, Lens()
    for radius, seen_from in ((20.0, camera()), (7.0, camera()), (7.0, camera(40.0))):
        for end in (1, 2, 5, 5, 12):
            dab = in_view(Shape("brush", path[:end], radius), seen_from=seen_from)
            by_itself, with_others = (
                picked(result, dab, Reach()),
                picked(result, replace(dab, lens=used), Reach()),
            )
            assert np.array_equal(with_others, by_itself)


def test_a_stroke_looks_at_the_pillars_once(result: Reconstruction, monkeypatch: pytest.MonkeyPatch) -> None:
    """A brush over a million of them would lag behind the hand."""
    looks: list[Any] = []
    look, used = lens._seen, Lens()

    def counted(*given: Any) -> Any:
        looks.append(given)
        return look(*given)

    monkeypatch.setattr(lens, "_seen", counted)
    for end in range(2, 9):
        path = np.linspace([100, 100], [300, 200], 20)[:end]
        picked(result, replace(in_view(Shape("brush", path, 5.0)), lens=used), Reach())
    assert len(looks) == 1
