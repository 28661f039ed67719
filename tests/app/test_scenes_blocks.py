"""Blocks: every pillar is there, at its elevation, in its layer's colour; what cannot be seen is not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.app.scenes_made import UTM, reconstruct, table_result

from stepfield.reconstruction import Reconstruction
from stepfield_app.render.scene import Triangles
from stepfield_app.scenes.blocks import blocks, height_range
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.scenes.stacks import THINNEST, coarser, step_field

COLOURS = layer_colours(2)
ALL = (-1, 0, 1)


@pytest.fixture
def result(tmp_path: Path) -> Reconstruction:
    return table_result(tmp_path, UTM)


def origin(result: Reconstruction) -> np.ndarray:
    return result.scan.bounds()[0]


def plan_area(mesh: Triangles, *, up: bool = True) -> float:
    """Area in the plan of the faces that look up (or down), square metres."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]].astype(float) for i in range(3))
    doubled = np.cross(b - a, c - a)[:, 2]
    return float(np.abs(doubled[doubled > 0 if up else doubled < 0]).sum() / 2)


def test_every_top_is_at_its_elevation_over_its_compartment(result: Reconstruction) -> None:
    made = step_field(result, origin(result), ALL)
    mesh = blocks(result, origin(result), COLOURS, ALL)[0]
    tops = mesh.vertices[: 4 * len(made)].reshape(-1, 4, 3)
    assert len(made) == len(result.field)
    order = np.argsort(result.layering.layer, kind="stable")
    field = result.field
    expected = field.elevation[order] + field.compartments.lowest - origin(result)[2]
    assert np.abs(tops[:, :, 2] - expected[:, np.newaxis]).max() < 1e-6
    squares = field.compartments.grid.squares(field.compartment[order])
    assert np.abs(tops[:, 0, :2] - (squares[:, :2] - origin(result)[:2])).max() < 1e-6
    assert np.abs(tops[:, 2, :2] - (squares[:, 2:] - origin(result)[:2])).max() < 1e-6


def test_tops_cover_all_compartments_and_undersides_those_of_slabs(result: Reconstruction) -> None:
    mesh = blocks(result, origin(result), COLOURS, ALL)[0]
    assert plan_area(mesh) == pytest.approx(8 * 6 + 3 * 2)
    assert plan_area(mesh, up=False) == pytest.approx(3 * 2)


def test_level_ground_has_walls_only_at_the_edge_of_the_grid(result: Reconstruction) -> None:
    mesh = blocks(result, origin(result), COLOURS, (0,))[0]
    assert len(mesh.triangles) == 2 * (16 * 12 + 2 * (16 + 12))
    assert mesh.vertices[:, 2].min() == pytest.approx(-0.5)  # the base plane, alpha below the floor


def test_a_slab_has_walls_around_and_can_be_seen_from_the_side(result: Reconstruction) -> None:
    mesh = blocks(result, origin(result), COLOURS, (1,))[0]
    assert len(mesh.triangles) == 2 * (2 * 6 * 4 + 2 * (6 + 4))
    assert np.ptp(mesh.vertices[:, 2]) == pytest.approx(THINNEST * 0.5)


def test_hidden_layers_vanish_and_nothing_visible_is_an_empty_mesh(result: Reconstruction) -> None:
    floor = blocks(result, origin(result), COLOURS, (0,))[0]
    assert floor.vertices[:, 2].max() == pytest.approx(0.0, abs=1e-6)
    for mesh in blocks(result, origin(result), COLOURS, ()):
        assert mesh.vertices.shape == (0, 3)
        assert mesh.triangles.shape == (0, 3)


def test_colours_are_the_layers_darkened_never_brightened(result: Reconstruction) -> None:
    mesh = blocks(result, origin(result), COLOURS, (1,))[0]
    assert (mesh.colours <= COLOURS[1]).all()
    assert (mesh.colours >= COLOURS[1] * 0.3).all()
    assert (mesh.colours == COLOURS[1]).all(axis=1).any()


def test_the_floor_is_darker_where_a_neighbour_stands_higher(tmp_path: Path) -> None:
    ground = [[x + 0.5, y + 0.5, 2.0 * (x == 3)] for x in range(7) for y in range(3)]
    result = reconstruct(
        tmp_path, [*ground, [0, 0, 0], [7, 3, 0]], cell_size=1.0, layer_tolerance=3.0, alpha=1.0, max_layers=1
    )
    mesh = blocks(result, origin(result), COLOURS, (0,))[0]
    tops = mesh.colours[: 4 * 21].reshape(3, 7, 4, 3).sum(axis=-1)
    assert (tops[1, 2, 1:3] < tops[1, 0].min()).all()  # its eastern corners touch the ridge
    assert (tops[1, 2, [0, 3]] == tops[1, 0, 0]).all()


def test_what_is_covered_by_a_neighbour_is_not_drawn_and_all_else_is(tmp_path: Path) -> None:
    steps = [[x + 0.5, 0.5, float(x)] for x in range(4)]
    result = reconstruct(
        tmp_path, [*steps, [0, 0, 0], [4, 1, 3]], cell_size=1.0, layer_tolerance=9.0, alpha=1.0
    )
    mesh = blocks(result, origin(result), COLOURS, (0,))[0]
    corners = mesh.vertices.reshape(-1, 4, 3)
    rising = corners[np.ptp(corners[:, :, 0], axis=1) == 0]  # walls that face east or west
    spans = sorted((wall[0, 0], wall[:, 2].min(), wall[:, 2].max()) for wall in rising)
    tops = result.field.elevation
    expected = [(0.0, -1.0, tops[0]), *((i, tops[i - 1], tops[i]) for i in (1, 2, 3)), (4.0, -1.0, tops[3])]
    assert np.allclose(spans, expected, atol=1e-6)


def test_each_level_is_coarser_and_as_high(result: Reconstruction) -> None:
    levels = blocks(result, origin(result), COLOURS, ALL)
    counts = [len(mesh.triangles) for mesh in levels]
    assert counts == sorted(counts, reverse=True)
    assert len(levels) == 4
    for mesh in levels:
        assert mesh.vertices[:, 2].max() == pytest.approx(1.0)
        assert mesh.vertices[:, :2].max(axis=0).tolist() == pytest.approx([8, 6])


def test_joining_takes_the_highest_top_and_the_lowest_bottom(result: Reconstruction) -> None:
    fine = step_field(result, origin(result), (0,))
    raised = replace(fine, top=fine.top + np.where(fine.compartment == 0, 2.0, 0.0))
    coarse = coarser(raised)
    assert coarse.top[0] == pytest.approx(2.0)
    assert coarse.top[1:] == pytest.approx(0.0)
    assert coarse.standing.all()
    assert len(coarse) == 8 * 6


def test_an_odd_grid_keeps_its_edge_in_every_level(tmp_path: Path) -> None:
    points = [[x + 0.5, y + 0.5, 0] for x in range(5) for y in range(3)]
    result = reconstruct(tmp_path, [*points, [0, 0, 0], [5, 3, 0]], cell_size=1.0, layer_tolerance=1.0)
    for mesh in blocks(result, origin(result), COLOURS, ALL):
        assert plan_area(mesh) == pytest.approx(15)


def test_a_pillar_above_a_hidden_unassigned_one_stands_on_the_base(result: Reconstruction) -> None:
    layer = np.where(result.layering.layer == 0, -1, 1)
    edited = replace(result, layering=replace(result.layering, layer=layer))
    assert step_field(edited, origin(result), (1,)).standing.all()
    shown = step_field(edited, origin(result), ALL)
    assert not shown.standing[shown.layer == 1].any()


def test_colours_by_height_follow_the_ramp(result: Reconstruction) -> None:
    low, high = height_range(result)
    assert (low, high) == pytest.approx((UTM[2], UTM[2] + 1))
    floor, top = (
        blocks(result, origin(result), COLOURS, (layer,), mode="height")[0].colours.max(axis=0)
        for layer in (0, 1)
    )
    assert int(top.sum()) > int(floor.sum())


def test_results_are_read_only_and_small_types(result: Reconstruction) -> None:
    for mesh in blocks(result, origin(result), COLOURS, ALL):
        assert [a.dtype.name for a in (mesh.vertices, mesh.triangles, mesh.colours)] == [
            "float32",
            "int32",
            "uint8",
        ]
        assert not any(array.flags.writeable for array in (mesh.vertices, mesh.triangles, mesh.colours))
        assert mesh.triangles.max(initial=-1) < len(mesh.vertices)


@pytest.mark.parametrize("points", [[[5, 5, 5]], [[5, 5, 5], [5, 5, 9]], [[0, 0, 0], [9, 0, 0]]])
def test_the_smallest_scans_have_pictures_too(tmp_path: Path, points: list[list[float]]) -> None:
    result = reconstruct(tmp_path, points, cell_size=1.0, layer_tolerance=1.0)
    for mode in ("layer", "height"):
        mesh = blocks(result, origin(result), COLOURS, ALL, mode=mode)[0]
        assert plan_area(mesh) == pytest.approx(len(result.field))
