"""Surfaces: what the simulator loses is lost here, the shape and place of the rest are kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.app.scenes_made import UTM, reconstruct, table, table_result
from tests.app.test_scenes_blocks import origin, plan_area

from stepfield.reconstruction import Reconstruction
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.scenes.surfaces import Way, surfaces

COLOURS = layer_colours(2)


@pytest.fixture
def result(tmp_path: Path) -> Reconstruction:
    return table_result(tmp_path, UTM)


def test_the_simulators_surface_is_half_a_compartment_short_on_every_side(result: Reconstruction) -> None:
    mesh = surfaces(result, origin(result), COLOURS, (0, 1), "simulator")[0]
    assert plan_area(mesh) == pytest.approx(7.5 * 5.5 + 2.5 * 1.5)
    assert mesh.vertices[:, :2].min(axis=0).tolist() == pytest.approx([0.25, 0.25])
    assert set(np.round(mesh.vertices[:, 2], 5).tolist()) == {0.0, 1.0}


def test_pillars_stand_on_the_base_and_cover_their_compartments(result: Reconstruction) -> None:
    mesh = surfaces(result, origin(result), COLOURS, (1,), "pillars")[0]
    assert plan_area(mesh) == pytest.approx(3 * 2)
    assert mesh.vertices[:, 2].min() == pytest.approx(-0.5)
    assert mesh.vertices[:, 2].max() == pytest.approx(1.0)


@pytest.mark.parametrize("way", ["edges", "simulator", "pillars"])
def test_hidden_layers_vanish_and_unassigned_has_no_surface(result: Reconstruction, way: str) -> None:
    assert surfaces(result, origin(result), COLOURS, (0,), way)[0].vertices[:, 2].max() < 0.5  # type: ignore[arg-type]
    assert not len(surfaces(result, origin(result), COLOURS, (-1,), way)[0].triangles)  # type: ignore[arg-type]


def test_thinned_levels_lie_where_the_pixels_lie(result: Reconstruction) -> None:
    levels = surfaces(result, origin(result), COLOURS, (0,), "simulator")
    assert [len(mesh.vertices) for mesh in levels] == [16 * 12, 8 * 6, 4 * 3]
    finest = {tuple(place) for place in np.round(levels[0].vertices, 4).tolist()}
    for mesh in levels[1:]:
        assert {tuple(place) for place in np.round(mesh.vertices, 4).tolist()} <= finest


def test_level_ground_keeps_its_layers_colour_nearly_whole(result: Reconstruction) -> None:
    mesh = surfaces(result, origin(result), COLOURS, (1,), "simulator")[0]
    assert (mesh.colours >= COLOURS[1] * 0.85).all()
    assert (mesh.colours <= COLOURS[1]).all()


def test_faces_look_up(result: Reconstruction) -> None:
    assert plan_area(surfaces(result, origin(result), COLOURS, (0,), "simulator")[0], up=False) == 0


def test_edges_cover_the_ground_of_every_pillar(result: Reconstruction) -> None:
    """Table and floor are of one height each: all there is lies at it, to the very sides."""
    levels = surfaces(result, origin(result), COLOURS, (0, 1))
    assert plan_area(levels[0]) == pytest.approx(8 * 6 + 3 * 2)
    assert plan_area(levels[0], up=False) == 0
    assert levels[0].vertices[:, :2].min(axis=0).tolist() == pytest.approx([0, 0])
    assert set(np.round(levels[0].vertices[:, 2], 5).tolist()) == {0.0, 1.0}
    assert len(levels[2].triangles) < len(levels[1].triangles) < len(levels[0].triangles)


def test_hiding_a_layer_does_not_change_the_others(result: Reconstruction) -> None:
    both, top = (surfaces(result, origin(result), COLOURS, shown)[0] for shown in ((0, 1), (1,)))
    assert {tuple(v) for v in top.vertices.tolist()} <= {tuple(v) for v in both.vertices.tolist()}


def test_light_does_not_bleed_around_a_step(tmp_path: Path) -> None:
    """The floor at the foot of a block is as light as all of the floor."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(0.1, 4, 0.2), np.arange(0.1, 4, 0.2)))
    points = np.column_stack([x, y, np.where(x > 2, 1.5, 0.0)])
    made = reconstruct(tmp_path, points, cell_size=0.2, layer_tolerance=0.3, alpha=0.5, layering="rank")
    mesh = surfaces(made, np.zeros(3), COLOURS, (0,))[0]
    risers = mesh.vertices[mesh.triangles]
    is_upright = np.ptp(risers[:, :, 0], axis=1) < 1e-6
    assert is_upright.sum() == 2 * made.field.compartments.grid.rows
    level = np.unique(mesh.triangles[~is_upright])
    assert len(np.unique(mesh.colours[level], axis=0)) == 1


@pytest.mark.parametrize(("way", "more"), [("edges", 4), ("simulator", 9)])
def test_what_was_filled_is_ground(tmp_path: Path, way: Way, more: int) -> None:
    holed, filled = (
        surfaces(made_with_a_hole(tmp_path, fill), np.zeros(3), COLOURS, (0,), way)[0]
        for fill in ("none", "inpaint")
    )
    assert plan_area(filled) - plan_area(holed) == pytest.approx(more * 0.25)


def made_with_a_hole(folder: Path, fill: str) -> Reconstruction:
    points = table()
    is_hole = (points[:, 0] > 6) & (points[:, 0] < 7) & (points[:, 1] > 2) & (points[:, 1] < 3)
    return reconstruct(
        folder, points[~is_hole], cell_size=0.5, layer_tolerance=0.3, alpha=0.5, fill=fill, layering="rank"
    )


@pytest.mark.parametrize("way", ["edges", "simulator"])
def test_what_was_filled_looks_like_nothing_measured(tmp_path: Path, way: Way) -> None:
    """An operator would take heights that nobody measured for a part of the scan."""
    points = table()
    hole = (points[:, 0] > 6) & (points[:, 0] < 7) & (points[:, 1] > 2) & (points[:, 1] < 3)
    names = {"cell_size": 0.5, "layer_tolerance": 0.3, "alpha": 0.5}
    result = reconstruct(tmp_path, points[~hole], fill="linear", **names)
    assert len(result.layers[0].filled.compartment) == 4
    for mesh in surfaces(result, origin(result), COLOURS, (0,), way)[:1]:
        cyan = mesh.colours[:, 0] > COLOURS[0, 0]
        corners = mesh.vertices[cyan, :2]
        side = 0.0 if way == "edges" else 0.25
        assert corners.min(axis=0).tolist() == pytest.approx([6 - side, 2 - side])
        assert corners.max(axis=0).tolist() == pytest.approx([7 + side, 3 + side])
        coloured = cyan[mesh.triangles]
        assert (coloured.all(axis=1) == coloured.any(axis=1)).all(), "the colour bleeds over the rim"
    plain = surfaces(reconstruct(tmp_path, points[~hole], **names), origin(result), COLOURS, (0,), way)[0]
    assert (plain.colours[:, 0] <= COLOURS[0, 0]).all()
