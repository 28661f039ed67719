"""Outlines of chosen pillars: their ends, their corners, and how many there may be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.app.scenes_made import UTM, reconstruct, table_result

from stepfield.reconstruction import Reconstruction
from stepfield_app.scenes.outline import rim

ORIGIN = np.zeros(3)


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Reconstruction:
    return table_result(tmp_path_factory.mktemp("table"))


def of_layer(result: Reconstruction, layer: int) -> NDArray[np.bool_]:
    chosen: NDArray[np.bool_] = result.layering.layer == layer
    return chosen


def length(lines: NDArray[np.float32]) -> float:
    return float(np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum())


def test_a_table_top_is_outlined_along_its_edge(table: Reconstruction) -> None:
    lines = rim(table, of_layer(table, 1), ORIGIN).whole
    level = lines[lines[:, 0, 2] == lines[:, 1, 2]]
    down = lines[lines[:, 0, 2] != lines[:, 1, 2]]
    assert length(level) == pytest.approx(2 * (3 + 2)), "the outline is not the edge of 3 by 2 metres"
    assert np.allclose(level[..., 2], 1)
    corners = {(2.0, 2.0), (5.0, 2.0), (5.0, 4.0), (2.0, 4.0)}
    assert {tuple(place) for place in down[:, 0, :2].tolist()} == corners


def test_steps_within_a_selection_are_outlined_and_slopes_are_not(tmp_path: Path) -> None:
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(0.25, 10, 0.5), np.arange(0.25, 4, 0.5)))
    z = np.where(x < 5, 0.05 * x, 2.0)
    result = reconstruct(tmp_path, np.column_stack([x, y, z]), cell_size=1.0, layer_tolerance=0.3)
    lines = rim(result, np.ones(len(result.field), bool), ORIGIN).edges
    inner = lines[((lines[..., 0] > 1) & (lines[..., 0] < 9)).all(axis=1)]
    across = inner[inner[:, 0, 0] == inner[:, 1, 0]]
    low = np.array([result.scan.x.bounds()[0]])
    assert np.allclose(across[..., 0], 5 + low, atol=0.3), "lines lie elsewhere than at the step"
    assert len(across) == 2 * 4, "both edges of the step should be outlined"


def test_chosen_pillars_above_each_other_do_not_hide_each_others_edges(table: Reconstruction) -> None:
    whole = rim(table, np.ones(len(table.field), bool), ORIGIN).edges
    assert length(whole) == pytest.approx(2 * (8 + 6) + 2 * (3 + 2), rel=0.02)


def test_lines_end_where_the_block_is_hidden_from_below(table: Reconstruction) -> None:
    floor = of_layer(table, 0) & (np.arange(len(table.field)) % 7 == 0)
    lines = rim(table, floor, ORIGIN).whole
    down = lines[lines[:, 0, 2] != lines[:, 1, 2]]
    edge = (down[:, 0, :2] <= [0, 0]).any(axis=1) | (down[:, 0, :2] >= [8, 6]).any(axis=1)
    assert edge[down[:, 1, 2] < -0.1].all(), "lines go down between blocks that touch"


def test_national_coordinates_lose_nothing(tmp_path: Path) -> None:
    result = table_result(tmp_path, UTM)
    here = rim(result, of_layer(result, 1), np.array(UTM)).whole
    assert here[..., 0].min() == pytest.approx(2, abs=1e-5)
    assert here[..., 1].max() == pytest.approx(4, abs=1e-5)
    assert here[..., 2].max() == pytest.approx(1, abs=1e-5)
    assert here.dtype == np.float32
    assert not here.flags.writeable


def test_pillars_of_hidden_layers_have_no_outline(table: Reconstruction) -> None:
    everything = np.ones(len(table.field), bool)
    assert np.array_equal(
        rim(table, everything, ORIGIN, (0,)).whole, rim(table, of_layer(table, 0), ORIGIN).whole
    )
    assert len(rim(table, everything, ORIGIN, (-1,)).whole) == 0


def test_nothing_chosen_has_no_outline(table: Reconstruction) -> None:
    assert rim(table, np.zeros(len(table.field), bool), ORIGIN).whole.shape == (0, 2, 3)


def test_too_many_segments_are_thinned_out(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(60) + 0.5, np.arange(60) + 0.5))
    rough = reconstruct(
        tmp_path,
        np.column_stack([x, y, rng.uniform(0, 9, 3600)]),
        cell_size=1.0,
        layer_tolerance=0.1,
        link_step=0.1,
        max_layers=1,
    )
    everything = np.ones(len(rough.field), bool)
    assert len(rim(rough, everything, ORIGIN).edges) > 10_000
    thinned = rim(rough, everything, ORIGIN, most=1000).edges
    assert 0 < len(thinned) <= 1000
    x, y = thinned[..., 0], thinned[..., 1]
    inner = (x > x.min()) & (x < x.max()) & (y > y.min()) & (y < y.max())
    assert not inner.all(axis=1).any(), "steps within go first, the outer edge stays"
