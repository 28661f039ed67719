"""What the layers panel shows after an edit is what it would show if nothing were remembered."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.core.edited import PARAMETERS, Window, write_shelves

from stepfield import moving
from stepfield.progress import silent
from stepfield.project import Project
from stepfield.reconstruction import Reconstruction
from stepfield_app.feeds.panel_pictures import PanelDrawing, PanelWish
from stepfield_app.requests import Answer, request_for
from stepfield_app.scenes.palette import layer_colours


@pytest.fixture
def window(tmp_path: Path) -> Window:
    return Window(write_shelves(tmp_path / "shelves.npy"))


def wish(window: Window, result: Reconstruction, quick: bool = False) -> PanelWish:
    answer = Answer(request_for(window.project), result, 0.0)
    return PanelWish(answer, layer_colours(len(result.layers), ()), quick)


def results(window: Window) -> list[Reconstruction]:
    """Results of edits one after the other, and of other parameters."""
    made = [window.result]
    window.do(moving.move_to(window.result, window.result.layering.layer == 1, 0))
    made.append(window.result)
    window.do(moving.remove(window.result, 0))
    made.append(window.result)
    window.open(finer(window))
    return [*made, window.result]


def finer(window: Window) -> Project:
    return window.project.model_copy(update={"parameters": PARAMETERS.model_copy(update={"cell_size": 0.2})})


def test_nothing_that_was_remembered_is_out_of_date(window: Window) -> None:
    drawing = PanelDrawing()
    for result in results(window):
        for quick in (False, True, False):
            asked = wish(window, result, quick)
            made, fresh = drawing(asked, silent), PanelDrawing()(asked, silent)
            assert made.thumbnails.keys() == fresh.thumbnails.keys()
            for number, picture in made.thumbnails.items():
                assert np.array_equal(picture, fresh.thumbnails[number])
            assert np.array_equal(made.histogram.counts, fresh.histogram.counts)
            assert np.array_equal(made.histogram.edges, fresh.histogram.edges)
            assert made.histogram.levels == fresh.histogram.levels


def test_a_layer_that_an_edit_leaves_alone_keeps_its_very_picture(window: Window) -> None:
    drawing = PanelDrawing()
    before = drawing(wish(window, window.result), silent).thumbnails
    window.do(moving.move_to(window.result, window.result.layering.layer == 1, 0))
    after = drawing(wish(window, window.result), silent).thumbnails
    assert after[2] is before[2]
    assert after[1] is not before[1]
