"""Walls in the pictures: an operator who cannot tell them from ground cannot decide what becomes of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.app.scenes_made import reconstruct
from tests.core.walled import CELL, COLUMN, COLUMN_TOP, DOOR, LINTEL, TOLERANCE, TOP, WALL, walled

from stepfield.reconstruction import Reconstruction
from stepfield_app.panels.layers_model import LayersModel
from stepfield_app.scenes.blocks import WALL as LOST
from stepfield_app.scenes.blocks import blocks
from stepfield_app.scenes.raster import raster
from stepfield_app.scenes.readout import pillars_at
from stepfield_app.scenes.section import cut
from stepfield_app.scenes.summary import summaries
from stepfield_app.scenes.surfaces import surfaces
from stepfield_app.theme import WALL_COLOUR, rgb

WHITE = np.full((9, 3), 255, np.uint8)


@pytest.fixture(scope="module")
def mean(tmp_path_factory: pytest.TempPathFactory) -> Reconstruction:
    return room(tmp_path_factory.mktemp("mean"), "mean")


@pytest.fixture(scope="module")
def apart(tmp_path_factory: pytest.TempPathFactory) -> Reconstruction:
    return room(tmp_path_factory.mktemp("apart"), "layer")


def room(folder: Path, walls: str) -> Reconstruction:
    return reconstruct(folder, walled(), cell_size=CELL, layer_tolerance=TOLERANCE, alpha=0.1, walls=walls)


def test_walls_are_darker_blocks(mean: Reconstruction) -> None:
    """Nothing higher stands beside them, so their tops have the light of level ground but for that."""
    [mesh] = blocks(mean, np.zeros(3), WHITE, range(len(mean.layers)), levels=1)
    field = mean.field
    tops = mesh.colours[: 4 * len(field)].reshape(-1, 4, 3)[:, :, 0]
    vertical = np.concatenate([field.vertical[layer.pillars] for layer in mean.layers])
    assert tops[vertical].max() <= np.ceil(255 * (1 - LOST))
    assert np.median(tops[~vertical]) > 240


def test_walls_are_hatched_on_the_map_and_the_legend_says_so(mean: Reconstruction) -> None:
    drawn = raster(mean, 1, "colour")
    x = int(WALL / CELL)
    along = drawn.pixels[:, x, :3][drawn.pixels[:, x, 3] > 0]
    assert drawn.legend is not None
    assert drawn.legend.note
    assert (along == rgb(WALL_COLOUR)).all(axis=1).mean() == pytest.approx(0.5, abs=0.15)


def test_maps_without_walls_say_nothing_of_them(apart: Reconstruction) -> None:
    legends = [raster(apart, layer).legend for layer in (0, 1)]
    assert [legend and legend.note for legend in legends] == ["", ""]
    assert len({tuple(pixel) for pixel in raster(apart, 0, "colour").pixels.reshape(-1, 4).tolist()}) < 6


def test_a_profile_knows_walls_and_where_they_begin(apart: Reconstruction) -> None:
    middle = sum(DOOR) / 2
    found = cut(apart, np.array([2.0, middle]), np.array([4.0, middle]))
    [lintel] = np.flatnonzero(found.vertical)
    assert (found.low[lintel], found.elevation[lintel]) == pytest.approx((LINTEL, TOP), abs=0.01)


def test_the_reconstruction_has_solid_obstacles_and_an_open_door(apart: Reconstruction) -> None:
    finest, *coarser = surfaces(apart, np.zeros(3), WHITE, [1])
    for mesh in (finest, *coarser):
        assert len(mesh.triangles)
    assert finest.vertices[:, 2].min() == pytest.approx(0, abs=0.01)
    assert finest.vertices[:, 2].max() == pytest.approx(TOP, abs=0.01)
    x, y, z = finest.vertices.T
    in_door = (np.abs(x - WALL) < CELL / 2 + 1e-3) & (y > DOOR[0] + 0.01) & (y < DOOR[1] - 0.01)
    assert z[in_door].min() == pytest.approx(LINTEL, abs=0.01)


def test_the_cursor_is_told_of_walls(apart: Reconstruction) -> None:
    [column] = pillars_at(apart, *COLUMN)
    assert column.is_vertical
    assert column.elevation == pytest.approx(COLUMN_TOP, abs=0.01)
    assert [each.is_vertical for each in pillars_at(apart, WALL, sum(DOOR) / 2)] == [False, True]


@pytest.mark.usefixtures("qapp")
def test_rows_of_the_layers_say_how_many_walls_they_hold(mean: Reconstruction, apart: Reconstruction) -> None:
    model = LayersModel()
    model.set_layers(summaries(mean))
    assert sum("vertical" in row.sentence for row in model.rows) >= 1
    model.set_layers(summaries(apart))
    names = [row.name for row in model.rows]
    assert names == ["Obstacles", "Layer 1", "Unassigned"]
    assert ["walls and columns" in row.sentence for row in model.rows] == [True, False, False]
