"""Clouds and their colours: exact places, and no colour that means something else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.app.scenes_made import UTM, table, table_result
from tests.conftest import scan_of

from stepfield.scan import Scan
from stepfield_app.scenes import colouring
from stepfield_app.scenes.classes import CLASSES, class_palette
from stepfield_app.scenes.cloud import cloud, points
from stepfield_app.scenes.palette import layer_codes, layer_colours, layer_palette


@pytest.fixture
def scan() -> Scan:
    """A thousand points with every attribute there is."""
    rng = np.random.default_rng(1)
    attributes = {
        "rgb": rng.integers(0, 255, (1000, 3), np.uint8),
        "intensity": rng.integers(0, 60_000, 1000).astype(np.uint16),
        "classification": rng.choice([2, 6, 17], 1000).astype(np.uint8),
    }
    return replace(scan_of(rng.random((1000, 3)) * [50, 40, 9] + UTM), attributes=attributes)


def test_places_are_exact_far_from_zero(scan: Scan) -> None:
    origin = scan.bounds()[0]
    made = cloud(scan, origin)
    assert np.abs(made.places - (scan.points() - origin)).max() < 50 * 2**-24
    assert not made.places.flags.writeable


def test_another_origin_moves_the_places(scan: Scan) -> None:
    origin = scan.bounds()[0] - [10, 20, 5]
    made = cloud(scan, origin)
    assert np.abs(made.places - (scan.points() - origin)).max() < 70 * 2**-24
    assert made.box[0].tolist() == pytest.approx([10, 20, 5])


def test_only_modes_with_something_to_show_are_offered(scan: Scan, tmp_path: Path) -> None:
    assert set(colouring.modes(scan)) == {"height", "rgb", "intensity", "class", "single"}
    bare = scan_of(table())
    assert colouring.modes(bare) == ("height", "single")
    assert "layer" in colouring.modes(bare, table_result(tmp_path))


@pytest.mark.parametrize("mode", ["height", "intensity", "class", "rgb", "single"])
def test_every_mode_colours_every_point(scan: Scan, mode: colouring.Mode) -> None:
    made = colouring.coloured(scan, mode)
    assert len(made.codes) == len(scan)
    assert made.codes.dtype == np.uint8
    assert not made.codes.flags.writeable
    assert (made.palette is None) == (mode == "rgb")
    assert points(cloud(scan, scan.bounds()[0]), made).codes is made.codes


def test_height_rises_with_the_ramp_and_the_legend_gives_scan_elevations(scan: Scan) -> None:
    made = colouring.by_height(scan)
    order = np.argsort(scan.z.values())
    assert (np.diff(made.codes[order].astype(int)) >= 0).all()
    assert made.legend is not None
    assert UTM[2] < made.legend.low < made.legend.high < UTM[2] + 9


def test_a_stray_point_does_not_flatten_the_colours() -> None:
    heights = np.append(np.linspace(0, 1, 10_000), 5000.0)
    made = colouring.by_height(scan_of(np.column_stack([heights * 0, heights * 0, heights])))
    assert made.codes[5000] == pytest.approx(127, abs=3)


def test_a_flat_scan_and_unknown_intensities_have_colours_too() -> None:
    flat = replace(scan_of(np.zeros((5, 3))), attributes={"intensity": np.full(5, np.nan)})
    assert len(colouring.by_height(flat).codes) == 5
    assert len(colouring.by_intensity(flat).codes) == 5


def test_a_mode_without_its_attribute_falls_back_to_height() -> None:
    made = colouring.coloured(scan_of(table()), "class")
    assert made.legend is not None
    assert made.legend.title == "Elevation"


def test_classes_keep_their_codes_and_name_those_present(scan: Scan) -> None:
    made = colouring.by_class(scan)
    assert np.array_equal(made.codes, scan.attributes["classification"])
    assert made.legend is not None
    assert [name for _, name in made.legend.entries] == ["2  Ground", "6  Building", "17  Bridge deck"]


def test_no_two_standard_classes_look_the_same() -> None:
    assert len({tuple(row) for row in class_palette()[list(CLASSES)].tolist()}) == 23


def test_points_take_the_layer_of_their_pillar(tmp_path: Path) -> None:
    result = table_result(tmp_path, UTM)
    made = colouring.by_layer(result.scan, result, layer_colours(2))
    assert np.array_equal(made.codes, (result.scan.z.values() > UTM[2] + 0.5).astype(np.uint8))


def test_points_of_pillars_in_no_layer_are_gray(tmp_path: Path) -> None:
    result = table_result(tmp_path)
    layering = replace(result.layering, layer=np.where(result.layering.layer == 1, -1, 0))
    made = colouring.by_layer(result.scan, replace(result, layering=layering), layer_colours(2))
    assert made.palette is not None
    above = result.scan.z.values() > 0.5
    assert (made.palette[made.codes[above]] == layer_colours(2)[-1]).all()


def test_points_beside_the_result_are_unassigned_and_the_others_take_the_nearest_pillar(
    tmp_path: Path,
) -> None:
    result = table_result(tmp_path)
    wider = scan_of([[4.1, 3.1, 0.3], [4.1, 3.1, 0.7], [4.1, 3.1, 9.0], [4.1, 3.1, -3.0], [-4.0, 3.0, 0.0]])
    made = colouring.by_layer(wider, result, layer_colours(2))
    assert made.codes.tolist() == [0, 1, 1, 0, layer_codes(np.array([-1]))[0]]


def test_layers_and_palette_agree_and_unassigned_is_last() -> None:
    colours = layer_colours(20)
    layers = np.array([0, 7, 19, -1])
    assert np.array_equal(layer_palette(colours)[layer_codes(layers)], colours[layers])
