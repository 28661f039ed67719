"""Classification (5.3.3): one pillar a compartment a layer, the cheapest assignment, averages ascending."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.conftest import scan_of

from stepfield.compartments import sort_into_compartments
from stepfield.layers import UNASSIGNED, cheapest_layers, classify
from stepfield.links import link
from stepfield.pillars import StepField, build_pillars


def columns(*elevations: list[float]) -> StepField:
    """A row of compartments one metre wide, each with single points at the given elevations."""
    points = [[i + 0.5, 0.0, z] for i, column in enumerate(elevations) for z in column]
    last = (elevations[-1] or elevations[0])[0]
    points += [[0.0, 0.0, elevations[0][0]], [float(len(elevations)), 0.0, last]]
    return build_pillars(sort_into_compartments(scan_of(points), 1.0), 0.25)


def test_rank_numbers_from_the_lowest() -> None:
    field = columns([0, 1, 2], [1], [2, 3])
    assert classify(field, "rank").layer.tolist() == [0, 1, 2, 0, 0, 1]


def test_elevation_moves_a_pillar_to_the_layer_it_is_close_to() -> None:
    """The roof over a place where the floor was not seen belongs to the roof's layer, not to the floor's."""
    layering = classify(columns([0, 2], [0, 2], [2], [0, 2]), "elevation")
    assert layering.layer.tolist() == [0, 1, 0, 1, 1, 0, 1]
    assert layering.converged


def test_the_number_of_layers_is_the_most_pillars_of_a_compartment() -> None:
    assert classify(columns([0, 1, 2, 3], [0]), max_layers="none").count == 4


def test_auto_ignores_a_few_crowded_compartments_and_unassigns_their_weakest_pillars() -> None:
    field = columns(*([[0.0, 2.0]] * 300), [0.0, 1.0, 2.0])
    layering = classify(field)
    assert layering.count == 2
    assert layering.unassigned == 1
    assert layering.layer[-1] == UNASSIGNED  # all have one point except the lowest: the highest goes


def test_pillars_of_too_few_points_are_unassigned_not_lost() -> None:
    field = columns([0, 2], [0, 2])
    layering = classify(field, min_points=2)
    assert layering.count == 1
    assert layering.layer.tolist() == [0, UNASSIGNED, 0, UNASSIGNED]


def test_layers_are_numbered_by_ascending_average() -> None:
    field = columns([5, 6], [5, 6], [0], [0], [0], [0])
    layering = classify(field)
    averages = layering.averages(field.elevation)
    assert np.all(np.diff(averages) > 0)


@given(
    st.lists(st.integers(0, 40), min_size=1, max_size=5, unique=True),
    st.lists(st.integers(0, 40), min_size=5, max_size=7, unique=True),
)
def test_the_assignment_is_the_cheapest_of_all(heights: list[int], averages: list[int]) -> None:
    elevation, levels = np.sort(heights).astype(float), np.sort(averages).astype(float)
    chosen = cheapest_layers(elevation[np.newaxis], levels)[0]
    assert np.all(np.diff(chosen) > 0)
    every = [
        np.square(elevation - levels[list(c)]).sum() for c in combinations(range(len(levels)), len(heights))
    ]
    assert np.square(elevation - levels[chosen]).sum() == pytest.approx(min(every))


def test_ties_go_to_the_lower_layer() -> None:
    assert cheapest_layers(np.array([[1.0]]), np.array([0.0, 2.0])).tolist() == [[0]]


def test_links_join_mutual_neighbours_within_the_step_and_seams_are_cut_links() -> None:
    field = columns([0, 2], [0.125, 2], [2], [0])
    taking_part = np.ones(len(field), bool)
    links = link(field, taking_part, 0.25)
    assert links.tolist() == [[0, 2], [1, 3], [3, 4]]
    rank, elevation = (classify(field, method) for method in ("rank", "elevation"))
    assert len(rank.seams(links)) == 1
    assert len(elevation.seams(links)) == 0


def test_links_run_north_south_too_and_never_wrap_round_the_edge() -> None:
    points = [[x + 0.5, y + 0.5, 0.0] for x in range(3) for y in range(2)] + [[0, 0, 0], [3, 2, 0]]
    field = build_pillars(sort_into_compartments(scan_of(points), 1.0), 0.25)
    assert len(link(field, np.ones(len(field), bool), 0.1)) == 2 * 2 + 3


@given(
    st.lists(st.lists(st.integers(0, 60), max_size=5, unique=True), min_size=2, max_size=8),
    st.integers(1, 60),
)
def test_links_are_what_comparing_all_pillars_finds(stacks: list[list[int]], step: int) -> None:
    stacks = [sorted(stack) for stack in stacks]
    stacks[0] = stacks[0] or [0]
    field = columns(*([z / 4.0 for z in stack] for stack in stacks))
    found = {tuple(pair) for pair in link(field, np.ones(len(field), bool), step / 4.0).tolist()}
    z, at = field.elevation, field.compartment
    expected = set()
    for a in range(len(field)):
        for b in np.flatnonzero(at == at[a] + 1):
            mine, its = np.flatnonzero(at == at[a]), np.flatnonzero(at == at[b])
            mutual = (
                its[np.argmin(np.abs(z[its] - z[a]))] == b and mine[np.argmin(np.abs(z[mine] - z[b]))] == a
            )
            if mutual and abs(z[a] - z[b]) <= step / 4.0:
                expected.add((a, int(b)))
    assert found == expected
