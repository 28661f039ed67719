"""Meshes of layers: what the simulator loses (section 6) must be lost here, and nothing more."""

import numpy as np
import pytest

from stepfield.grid import Grid
from stepfield.surface import as_pillars, as_simulator

GRID = Grid(10.0, 20.0, 0.5, 4, 3)


def test_the_simulator_cuts_half_a_compartment_off_every_side() -> None:
    mesh = as_simulator(GRID, np.arange(12), np.full(12, 3.0))
    assert mesh.plan_area == pytest.approx(1.5 * 1.0)
    assert mesh.vertices[:, :2].min(axis=0).tolist() == [10.25, 20.25]


def test_a_surface_one_pillar_thin_disappears() -> None:
    assert len(as_simulator(GRID, np.arange(4), np.ones(4)).triangles) == 0


def test_a_hole_grows() -> None:
    ground = np.array([i for i in range(12) if i != 5])
    assert as_simulator(GRID, ground, np.ones(11)).plan_area == pytest.approx((6 - 4) * 0.25)


def test_pillars_cover_exactly_their_compartments_and_stand_on_the_base() -> None:
    mesh = as_pillars(GRID, np.array([0, 5]), np.array([1.0, 2.0]), -1.0)
    assert mesh.plan_area == pytest.approx(2 * 0.25)
    assert set(mesh.vertices[:, 2].tolist()) == {-1.0, 1.0, 2.0}


def test_an_empty_layer_is_an_empty_mesh() -> None:
    assert len(as_simulator(GRID, np.array([], int), np.array([])).triangles) == 0
    assert len(as_pillars(GRID, np.array([], int), np.array([]), 0.0).triangles) == 0
