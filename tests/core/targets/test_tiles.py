"""Tiles of a layer for programs whose height-fields are solid: no quad lost, no space filled."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from tests.core.targets.stacks import stack_of

from stepfield.targets.terrain import Terrain
from stepfield.targets.tiles import LONGEST, SHARE, SLAB, tiles


def terrain_of(folder: Path, *layers: np.ndarray) -> Terrain:
    return Terrain.of_stack(stack_of(folder / "made", layers))


def test_tiles_cover_every_whole_quad_once(stack: Path) -> None:
    # A quad left out is a hole the scan does not have; one covered twice would flicker and cost.
    terrain = Terrain.of_stack(stack)
    for layer in terrain.layers:
        covered = np.zeros(layer.quads.shape, int)
        for tile in tiles(terrain, layer):
            covered[tile.row : tile.row + tile.rows, tile.column : tile.column + tile.columns] += 1
            assert tile.slab > 0
        np.testing.assert_array_equal(covered, layer.quads)


def test_a_whole_level_layer_is_as_few_tiles_as_can_be(tmp_path: Path) -> None:
    terrain = terrain_of(tmp_path, np.zeros((300, 40)))
    assert len(list(tiles(terrain, terrain.layers[0]))) == -(-299 // LONGEST)


def test_no_tile_fills_the_space_beneath_a_slope(find_stack: Callable[[str], Path]) -> None:
    # The ramp winds over itself: one tile over a whole turn would close the turn below.
    terrain = Terrain.of_stack(find_stack("ramp"))
    for layer in terrain.layers[1:]:
        for tile in tiles(terrain, layer):
            samples = tile.samples(layer.elevations)
            underside = float(samples.min()) - tile.slab
            for other in terrain.layers:
                below = tile.samples(other.elevations)
                gap = samples - below
                free = np.isfinite(gap) & (gap > 0.05)
                if tile.rows == tile.columns == 1:
                    continue  # a single quad cannot be parted; its own underside is level
                quarter = below[free] + (1 - SHARE) * gap[free] - 1e-4
                assert (underside >= quarter - _relief_of_quads(samples)).all()


def _relief_of_quads(samples: np.ndarray) -> float:
    """How much a single quad rises, at most: a share is counted from a quad's lowest corner."""
    corners = np.stack([samples[:-1, :-1], samples[1:, :-1], samples[:-1, 1:], samples[1:, 1:]])
    return float((corners.max(axis=0) - corners.min(axis=0)).max()) * 2


def test_a_slab_is_thin_where_little_is_free_beneath(tmp_path: Path) -> None:
    low, high = np.zeros((6, 8)), np.full((6, 8), 0.4)
    terrain = terrain_of(tmp_path, low, high)
    (ground,), (shelf,) = (list(tiles(terrain, layer)) for layer in terrain.layers)
    assert ground.slab == SLAB
    assert shelf.slab == np.float32(0.05) or abs(shelf.slab - 0.4 / 8) < 1e-3


def test_layers_without_a_quad_make_no_tiles(tmp_path: Path) -> None:
    checkered = np.where(np.indices((5, 5)).sum(axis=0) % 2, np.nan, 1.0)
    terrain = terrain_of(tmp_path, checkered, np.full((5, 5), np.nan))
    assert [list(tiles(terrain, layer)) for layer in terrain.layers] == [[], []]


def test_a_single_row_of_compartments_makes_no_tiles(tmp_path: Path) -> None:
    terrain = terrain_of(tmp_path, np.zeros((1, 7)))
    assert list(tiles(terrain, terrain.layers[0])) == []
