"""Overlays of the map: what is wrong with a layer, where it is wrong, and by how much."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.app.scenes_made import UTM, reconstruct, table, table_result

from stepfield.complex_parts import ComplexParts
from stepfield.layers import UNASSIGNED
from stepfield.progress import silent
from stepfield.reconstruction import Reconstruction
from stepfield.surface import Mesh
from stepfield_app.ramps import ramp
from stepfield_app.scenes.complex_parts import Meshed
from stepfield_app.scenes.fidelity import fidelity_facts
from stepfield_app.scenes.overlays import KINDS, Kind, Overlay, overlay
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.theme import OVERLAYS, rgb


@pytest.fixture
def result(tmp_path: Path) -> Reconstruction:
    return table_result(tmp_path, UTM)


def drawn(result: Reconstruction, layer: int, kind: Kind, stride: int = 1) -> Overlay:
    errors = fidelity_facts(result, None, silent).comparison.errors if kind == "error" else ()
    return overlay(result, layer, kind, errors, layer_colours(len(result.layers)), stride)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("layer", [0, 1, UNASSIGNED])
@pytest.mark.parametrize("stride", [1, 3])
def test_every_overlay_of_every_layer_can_be_drawn(
    result: Reconstruction, kind: Kind, layer: int, stride: int
) -> None:
    made = drawn(result, layer, kind, stride)
    assert made.pixels.shape == (-(-12 // stride), -(-16 // stride), 4)
    assert made.values.shape == made.pixels.shape[:2]
    assert np.all(made.pixels[~np.isnan(made.values), 3] == 255)
    assert not made.pixels.flags.writeable


def test_an_error_has_the_sign_of_the_scan(tmp_path: Path) -> None:
    """Points above a surface are red, whichever way it is off, and none at all is white."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(0.05, 10, 0.1), np.arange(0.05, 3, 0.1)))
    x, y = np.append(x, [0, 10]), np.append(y, [0, 3])  # so that compartments begin at whole metres
    ridge = np.column_stack([x, y, 2 - np.abs(x - 5)])
    made = drawn(reconstruct(tmp_path, ridge, cell_size=1.0, layer_tolerance=5.0), 0, "error")
    row, slope, crest = made.values[1], slice(1, 4), slice(4, 6)
    assert np.all(np.abs(row[slope]) < 1e-3)
    assert np.all(np.abs(row[crest]) > 0.05)
    assert made.legend.low == -made.legend.high
    assert made.pixels[1, 2, :3].min() > 230  # white
    signs = np.sign(row[crest])
    for place, sign in zip((4, 5), signs, strict=True):
        red, _, blue = made.pixels[1, place, :3].astype(int)
        assert np.sign(red - blue) == sign


def test_an_error_is_not_drawn_before_it_is_known(result: Reconstruction) -> None:
    made = overlay(result, 0, "error", (), layer_colours(2))
    assert np.isnan(made.values).all()
    assert made.pixels[:, :, 3].any()  # but the layer is


def test_clearance_is_the_room_under_the_table(result: Reconstruction) -> None:
    made = drawn(result, 0, "clearance")
    under = np.zeros((12, 16), bool)
    under[4:8, 4:10] = True
    assert np.array_equal(~np.isnan(made.values), under)
    assert np.allclose(made.values[under], 1.0, atol=1e-6)
    assert drawn(result, 1, "clearance").legend.entries[0][1] == "nothing above this layer"


def test_holes_are_those_within_the_layer(tmp_path: Path) -> None:
    points = table()
    far = (np.abs(points[:, 0] - 6.25) > 0.5) | (np.abs(points[:, 1] - 2.25) > 0.25)
    made = drawn(reconstruct(tmp_path, points[far], cell_size=0.5, layer_tolerance=0.3), 0, "holes")
    row, column = np.nonzero(~np.isnan(made.values))
    assert set(zip(row.tolist(), column.tolist(), strict=True)) == {(7, 12)}
    assert tuple(made.pixels[7, 12, :3]) == rgb(OVERLAYS["hole"])
    assert made.names[0] == "hole"
    assert [name for _, name in made.legend.entries] == ["enclosed by the layer"]


def test_holes_that_were_filled_are_told_from_those_left_open(tmp_path: Path) -> None:
    """One of a compartment, and one of three in a row that is too long."""
    points = table()
    small = (np.abs(points[:, 0] - 6.25) < 0.25) & (np.abs(points[:, 1] - 2.25) < 0.25)
    long = (np.abs(points[:, 0] - 6.25) < 0.75) & (np.abs(points[:, 1] - 4.25) < 0.25)
    chosen = {"cell_size": 0.5, "layer_tolerance": 0.3, "fill": "linear", "fill_size": 0.5}
    made = drawn(reconstruct(tmp_path, points[~small & ~long], **chosen), 0, "holes")
    assert made.names == ("left open", "filled")
    assert tuple(made.pixels[7, 12, :3]) == rgb(OVERLAYS["filled"])
    assert [tuple(made.pixels[3, column, :3]) for column in (11, 12, 13)] == [rgb(OVERLAYS["hole"])] * 3
    assert made.legend.entries == ((rgb(OVERLAYS["hole"]), "left open"), (rgb(OVERLAYS["filled"]), "filled"))
    all_filled = drawn(reconstruct(tmp_path, points[~small], **chosen), 0, "holes")
    assert [name for _, name in all_filled.legend.entries] == ["filled"]
    assert tuple(all_filled.pixels[7, 12, :3]) == rgb(OVERLAYS["filled"])


def test_seams_are_in_the_colour_of_the_other_layer(tmp_path: Path) -> None:
    """A ramp from the floor to the ceiling has to be cut; each side says where it goes on."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(0.25, 20, 0.5), np.arange(0.25, 4, 0.5)))
    floor, ceiling = (np.column_stack([x, y, np.full(x.shape, z)]) for z in (0.0, 5.0))
    ramp_up = np.column_stack([x, y + 4, np.clip(0.3 * (x - 2), 0, 5)])
    result = reconstruct(tmp_path, np.vstack([floor, ceiling, ramp_up]), cell_size=1.0, layer_tolerance=1.0)
    assert len(result.seams)
    made, colours = drawn(result, 0, "seams"), layer_colours(len(result.layers))
    there = ~np.isnan(made.values)
    assert there.any()
    assert np.all(made.pixels[there, :3] == colours[1])
    assert made.names[1] == f"goes on in {result.layers[1].name}"
    of = result.layering.layer[result.seams]
    assert np.count_nonzero(there) == len(np.unique(result.field.compartment[result.seams[of == 0]]))


def test_gaps_are_white_at_the_tolerance(tmp_path: Path) -> None:
    points = [[c + 0.5, 0.5, z] for c, gap in enumerate((0.4, 0.5, 0.6, 0.9)) for z in (0, gap)]
    result = reconstruct(
        tmp_path, [*points, [0, 0, 0], [4, 1, 0]], cell_size=1.0, layer_tolerance=0.5, max_layers="none"
    )
    made = drawn(result, 0, "gaps")
    assert made.values[0, :3] == pytest.approx([0.4, 0.5, 0.6])
    assert np.isnan(made.values[0, 3])
    assert (made.legend.low, made.legend.high) == pytest.approx((0.375, 0.625))
    assert np.array_equal(made.pixels[0, 1, :3], ramp("error")[128])


def test_what_a_simulator_loses_is_at_the_rim(result: Reconstruction) -> None:
    made = drawn(result, 1, "lost")
    inner, side, corner = made.values[5, 6], made.values[4, 6], made.values[4, 4]
    assert np.isnan(inner)
    assert (side, corner) == (50, 75)


def test_a_mesh_counts_where_it_stands_in(result: Reconstruction) -> None:
    """The table-top as a mesh half a metre too high: its pillars are gone, and its points that far off."""
    top = result.layers[1].pillars
    replaced = np.zeros(len(result.field), bool)
    replaced[top] = True
    x, y, z = UTM
    corners = np.array([[x + 2, y + 2, z + 1.5], [x + 5, y + 2, z + 1.5], [x + 5, y + 4, z + 1.5]])
    other = np.array([[x + 2, y + 4, z + 1.5]])
    mesh = Mesh(np.vstack([corners, other]), np.array([[0, 1, 2], [0, 2, 3]]))
    facts = fidelity_facts(result, None, silent, Meshed(result, ComplexParts(replaced, replaced, mesh)))
    floor, above = facts.comparison.errors
    assert np.nanmax(np.abs(floor)) < 1e-6
    assert len(above) == len(top)
    assert np.isnan(above).all()
    assert facts.comparison.fidelity.nearest.max == pytest.approx(0.5, abs=1e-5)


def test_facts_agree_with_the_result(result: Reconstruction) -> None:
    facts = fidelity_facts(result, None, silent)
    assert (facts.seams, facts.links) == (len(result.seams), len(result.links))
    assert facts.least_room == pytest.approx(1.0)
    assert facts.holes == (0, 0.0)
    assert facts.lost == pytest.approx(1 - (15 * 11 + 5 * 3) / (16 * 12 + 6 * 4))
    assert facts.vanished == (0, 2)
    assert facts.comparison.fidelity.explained == 1
