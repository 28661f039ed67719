"""Outlines of the selection in map and profile: visible on every colour, complete at every zoom, quick."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PySide6.QtCore import QRect
from PySide6.QtGui import QTransform
from tests.app.scenes_made import UTM, table_result

from stepfield_app.scenes.marked import ELSEWHERE, HERE, NOWHERE, Marked, marked
from stepfield_app.theme import HALO, OUTLINES, rgb
from stepfield_app.views.outlines import SelectedBlocks, SelectedCells
from stepfield_app.views.pixels import Place


def written(item: SelectedCells | SelectedBlocks, scale: float, left: float = 0.0) -> NDArray[np.uint32]:
    """Pixels of 100 by 80 that show the plane from ``left`` and 0 on, ``scale`` pixels a metre."""
    pixels = np.zeros((80, 100), np.uint32)
    to_scene = QTransform(scale, 0, 0, -scale, -left * scale, 80)
    item.write(pixels, Place(to_scene, QRect(0, 0, 100, 80), 1.0))
    return pixels


def is_in(pixels: NDArray[np.uint32], colour: str) -> NDArray[np.bool_]:
    red, green, blue = rgb(colour)
    found: NDArray[np.bool_] = pixels == np.uint32(255 << 24 | red << 16 | green << 8 | blue)
    return found


def cells(rows: list[str]) -> SelectedCells:
    """Cells of a metre from x = 0 on, the last row at y = 0; ``#`` is selected here, ``o`` elsewhere."""
    kinds = {".": NOWHERE, "o": ELSEWHERE, "#": HERE}
    item = SelectedCells()
    item.set_marked(
        Marked(0.0, len(rows), 1.0, np.array([[kinds[cell] for cell in row] for row in rows], np.uint8))
    )
    return item


def test_selected_cells_get_one_outline_light_between_dark() -> None:
    """If it failed, the outline would vanish on a map of its own colour."""
    item = cells(["....", ".##.", ".##.", "...."])
    light, dark = (is_in(written(item, 16), colour) for colour in (OUTLINES["selection"], HALO))
    rows, columns = np.nonzero(light)
    assert (columns.min(), columns.max() + 1) == (16, 48)
    assert (rows.min(), rows.max() + 1) == (80 - 48, 80 - 16)
    assert not light[80 - 40 : 80 - 24, 24:40].any(), "a line runs between two selected cells"
    assert dark[80 - 32, 15], "dark outside"
    assert light[80 - 32, 16]
    assert dark[80 - 32, 17], "dark inside"


def test_a_single_cell_shows_although_it_is_smaller_than_a_pixel() -> None:
    """If it failed, a stray selected pillar would be moved without having been seen."""
    rows = np.zeros((400, 500), np.uint8)
    rows[217, 333] = HERE
    item = SelectedCells()
    item.set_marked(Marked(0.0, 400.0, 1.0, rows))
    light = is_in(written(item, 0.2), OUTLINES["selection"])
    assert np.argwhere(light).tolist() == [[80 - 80 + 217 // 5, 333 // 5]]


def test_what_is_selected_in_another_layer_is_fainter() -> None:
    pixels = written(cells(["o..#"]), 16)
    opacity = pixels >> np.uint32(24)
    assert 0 < opacity[:, :20].max() < 255
    assert opacity[:, 40:].max() == 255


def test_an_area_that_goes_on_beyond_the_picture_has_no_edge_there() -> None:
    item = SelectedCells()
    item.set_marked(Marked(0.0, 4.0, 1.0, np.full((8, 8), HERE, np.uint8)))
    light = is_in(written(item, 100, left=1.5), OUTLINES["selection"])
    assert not light.any()


@pytest.mark.parametrize("left", [-50.0, 50.0])
def test_an_area_beside_the_picture_writes_nothing(left: float) -> None:
    assert not written(cells(["##"]), 16, left).any()


def test_blocks_that_touch_get_one_outline() -> None:
    item = SelectedBlocks()
    item.set_spans(np.array([[1.0, 2.0, 0.0, 3.0], [2.0, 3.0, 0.0, 2.0]]))
    light = is_in(written(item, 16), OUTLINES["selection"])
    assert light[80 - 40, 16]
    assert light[80 - 40, 31]
    assert not light[80 - 16, 31:33].any(), "a line between the two"
    assert item.has(2.5, 1.0)
    assert not item.has(2.5, 2.5)


@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), UTM], ids=["near", "far"])
def test_marked_cells_are_where_the_pillars_are(tmp_path: Path, shift: tuple[float, float, float]) -> None:
    result = table_result(tmp_path, shift)
    top = marked(result, result.layering.layer == 1, 1)
    assert top is not None
    assert top.cells.shape == (4, 16)
    assert (top.cells[:, 4:10] == HERE).all()
    assert int((top.cells != NOWHERE).sum()) == 24
    assert (top.west - shift[0], top.north - shift[1]) == pytest.approx((0.0, 4.0), abs=1e-6)
    assert top.has(shift[0] + 2.1, shift[1] + 3.9)
    assert not top.has(shift[0] + 1.9, shift[1] + 3.9)
    assert not top.has(shift[0] + 2.1, shift[1] + 4.1)


def test_a_cell_with_selected_pillars_here_and_elsewhere_is_here(tmp_path: Path) -> None:
    result = table_result(tmp_path)
    both = marked(result, np.ones(len(result.field), bool), 1)
    assert both is not None
    assert both.cells.shape == (12, 16)
    assert int((both.cells == HERE).sum()) == 24
    assert int((both.cells == ELSEWHERE).sum()) == 192 - 24
    assert marked(result, np.zeros(len(result.field), bool), 1) is None
