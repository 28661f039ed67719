"""The edges reconstruction covers just the compartments of its pillars; layers meet where they continue."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.conftest import scan_of

from stepfield.compartments import sort_into_compartments
from stepfield.grid import Grid
from stepfield.layers import classify
from stepfield.links import linked
from stepfield.pillars import build_pillars
from stepfield.surface import Mesh, as_edges, as_simulator, losses, sheets
from stepfield.synth import SCENES, synthesise

GRID = Grid(100.0, -50.0, 0.5, 4, 3)
Layers = list[tuple[NDArray[np.int64], NDArray[np.float64]]]


def layer(pillars: dict[int, float]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Make a layer of elevations by compartment."""
    return np.array(sorted(pillars), np.int64), np.array([pillars[c] for c in sorted(pillars)], float)


def normals(mesh: Mesh) -> NDArray[np.float64]:
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    return np.cross(b - a, c - a)


def free_edges(mesh: Mesh) -> NDArray[np.int64]:
    """Edges, as places of their ends, that no neighbouring triangle has the other way round."""
    edges = mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    there = {tuple(edge) for edge in edges.tolist()}
    assert len(there) == len(edges), "two triangles use an edge in the same direction"
    return np.array([edge for edge in sorted(there) if edge[::-1] not in there], np.int64).reshape(-1, 2)


@pytest.mark.parametrize("scene", sorted(SCENES))
def test_every_scene_is_covered_exactly(scene: str) -> None:
    made = synthesise(scene, points=20_000, noise=0.003, seed=7)
    field = build_pillars(sort_into_compartments(scan_of(made.points), 0.1), 0.3)
    layering, grid = classify(field), field.compartments.grid
    layers = [
        (field.compartment[own], field.elevation[own]) for own in map(layering.members, range(layering.count))
    ]
    lost = losses(grid, layers, 0.3)
    for mesh, (own, tops), loss in zip(as_edges(grid, layers, 0.3), layers, lost, strict=True):
        assert mesh.plan_area == pytest.approx(len(own) * 0.01, rel=1e-9)
        assert mesh.plan_area == pytest.approx(loss.occupied_area, rel=1e-9)
        assert as_simulator(grid, own, tops).plan_area == pytest.approx(loss.simulator_area, rel=1e-9)


def test_a_lone_pillar_is_a_level_square() -> None:
    (mesh,) = as_edges(GRID, [layer({5: 3.0})], 0.1)
    assert mesh.plan_area == pytest.approx(0.25)
    assert set(mesh.vertices[:, 2]) == {3.0}
    assert mesh.vertices[:, :2].min(axis=0) == pytest.approx([100.5, -49.5])
    assert mesh.vertices[:, :2].max(axis=0) == pytest.approx([101.0, -49.0])


def test_a_beam_one_compartment_wide_stays_and_slopes_as_it_does() -> None:
    beam = layer({4: 1.0, 5: 1.1, 6: 1.2, 7: 1.3})
    (mesh,) = as_edges(GRID, [beam], 0.2)
    assert mesh.plan_area == pytest.approx(1.0)
    at_lines = {x: set(np.round(mesh.vertices[mesh.vertices[:, 0] == x, 2], 9)) for x in (100.5, 101, 101.5)}
    assert at_lines == {100.5: {1.05}, 101: {1.15}, 101.5: {1.25}}
    (loss,) = losses(GRID, [beam], 0.2)
    assert (loss.simulator_area, loss.surfaces, loss.vanished) == (0, 1, 1)


def test_a_cliff_within_a_layer_stays_a_cliff_and_is_closed() -> None:
    ground = layer({c: 0.0 if c % 4 < 2 else 2.0 for c in range(12)})
    (mesh,) = as_edges(GRID, [ground], 0.3)
    assert set(mesh.vertices[:, 2]) == {0.0, 2.0}, "the cliff is smeared"
    upright = normals(mesh)[normals(mesh)[:, 2] == 0]
    assert np.linalg.norm(upright, axis=1).sum() / 2 == pytest.approx(2.0 * 1.5)
    assert (upright[:, 0] < 0).all(), "a riser faces the lower side"
    assert len(free_edges(mesh)) == 2 * (4 + 3) + 2 * 1, "the rim, and the riser's two ends"


def test_a_step_that_fades_into_a_ramp_is_closed_by_single_triangles() -> None:
    tops = np.array([[0.0, 0.9], [0.0, 0.5], [0.0, 0.1]])
    grid = Grid(0, 0, 1.0, 2, 3)
    (mesh,) = as_edges(grid, [(np.arange(6), tops.ravel())], 0.45)
    rim = free_edges(mesh)
    assert len(rim) == 10 + 1, "the rim, and the upright edge at the open end of the step"


def test_a_step_stays_open_where_another_layer_passes_through_it() -> None:
    """The floor goes on in the upper layer under a table that is in the layer of the floor."""
    lower, upper = layer({4: 0.0, 5: 0.8}), layer({5: 0.02})
    floor, rest = as_edges(GRID, [lower, upper], 0.1)
    assert (normals(floor)[:, 2] > 0).all(), "an upright face bars the way"
    assert rest.plan_area == pytest.approx(0.25)


def test_a_step_is_closed_where_only_what_is_on_top_goes_on() -> None:
    lower, upper = layer({4: 0.0, 5: 0.8}), layer({4: 0.82})
    block, _ = as_edges(GRID, [lower, upper], 0.1)
    assert np.count_nonzero(normals(block)[:, 2] == 0) == 2


def test_layers_that_continue_each_other_meet_in_the_very_same_places() -> None:
    west = layer({c: 0.1 * (c % 4) + 0.013 * (c // 4) for c in (0, 1, 4, 5, 8, 9)})
    east = layer({c: 0.1 * (c % 4) + 0.013 * (c // 4) for c in (2, 3, 6, 7, 10, 11)})
    one, other = as_edges(GRID, [west, east], 0.2)
    ends = [mesh.vertices[mesh.vertices[:, 0] == 101.0] for mesh in (one, other)]
    assert len(ends[0]) == 4
    assert {tuple(v) for v in ends[0]} == {tuple(v) for v in ends[1]}


def test_a_surface_that_winds_around_a_corner_does_not_meet_itself() -> None:
    grid = Grid(0, 0, 1.0, 2, 2)
    # north-west, south-west, south-east, north-east, and north-west again one turn further up
    lower, upper = layer({0: 0.0, 2: 0.5, 3: 1.0, 1: 1.5}), layer({0: 2.0})
    first, second = sheets(grid, [lower, upper], 0.6)
    assert first.vertex[0, 2] != second.vertex[0, 2]
    assert first.corner[0, 2] == pytest.approx(np.mean([0.0, 0.5, 1.0, 1.5]))
    assert second.corner[0, 2] == 2.0


def test_nothing_makes_nothing() -> None:
    nothing = (np.zeros(0, np.int64), np.zeros(0))
    assert as_edges(GRID, [], 0.1) == []
    assert [len(mesh.triangles) for mesh in as_edges(GRID, [nothing, layer({0: 1.0})], 0.1)] == [0, 4]
    assert losses(GRID, [nothing], 0.1)[0].surfaces == 0


def test_losses_tell_what_disappears() -> None:
    pillars = dict.fromkeys((0, 1, 4, 5), 0.0) | {11: 0.0}
    (loss,) = losses(GRID, [layer(pillars)], 0.1)
    assert (loss.occupied_area, loss.simulator_area) == (1.25, 0.25)
    assert (loss.surfaces, loss.vanished) == (2, 1)


@st.composite
def scenes(draw: st.DrawFn) -> tuple[Grid, Layers]:
    """Draw up to three layers over a small grid with few different elevations."""
    columns, rows = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    there = st.lists(st.booleans(), min_size=columns * rows, max_size=columns * rows)
    layers = []
    for index in range(draw(st.integers(1, 3))):
        compartment = np.flatnonzero(draw(there))
        tops = st.lists(st.integers(0, 7), min_size=len(compartment), max_size=len(compartment))
        layers.append((compartment, np.array(draw(tops), float) * 0.25 + index * 0.03125))
    return Grid(10.0, 20.0, 0.5, columns, rows), layers


@given(scenes())
@settings(max_examples=150, deadline=None)
def test_any_layers_are_covered_exactly_and_nothing_overhangs(scene: tuple[Grid, Layers]) -> None:
    grid, layers = scene
    for mesh, (own, tops) in zip(as_edges(grid, layers, 0.3), layers, strict=True):
        assert mesh.plan_area == pytest.approx(len(own) * 0.25)
        assert (normals(mesh)[:, 2] > -1e-12).all()
        used = np.unique(mesh.triangles)
        assert len(used) == len(mesh.vertices), "a vertex without a triangle"
        if len(own):
            assert np.isin(tops, mesh.vertices[:, 2]).all(), "the middle of a compartment is its pillar's top"
        free_edges(mesh)


@given(scenes())
@settings(max_examples=150, deadline=None)
def test_linked_neighbours_share_the_corners_of_their_side(scene: tuple[Grid, Layers]) -> None:
    """Unless the surface winds around a corner: then a pillar of each compartment shares it at most."""
    grid, layers = scene
    made = sheets(grid, layers, 0.3)
    compartment, vertex = (
        np.concatenate([getattr(sheet, name) for sheet in made]) for name in ("compartment", "vertex")
    )
    tops = np.concatenate([sheet.top for sheet in made])
    for corner in range(4):
        pairs = np.column_stack([compartment, vertex[:, corner]])
        assert len(np.unique(pairs, axis=0)) == len(pairs), "two pillars of a compartment share a corner"
    order = np.lexsort((tops, compartment))
    east, south = linked(grid, compartment[order], tops[order] - tops.min(initial=0), 0.3)
    for pairs, here, there in ((east, (3, 2), (0, 1)), (south, (2, 1), (3, 0))):
        one, other = order[pairs].T
        for i, j in zip(here, there, strict=True):
            if len(layers) == 1:
                assert (vertex[one, i] == vertex[other, j]).all()


@given(scenes())
@settings(max_examples=150, deadline=None)
def test_no_rim_is_further_from_its_pillars_than_half_the_link_step_a_side(
    scene: tuple[Grid, Layers],
) -> None:
    grid, layers = scene
    made = sheets(grid, layers, 0.3)
    vertex, corner = (
        np.concatenate([getattr(sheet, name) for sheet in made]) for name in ("vertex", "corner")
    )
    tops = np.repeat(np.concatenate([sheet.top for sheet in made]), 4)
    _, number = np.unique(vertex, return_inverse=True)
    sharing = np.bincount(number.ravel())
    mean = np.bincount(number.ravel(), tops) / sharing
    most = np.array([np.nan, 1, 1 / 2, 1 / 3, 0])[sharing] * 0.3
    assert (
        np.abs(corner - mean[number].reshape(corner.shape)) <= most[number].reshape(corner.shape) + 1e-9
    ).all()


@st.composite
def outlines(draw: st.DrawFn) -> tuple[Grid, NDArray[np.bool_]]:
    """Draw a ground plan, however indented, holed or parted, nowhere narrower than three compartments."""
    columns, rows = draw(st.integers(3, 12)), draw(st.integers(3, 12))
    place = st.tuples(st.integers(0, rows - 3), st.integers(0, columns - 3))
    there = np.zeros((rows, columns), bool)
    for row, column in draw(st.lists(place, min_size=1, max_size=12)):
        there[row : row + 3, column : column + 3] = True
    return Grid(10.0, 20.0, 0.5, columns, rows), there


@given(outlines(), st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.data())
@settings(max_examples=150, deadline=None)
def test_a_tilted_plane_is_itself_to_its_very_rim_however_layers_share_it(
    outline: tuple[Grid, NDArray[np.bool_]], east: float, north: float, data: st.DataObject
) -> None:
    grid, there = outline
    compartment = np.flatnonzero(there)
    second = np.array(
        data.draw(st.lists(st.booleans(), min_size=len(compartment), max_size=len(compartment)))
    )
    tops = grid.centres(compartment) @ [east, north]
    layers = [(compartment[own], tops[own]) for own in (~second, second)]
    for mesh, (own, _) in zip(as_edges(grid, layers, 0.3), layers, strict=True):
        assert mesh.vertices[:, 2] == pytest.approx(mesh.vertices[:, :2] @ [east, north], abs=1e-9)
        assert mesh.plan_area == pytest.approx(len(own) * 0.25)
        assert (normals(mesh)[:, 2] > 1e-12).all(), "a riser where the plane goes on"


@given(scenes(), st.floats(-100, 100))
@settings(max_examples=50, deadline=None)
def test_level_ground_is_level_to_its_rim(scene: tuple[Grid, Layers], level: float) -> None:
    grid, layers = scene
    for mesh in as_edges(grid, [(own, np.full(len(own), level)) for own, _ in layers[:1]], 0.3):
        assert set(mesh.vertices[:, 2]) <= {level}


def ends(tops: list[float]) -> tuple[float, float]:
    """Elevations of the west and the east end of a beam."""
    grid = Grid(0, 0, 1.0, len(tops), 1)
    (sheet,) = sheets(grid, [layer(dict(enumerate(tops)))], 0.3)
    west, east = sheet.corner[0, [0, 1]], sheet.corner[-1, [2, 3]]
    assert west[0] == west[1]
    assert east[0] == east[1]
    return float(west[0]), float(east[0])


def test_a_slope_goes_on_to_its_end_by_the_gentler_of_its_last_two_links() -> None:
    assert ends([0.0, 0.1, 0.3]) == pytest.approx((-0.05, 0.35))
    assert ends([0.0, 0.1, 0.3, 0.35, 0.5]) == pytest.approx((-0.05, 0.525))


def test_noise_and_steps_are_not_carried_on_to_a_rim() -> None:
    assert ends([0.1, 0.0, 0.1, 0.0]) == (0.1, 0.0), "the last link is no slope where the one before it falls"
    assert ends([0.0, 0.0, 0.2]) == (0.0, 0.2), "a step is no slope"
    assert ends([0.0, 0.2, 0.2]) == (0.0, 0.2)


def test_a_single_link_is_half_believed() -> None:
    assert ends([0.0, 0.2]) == pytest.approx((-0.05, 0.25))


def test_a_slope_goes_on_to_the_edge_of_a_cliff_and_what_lies_beneath_stays_as_it_is() -> None:
    grid = Grid(0, 0, 1.0, 6, 3)
    tops = np.tile([2.2, 2.1, 2.0, 0.0, 0.0, 0.0], 3)
    (sheet,) = sheets(grid, [(np.arange(18), tops)], 0.3)
    edge, foot = sheet.corner[2::6][:, [2, 3]], sheet.corner[3::6]
    assert edge == pytest.approx(1.95)
    assert (foot == 0).all()
    assert len(sheet.east) == 3, "the cliff is closed"


@given(scenes())
@settings(max_examples=50, deadline=None)
def test_the_order_of_the_layers_does_not_matter(scene: tuple[Grid, Layers]) -> None:
    grid, layers = scene
    forth, back = as_edges(grid, layers, 0.3), as_edges(grid, layers[::-1], 0.3)[::-1]
    for one, other in zip(forth, back, strict=True):
        assert one.vertices.tobytes() == other.vertices.tobytes()
        assert one.triangles.tobytes() == other.triangles.tobytes()
