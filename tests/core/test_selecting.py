"""Masks over pillars: what is within reach, along surfaces, and at the same places of another result."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction
from stepfield.selecting import (
    Reach,
    at_places,
    carried,
    connected,
    grown,
    inverted,
    nothing,
    of_layer,
    places,
    shrunk,
)

Mask = NDArray[np.bool_]
#: Rows and columns of the floor, and of the table-top a metre above it.
FLOOR, TOP = (12, 16), (4, 6)
SHIFT = (432_100.0, 5_411_300.0, 212.0)


def reconstruct(folder: Path, points: NDArray[np.float64], **chosen: object) -> Reconstruction:
    path = folder / "scan.npy"
    np.save(path, points)
    method = {"cell_size": 0.5, "layer_tolerance": 0.3, "alpha": 0.5}
    return Pipeline().run([path], Parameters.checked(**{**method, **chosen}))


def table() -> NDArray[np.float64]:
    """Four points a half-metre of a floor and of a table-top."""
    step = np.arange(0.125, 8, 0.25)
    x, y = (each.ravel() for each in np.meshgrid(step, step[step < 6]))
    above = (x > 2) & (x < 5) & (y > 2) & (y < 4)
    floor, top = np.c_[x, y, 0 * x], np.c_[x, y, 0 * x + 1][above]
    return np.vstack([floor, top, [[0, 0, 0], [8, 6, 0]]]) + SHIFT


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Reconstruction:
    return reconstruct(tmp_path_factory.mktemp("table"), table())


def one_of(result: Reconstruction, layer: int, row: int, column: int) -> Mask:
    """Mask of the pillar of a layer in a compartment."""
    number = row * result.field.compartments.grid.columns + column
    mask: Mask = (result.field.compartment == number) & (result.layering.layer == layer)
    assert mask.sum() == 1
    return mask


def test_the_reach_is_a_layer_or_a_range_of_elevations_in_scan_coordinates(result: Reconstruction) -> None:
    floor, top = FLOOR[0] * FLOOR[1], TOP[0] * TOP[1]
    assert Reach().mask(result).sum() == floor + top
    assert Reach(layer=0).mask(result).sum() == floor
    assert Reach(layer=-1).mask(result).sum() == 0
    assert Reach(low=SHIFT[2] + 0.5).mask(result).sum() == top
    assert Reach(high=SHIFT[2]).mask(result).sum() == floor, "the ends of the range count"
    assert Reach(layer=0, low=SHIFT[2] + 0.5).mask(result).sum() == 0
    assert np.array_equal(of_layer(result, 1), Reach(layer=1).mask(result))


def test_inverting_touches_nothing_beyond_reach(result: Reconstruction) -> None:
    mask = one_of(result, 0, 3, 3) | one_of(result, 1, 5, 5)
    other = inverted(result, mask, Reach(layer=0))
    assert (other & of_layer(result, 1)).sum() == 1, "layer 1 is out of reach"
    assert other.sum() == FLOOR[0] * FLOOR[1] - 1 + 1
    assert np.array_equal(inverted(result, other, Reach(layer=0)), mask)


def test_growing_adds_linked_neighbours_within_reach(result: Reconstruction) -> None:
    seed = one_of(result, 0, 5, 5)
    assert grown(result, seed).sum() == 5
    assert grown(result, seed, Reach(layer=1)).sum() == 1
    corner = one_of(result, 1, 4, 4)
    assert grown(result, corner).sum() == 3, "the edge of the table-top has no links to the floor"


def test_shrinking_takes_a_ring_off(result: Reconstruction) -> None:
    assert shrunk(result, of_layer(result, 1)).sum() == (TOP[0] - 2) * (TOP[1] - 2)
    assert shrunk(result, of_layer(result, 0)).sum() == (FLOOR[0] - 2) * (FLOOR[1] - 2)
    seed = one_of(result, 0, 5, 5)
    twice = grown(result, grown(result, seed))
    assert np.array_equal(shrunk(result, twice), grown(result, seed))


def test_a_surface_ends_where_its_links_do(result: Reconstruction) -> None:
    assert np.array_equal(connected(result, one_of(result, 1, 5, 5)), of_layer(result, 1))
    assert np.array_equal(connected(result, one_of(result, 0, 0, 0)), of_layer(result, 0))
    both = connected(result, one_of(result, 0, 0, 0) | one_of(result, 1, 5, 5))
    assert both.all()
    assert connected(result, nothing(result)).sum() == 0


def test_pillars_in_no_layer_are_connected_among_themselves(tmp_path: Path) -> None:
    """Links are of exported pillars: those taken out of the export would be lone ones otherwise."""
    result = reconstruct(tmp_path, table(), max_layers=1)
    seed = one_of(result, -1, 5, 5)
    assert connected(result, seed, Reach(layer=-1)).sum() == TOP[0] * TOP[1]
    assert grown(result, seed).sum() == 5


heights = arrays(np.int8, st.tuples(st.integers(1, 6), st.integers(1, 6)), elements=st.integers(0, 3))


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(heights, st.sampled_from([Reach(), Reach(low=0.5), Reach(layer=0)]), st.data())
def test_a_surface_is_what_any_graph_search_finds(
    tmp_path: Path, heights: NDArray[np.int8], reach: Reach, data: st.DataObject
) -> None:
    """Steps of 0.2 m are linked, those of 0.4 m are not: mazes of all kinds."""
    row, column = np.indices(heights.shape)
    points = np.c_[column.ravel() + 0.5, row.ravel() + 0.5, 0.2 * heights.ravel()]
    points = np.vstack([points, points + np.array([0, 0, 2]), [[0, 0, 0], [*heights.T.shape, 0.0]]])
    result = reconstruct(tmp_path, points, cell_size=1.0)
    seed = np.zeros(len(result.field), bool)
    seed[data.draw(st.integers(0, len(seed) - 1))] = True
    allowed = reach.mask(result) | seed
    one, other = result.links[allowed[result.links].all(axis=1)].T
    graph = coo_array((np.ones(len(one)), (one, other)), shape=(len(seed), len(seed)))
    _, group = connected_components(graph, directed=False)
    assert np.array_equal(connected(result, seed, reach), group == group[seed])


def test_a_selection_follows_its_places_to_another_cell_size_and_back(tmp_path: Path) -> None:
    coarse = reconstruct(tmp_path, table())
    fine = reconstruct(tmp_path, table(), cell_size=0.25)
    mask = of_layer(coarse, 1)
    there = carried(coarse, fine, mask)
    assert np.array_equal(there, of_layer(fine, 1))
    again = reconstruct(tmp_path, table())
    assert np.array_equal(carried(fine, again, there), mask)
    assert np.array_equal(at_places(again, places(coarse, mask)), mask)
    assert carried(coarse, fine, nothing(coarse)).sum() == 0


def test_the_same_step_field_keeps_the_very_same_mask(result: Reconstruction) -> None:
    mask = of_layer(result, 1)
    assert carried(result, result, mask) is mask


def test_no_mask_can_be_written_to(result: Reconstruction) -> None:
    """Views of several threads share them."""
    mask = of_layer(result, 1)
    made = [mask, inverted(result, mask), grown(result, mask), shrunk(result, mask), connected(result, mask)]
    made += [nothing(result), at_places(result, places(result, mask))]
    assert not any(each.flags.writeable for each in made)
