"""Maps, thumbnails, the readout, sections and histograms: the numbers in them are the result's own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.app.scenes_made import UTM, reconstruct, table, table_result

from stepfield.reconstruction import Reconstruction
from stepfield_app.ramps import ramp
from stepfield_app.scenes import histogram
from stepfield_app.scenes.cloud import Cloud, cloud
from stepfield_app.scenes.paled import PALE
from stepfield_app.scenes.palette import layer_codes, layer_colours
from stepfield_app.scenes.raster import AMBIENT, Mode, elevations, hillshade, raster, thumbnails
from stepfield_app.scenes.readout import compartment_at, pillars_at
from stepfield_app.scenes.section import Section, band
from stepfield_app.scenes.section import section as section_of
from stepfield_app.theme import FILLED_COLOUR, rgb

Place = tuple[float, float]


@pytest.fixture
def result(tmp_path: Path) -> Reconstruction:
    return table_result(tmp_path, UTM)


def placed(result: Reconstruction) -> Cloud:
    return cloud(result.scan, result.scan.bounds()[0])


def section(result: Reconstruction, start: Place, end: Place, width: float, most: int = 1000) -> Section:
    return section_of(band(placed(result), start, end, width, most), result)


def at(x: float, y: float) -> tuple[float, float]:
    return UTM[0] + x, UTM[1] + y


# --- Maps ---------------------------------------------------------------------------------------------------


def holed(folder: Path, **chosen: object) -> Reconstruction:
    """Reconstruct the table and a floor with a hole of two by two compartments in it."""
    points = table()
    is_hole = (points[:, 0] > 6) & (points[:, 0] < 7) & (points[:, 1] > 2) & (points[:, 1] < 3)
    values = {"cell_size": 0.5, "layer_tolerance": 0.3, "alpha": 0.5} | chosen
    return reconstruct(folder, points[~is_hole], **values)


@pytest.mark.parametrize("mode", ["gray", "colour", "hillshade"])
@pytest.mark.parametrize("stride", [1, 2])
def test_what_was_filled_has_a_colour_and_is_never_taken_for_measured(
    tmp_path: Path, mode: Mode, stride: int
) -> None:
    if mode == "gray" and stride > 1:
        return
    picture = raster(holed(tmp_path, fill="linear"), 0, mode, stride=stride)
    empty = np.isnan(picture.elevations)
    assert empty.sum() == 4 // stride**2
    assert (picture.pixels[:, :, 3] == 255).all()
    assert picture.legend is not None
    assert picture.legend.note == ("incl. filled" if mode == "gray" else "cyan: filled")
    if mode != "gray":
        measured = picture.pixels[~empty][:, :3].max(axis=0)
        assert (picture.pixels[empty][:, :3] > measured).all()
    plain = raster(holed(tmp_path), 0, mode, stride=stride)
    assert plain.legend is not None
    assert plain.legend.note == ""
    assert (plain.pixels[:, :, 3] == 255).sum() == empty.size - empty.sum()


def test_no_height_in_whatever_light_has_a_colour_of_what_was_filled() -> None:
    """Else a filled summit would be taken for a measured one."""
    heights = ramp("height").astype(float)
    measured = np.concatenate([heights * light for light in np.linspace(AMBIENT, 1, 27)])
    filled = heights * 0.92 * (1 - PALE) + np.array(rgb(FILLED_COLOUR)) * PALE
    apart = np.linalg.norm(filled[:, np.newaxis] - measured, axis=2)
    assert apart.min() > 40


@pytest.mark.parametrize("mode", ["gray", "colour", "hillshade"])
def test_holes_are_transparent_and_pixels_are_not(result: Reconstruction, mode: Mode) -> None:
    picture = raster(result, 1, mode)
    assert picture.pixels.shape == (12, 16, 4)
    occupied = np.zeros((12, 16), bool)
    occupied[4:8, 4:10] = True  # row 0 is north
    assert np.array_equal(picture.pixels[:, :, 3] == 255, occupied)
    assert not picture.pixels[~occupied].any()
    assert np.array_equal(np.isnan(picture.elevations), ~occupied)
    assert np.nanmax(picture.elevations) == pytest.approx(UTM[2] + 1)


@pytest.mark.parametrize("bits", [8, 16])
def test_gray_is_that_of_the_exported_image(tmp_path: Path, bits: int) -> None:
    points = [[x + 0.5, y + 0.5, x / 7] for x in range(7) for y in range(5)]
    result = reconstruct(
        tmp_path, [*points, [0, 0, 0], [7, 5, 1]], cell_size=1.0, layer_tolerance=5.0, bits=bits
    )
    gray = result.height_map(result.layers[0]).gray >> (8 if bits == 16 else 0)
    frame = result.frame
    cropped = gray[frame.row : frame.row + 5, frame.column : frame.column + 7]
    assert np.array_equal(raster(result, 0, "gray").pixels[:, :, 0], cropped)


def test_unassigned_pillars_have_a_map_too(result: Reconstruction) -> None:
    layering = replace(result.layering, layer=np.where(result.layering.layer == 1, -1, 0))
    edited = replace(result, layering=layering)
    for mode in ("gray", "colour", "hillshade"):
        assert np.count_nonzero(raster(edited, -1, mode).pixels[:, :, 3]) == 24


def test_slopes_towards_the_light_are_brighter_and_holes_cast_none() -> None:
    x = np.arange(10, dtype=np.float32)
    rising_east, falling_east = np.tile(x, (5, 1)), np.tile(-x, (5, 1))
    assert hillshade(rising_east, 1.0).mean() > hillshade(falling_east, 1.0).mean()
    rising_north = np.tile(-np.arange(5, dtype=np.float32)[:, np.newaxis], (1, 10))
    assert hillshade(rising_north, 1.0).mean() < hillshade(-rising_north, 1.0).mean()
    level = np.zeros((5, 10), np.float32)
    level[2, 3] = np.nan
    assert hillshade(level, 1.0)[~np.isnan(level)] == pytest.approx(0.92)


def test_an_empty_layer_has_no_legend(tmp_path: Path) -> None:
    """A ramp from 0 to 1 m would say where its pillars are not."""
    result = reconstruct(tmp_path, [[0.5, 0.5, 0.0], [1.5, 0.5, 0.0]], cell_size=1.0, layer_tolerance=1.0)
    assert raster(result, 0).legend is not None
    assert raster(result, -1).legend is None


def test_a_thumbnail_shows_a_single_pillar(tmp_path: Path) -> None:
    points = [[x + 0.5, y + 0.5, 0.0] for x in range(200) for y in range(90)]
    result = reconstruct(
        tmp_path,
        [*points, [150.5, 40.5, 5.0], [0, 0, 0], [200, 90, 0]],
        cell_size=1.0,
        layer_tolerance=1.0,
        max_layers=2,
    )
    small = thumbnails(result, [1], 48)[1]
    assert max(small.shape[:2]) <= 48
    assert np.count_nonzero(small[:, :, 3]) == 1
    row, column = np.argwhere(small[:, :, 3])[0]
    assert (row, column) == ((90 - 1 - 40) // 5, 150 // 5)


def test_a_small_grid_is_enlarged_and_an_empty_layer_is_blank(result: Reconstruction) -> None:
    assert thumbnails(result, [0], 48)[0].shape == (36, 48, 4)
    assert not thumbnails(result, [-1], 48)[-1].any()
    assert np.isnan(elevations(result, -1)).all()


# --- The cursor ---------------------------------------------------------------------------------------------


def test_the_cursor_finds_the_pillars_of_its_compartment(result: Reconstruction) -> None:
    floor, top = pillars_at(result, *at(3.1, 3.1))
    assert (floor.layer, top.layer) == (0, 1)
    assert floor.elevation == pytest.approx(UTM[2])
    assert (top.low, top.elevation, top.high) == pytest.approx((UTM[2] + 1,) * 3)
    assert top.points == 4
    assert compartment_at(result, *at(3.1, 3.1)) == (5, 6)
    assert len(pillars_at(result, *at(7.9, 0.1))) == 1


@pytest.mark.parametrize("place", [(-0.1, 3), (8.1, 3), (3, -0.1), (3, 6.1)])
def test_there_is_nothing_beside_the_grid(result: Reconstruction, place: tuple[float, float]) -> None:
    assert compartment_at(result, *at(*place)) is None
    assert pillars_at(result, *at(*place)) == ()


# --- Sections -----------------------------------------------------------------------------------------------


def test_a_section_takes_the_points_near_the_line(result: Reconstruction) -> None:
    made = section(result, at(0, 3.1), at(8, 3.1), 0.5)
    y = result.scan.y.values() - UTM[1]
    near = (y >= 2.85) & (y <= 3.35)
    assert made.found == len(made.along) == np.count_nonzero(near)
    assert np.allclose(np.sort(made.along), np.sort(result.scan.x.values()[near] - UTM[0]), atol=1e-5)
    expected = layer_codes((made.elevation > UTM[2] + 0.5).astype(np.int64))
    assert np.array_equal(made.codes, expected)


def test_a_slanted_line_measures_along_itself(result: Reconstruction) -> None:
    made = section(result, at(1, 1), at(4, 5), 0.4)
    assert made.length == pytest.approx(5)
    place = result.scan.points()[:, :2] - at(1, 1)
    along, aside = place @ [0.6, 0.8], np.abs(place @ [0.8, -0.6])
    expected = along[(aside <= 0.2) & (along >= 0) & (along <= 5)]
    assert np.allclose(np.sort(made.along), np.sort(expected), atol=1e-5)


def test_the_rectangles_are_the_pillars_the_line_cuts(result: Reconstruction) -> None:
    cut = section(result, at(-1, 3.1), at(8, 3.1), 0.5).cut
    floor, top = cut.layer == 0, cut.layer == 1
    assert np.allclose(cut.start[floor], 1 + np.arange(0, 8, 0.5))
    assert np.allclose(cut.end[floor], 1.5 + np.arange(0, 8, 0.5))
    assert np.allclose(cut.start[top], 1 + np.arange(2, 5, 0.5))
    assert np.allclose(cut.elevation[top], UTM[2] + 1)
    assert cut.standing[floor].all()
    assert not cut.standing[top].any()


@pytest.mark.parametrize("ends", [((0.1, 5.9), (7.9, 0.1)), ((6.2, 0.1), (6.2, 5.7)), ((7, 5), (1, 5.2))])
def test_rectangles_cover_the_line_without_gaps(
    result: Reconstruction, ends: tuple[tuple[float, float], tuple[float, float]]
) -> None:
    made = section(result, at(*ends[0]), at(*ends[1]), 0.5)
    floor = made.cut.layer == 0
    assert (made.cut.end - made.cut.start)[floor].sum() == pytest.approx(made.length)
    for start, end, pillar in zip(made.cut.start, made.cut.end, made.cut.pillar, strict=True):
        middle = np.array(ends[0]) + (np.subtract(ends[1], ends[0])) * (start + end) / 2 / made.length
        assert pillar in [each.pillar for each in pillars_at(result, *at(*middle))]


def test_a_line_without_length_or_beside_the_grid_cuts_nothing(result: Reconstruction) -> None:
    for ends in ((at(3, 3), at(3, 3)), (at(20, 3), at(30, 3))):
        made = section(result, *ends, 0.5)
        assert made.found == len(made.along) == len(made.cut.pillar) == 0


def test_too_many_points_become_an_even_subset_and_are_told(result: Reconstruction) -> None:
    made = section(result, at(0, 3), at(8, 3), 6, most=50)
    assert len(made.along) == len(made.elevation) == len(made.codes) == 50
    assert made.found > 700
    assert np.ptp(made.along) > 6


# --- Histograms ---------------------------------------------------------------------------------------------


def test_a_histogram_counts_every_point_once_in_its_layer(result: Reconstruction) -> None:
    made = histogram.of_layers(result, 10)
    assert made.exact
    assert made.counts.shape == (3, 10)
    assert made.total.sum() == len(result.scan)
    assert made.counts[1].sum() == made.counts[1, -1] == 96
    assert made.edges[[0, -1]].tolist() == pytest.approx([UTM[2], UTM[2] + 1])
    assert made.averages.tolist() == pytest.approx([UTM[2], UTM[2] + 1])


def test_a_large_scan_is_sampled_and_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(histogram, "SAMPLE", 1000)
    heights = np.random.default_rng(0).random(50_000)
    made = histogram.of_layers(
        reconstruct(tmp_path, np.column_stack([heights, heights, heights]), cell_size=10), 4
    )
    assert not made.exact
    assert made.total.sum() == pytest.approx(50_000)
    assert made.total == pytest.approx(12_500, rel=0.2)


def test_a_flat_scan_has_a_histogram(tmp_path: Path) -> None:
    assert histogram.of_layers(reconstruct(tmp_path, np.zeros((7, 3)), cell_size=1), 4).total.tolist() == [
        7,
        0,
        0,
        0,
    ]


def test_strays_leave_the_bins_to_the_others(tmp_path: Path) -> None:
    heights = np.append(np.random.default_rng(0).random(20_000), [500.0, -500.0])
    made = histogram.of_layers(
        reconstruct(tmp_path, np.column_stack([heights, heights, heights]), cell_size=10), 10
    )
    assert made.edges[0] > -1
    assert made.edges[-1] < 2
    assert made.total.sum() == len(heights), "points were lost"


def test_layers_have_a_colour_each() -> None:
    assert len({tuple(row) for row in layer_colours(9).tolist()}) == 10
