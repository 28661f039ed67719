"""Layering by surface: what is continuous stays whole, and no layering of as many layers has fewer seams."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.conftest import scan_of

from stepfield.compartments import sort_into_compartments
from stepfield.layers import Layering, classify
from stepfield.layers.cuts import UP, Ties, lowest, settled
from stepfield.layers.patches import components
from stepfield.layers.sheets import PARTED_A_SEAM
from stepfield.links import link
from stepfield.parameters import Parameters
from stepfield.pillars import StepField, build_pillars
from stepfield.pipeline import Pipeline
from stepfield.synth import SyntheticScan, synthesise

Integers = NDArray[np.int64]


def field_of(heights: dict[tuple[int, int], list[float]], tolerance: float = 0.3) -> StepField:
    """Pillars of one point each, given by column, row from the south, and elevations; cells of a metre."""
    points = [[x + 0.5, y + 0.5, z] for (x, y), column in heights.items() for z in column]
    east, north = np.array(list(heights)).max(axis=0) + 1
    first, last = heights[0, 0][0], heights[east - 1, north - 1][0]
    points += [[0.0, 0.0, first], [float(east), float(north), last]]  # at the corners of the grid
    return build_pillars(sort_into_compartments(scan_of(points), 1.0), tolerance)


def seams_of(field: StepField, layering: Layering, step: float = 0.3) -> int:
    return len(layering.seams(link(field, layering.layer >= 0, step)))


def scene(name: str, cell: float, tolerance: float, scanner: bool = False) -> StepField:
    made = synthesise(name, noise=None if scanner else 0.003, seed=7, scanner=scanner)
    return build_pillars(sort_into_compartments(scan_of(made.points), cell), tolerance)


def test_a_slope_that_crosses_the_elevations_of_others_stays_in_one_layer() -> None:
    """The paper's figure 4 in small: a floor, a roof, and between them a slope from the one to the other."""
    heights = {(x, y): [0.0, 0.5 + 0.2 * x, 4.0] for x in range(14) for y in range(5)}
    field = field_of(heights)
    layering = classify(field, "surface")
    assert seams_of(field, layering) == 0
    slope = field.rank == 1
    assert set(layering.layer[slope]) == {1}, "the slope is in several layers"
    assert seams_of(field, classify(field, "elevation")) == 0  # full compartments leave no choice
    beside = {
        place: [z for z in column if 0 < z < 4] if place[0] > 9 else column
        for place, column in heights.items()
    }
    field = field_of(beside)
    assert seams_of(field, classify(field, "elevation")) > 0, "the paper's method was to fail here"
    assert seams_of(field, classify(field, "surface")) == 0


def test_a_ramp_over_itself_is_cut_once_across() -> None:
    """A ring that rises, 5 wide, one and a half times round: it has to be cut across once, and no more."""
    heights: dict[tuple[int, int], list[float]] = {}
    for x, y in product(range(41), repeat=2):
        away, angle = np.hypot(x - 20, y - 20), np.arctan2(y - 20, x - 20) / (2 * np.pi) % 1
        if 12 <= away <= 17:
            heights[x, y] = [6 * angle, 6 * (angle + 1)] if angle < 0.5 else [6 * angle]
        elif (x, y) in {(0, 0), (40, 40)}:
            heights[x, y] = [0.0]
    field = field_of(heights, tolerance=1.5)
    layering = classify(field, "surface")
    assert layering.count == 2
    across = 6  # compartments of the ring on an axis
    assert across - 1 <= seams_of(field, layering, 1.5) <= 1.2 * across


@st.composite
def tangles(draw: st.DrawFn) -> tuple[int, Ties, int]:
    """A few nodes over a few places: any links, any order that leaves a layer for each."""
    nodes, layers = draw(st.integers(2, 6)), draw(st.integers(1, 4))
    pairs = st.tuples(st.integers(0, nodes - 1), st.integers(0, nodes - 1)).filter(
        lambda pair: pair[0] < pair[1]
    )
    links = draw(st.dictionaries(pairs, st.integers(1, 3), max_size=9))
    order = draw(st.sets(pairs, max_size=5))
    one, other = np.array(list(links) or np.zeros((0, 2)), np.int64).reshape(-1, 2).T
    below, above = np.array(sorted(order) or np.zeros((0, 2)), np.int64).reshape(-1, 2).T
    return nodes, Ties(one, other, np.array(list(links.values()), np.int64), below, above), layers


def cost(ties: Ties, layer: Integers) -> int:
    return int((ties.weight * np.abs(layer[ties.one] - layer[ties.other])).sum())


@given(tangles())
@settings(max_examples=200)
def test_settled_from_below_is_the_lowest_of_the_cheapest(tangle: tuple[int, Ties, int]) -> None:
    nodes, ties, layers = tangle
    start = lowest(nodes, ties.below, ties.above, layers)
    if (start >= layers).any():
        return  # no layering at all
    layer = settled(ties, start, layers, (UP,))
    every = (np.array(one) for one in product(range(layers), repeat=nodes))
    possible = [one for one in every if (one[ties.below] < one[ties.above]).all()]
    least = min(cost(ties, one) for one in possible)
    assert cost(ties, layer) == least, "a cheaper layering exists"
    cheapest = [one for one in possible if cost(ties, one) == least]
    assert layer.tolist() == np.min(cheapest, axis=0).tolist(), "a lower one is as cheap"


@pytest.mark.parametrize("name", ["three-planes", "inclined-plane", "table"])
def test_scenes_that_need_no_seam_have_none(name: str) -> None:
    field = scene(name, 0.1, 0.3)
    layering = classify(field, "surface", max_layers="none")
    assert layering.count == int(np.diff(field.first).max())
    assert seams_of(field, layering) == 0


def test_where_planes_cross_most_seams_of_the_papers_method_are_spared() -> None:
    field = scene("crossing-plane", 0.1, 0.3)
    by_elevation, by_surface = (
        seams_of(field, classify(field, method)) for method in ("elevation", "surface")
    )
    assert by_surface <= by_elevation / 4


def fewest_seams(field: StepField, layering: Layering, step: float) -> int:
    """Cut all pillars at once: that is exact, and slow where there are many."""
    chosen = layering.layer >= 0
    number = np.cumsum(chosen) - 1
    links = number[link(field, chosen, step)]
    compartment = field.compartment[chosen]
    below = np.flatnonzero(compartment[1:] == compartment[:-1])
    ties = Ties(links[:, 0], links[:, 1], np.ones(len(links), np.int64), below, below + 1)
    start = lowest(len(compartment), ties.below, ties.above, layering.count)
    exact = settled(ties, start, layering.count, (UP,))
    return int(np.count_nonzero(exact[ties.one] != exact[ties.other]))


@pytest.mark.parametrize("name", ["cylinder", "stairs"])
def test_the_seams_are_the_fewest_there_can_be(name: str) -> None:
    field = scene(name, 0.1, 0.3)
    layering = classify(field, "surface", max_layers="none")
    assert seams_of(field, layering) <= fewest_seams(field, layering, 0.3)


@pytest.mark.parametrize(
    ("seed", "cell", "tolerance", "cap"),
    [(0, 0.2, 0.5, "auto"), (0, 0.1, 0.3, "none"), (3, 0.1, 0.3, "none")],
)
def test_a_parking_ramp_is_cut_where_that_is_short(
    seed: int, cell: float, tolerance: float, cap: Literal["auto", "none"]
) -> None:
    """No place of it is better than the shortest: held together, it was cut at twice the length."""
    made = synthesise("ramp", noise=0.003, seed=seed)
    field = build_pillars(sort_into_compartments(scan_of(made.points), cell), tolerance)
    layering = classify(field, "surface", max_layers=cap)
    assert seams_of(field, layering, tolerance) <= 1.2 * fewest_seams(field, layering, tolerance)


def test_stray_points_under_a_floor_do_not_part_it() -> None:
    """Two halves of a floor joined by a bridge three wide; under one of them a few strays."""
    halves = [(x, y) for x in range(101) for y in range(30) if x != 50 or 8 <= y < 11]
    heights = {place: [5.0] for place in halves}
    strays = [(3, 3), (7, 12), (12, 6), (15, 16)]
    heights |= {place: [0.0, 5.0] for place in strays}
    field = field_of(heights)
    layering = classify(field, "surface", max_layers="none")
    floor = field.elevation > 4
    layers = np.bincount(layering.layer[floor])
    assert layers.max() >= np.count_nonzero(floor) - len(strays), "half of the floor went up for a few strays"
    sides = 4
    assert len(strays) * sides * PARTED_A_SEAM < len(halves) / 2


@pytest.mark.parametrize(
    ("name", "share"),
    [
        ("3dfier__ahn3_cropped_2.laz", 1 / 3),
        ("pye57__pumpAVisualReferenceImage.e57", 1 / 3),
        ("ign-pdal-tools__test_data_77050_627755_LA93_IGN69.laz", 1 / 3),
        ("data__room_scan1.pcd", 0.375),  # 101 seams of 283 there must be, by linear programming
    ],
)
def test_real_scans_have_a_third_of_the_seams(
    name: str, share: float, real_scan: Callable[[str], Path]
) -> None:
    by_surface, by_elevation = (
        Pipeline().run([real_scan(name)], Parameters(layering=method)) for method in ("surface", "elevation")
    )
    assert len(by_surface.seams) <= share * len(by_elevation.seams)
    assert len(by_surface.layers) <= len(by_elevation.layers)


@pytest.mark.parametrize("name", ["three-planes", "inclined-plane", "cylinder"])
def test_scanned_surfaces_stay_together_over_their_strays(name: str) -> None:
    """All but one in 200 of a surface's pillars are in a layer with the rest of their piece."""
    made = synthesise(name, seed=7, scanner=True)
    field = build_pillars(sort_into_compartments(scan_of(made.points), 0.1), 0.3)
    assert share_together(field, classify(field, "surface", max_layers="none"), made, 0.3) >= 0.995


def test_strays_do_not_hold_what_lies_above_them_in_a_layer() -> None:
    """With no more layers than two and one for the strays, going around each of them is the best there is."""
    made = synthesise("table", seed=7, scanner=True)
    field = build_pillars(sort_into_compartments(scan_of(made.points), 0.03), 0.1)
    by_surface, by_elevation = (classify(field, method) for method in ("surface", "elevation"))
    assert seams_of(field, by_surface, 0.1) <= seams_of(field, by_elevation, 0.1)
    assert share_together(field, by_surface, made, 0.1) >= 0.995


def share_together(field: StepField, layering: Layering, made: SyntheticScan, step: float) -> float:
    """Share of the pillars of a single true surface that are where most of their linked piece is."""
    truth = surfaces_of(field, made)
    pure = truth >= 0
    links = link(field, pure, step)
    one, other = links[truth[links[:, 0]] == truth[links[:, 1]]].T
    piece = components(len(field), one, other)
    places = np.stack([piece, layering.layer])[:, pure]
    sheets, counts = np.unique(places, axis=1, return_counts=True)
    together = np.zeros(piece.max() + 1, np.int64)
    np.maximum.at(together, sheets[0], counts)
    return float(together.sum() / np.count_nonzero(pure))


@pytest.mark.parametrize(("seed", "share"), [(0, 0.995), (1, 0.99), (5, 0.995)])
def test_the_ground_of_scanned_rubble_is_one_layer(seed: int, share: float) -> None:
    """Heaps lead up from it to slabs that hang over it; the fewest seams alone would cut it in two halves."""
    made = synthesise("rubble", seed=seed, scanner=True)
    field = build_pillars(sort_into_compartments(scan_of(made.points), 0.2), 0.5)
    layer = classify(field, "surface").layer
    ground = surfaces_of(field, made) == 0
    assert np.count_nonzero(layer[ground] == 0) >= share * np.count_nonzero(ground)


def surfaces_of(field: StepField, made: SyntheticScan) -> Integers:
    """Return the surface that all points of each pillar come from; -1 where they come from several."""
    east, north = (made.points[:, axis] - made.points[:, axis].min() for axis in (0, 1))
    compartment = field.compartments.grid.compartment(east, north)
    order = np.lexsort((made.points[:, 2], compartment))
    low, high = (each.reduceat(made.surface[order], field.start[:-1]) for each in (np.minimum, np.maximum))
    return np.where(low == high, low, -1)


def test_fragments_join_the_layer_they_lie_nearest_to() -> None:
    """Of a canopy over unseen ground only scraps were scanned: they belong to the canopy."""
    heights = {(x, y): [0.0, 9.0] if x < 30 else [0.0] for x in range(60) for y in range(20)}
    scraps = {(x, y): [9.1] for x in range(40, 50, 3) for y in range(0, 20, 3)}
    field = field_of(heights | scraps)
    layering = classify(field, "surface")
    assert set(layering.layer[field.elevation > 8]) == {1}
    assert set(layering.layer[field.elevation < 1]) == {0}


def test_a_table_over_a_floor_that_was_not_seen_is_with_the_other_tables() -> None:
    """Nothing beneath it says that it is not the lowest surface; its elevation does."""
    heights = {(x, y): [0.0] for x in range(60) for y in range(20)}
    heights |= {(x, y): [0.0, 0.8] for x in range(5, 15) for y in range(5, 15)}
    heights |= {(x, y): [0.9] for x in range(30, 40) for y in range(5, 15)}
    field = field_of(heights)
    layering = classify(field, "surface")
    assert set(layering.layer[field.elevation > 0.5]) == {1}
    assert set(layering.layer[field.elevation < 0.5]) == {0}
