"""GeoTIFF as GDAL (through rasterio) finds it: the right height at the right place, in the source's unit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from tests.core.targets.stacks import SOUTH, WEST, asymmetric, stack_of

from stepfield.stack import Stack
from stepfield.targets import geotiff as target
from stepfield.targets.target import Options, Written
from stepfield.targets.terrain import Terrain

#: Oregon Lambert, international feet.
FEET = rasterio.crs.CRS.from_epsg(2992).to_wkt()


def write(stack: Path, folder: Path) -> Written:
    folder.mkdir()
    return target.write(Terrain.of_stack(stack), folder, Options())


def test_every_pixel_is_the_pillar_at_its_place(stack: Path, tmp_path: Path) -> None:
    write(stack, tmp_path / "out")
    decoded = Stack.open(stack)
    cells = np.random.default_rng(3).choice(len(decoded.grid), 800)
    for entry in decoded.manifest.layers:
        with rasterio.open(tmp_path / "out" / f"layer_{entry.index:02d}.tif") as raster:
            found = np.array([value[0] for value in raster.sample(decoded.grid.centres(cells))])
            assert raster.nodata == -9999
            assert (raster.count, raster.dtypes) == (1, ("float32",))
        expected = decoded.elevations(entry).ravel()[cells]
        np.testing.assert_array_equal(found == -9999, np.isnan(expected))
        assert np.nanmax(np.abs(np.where(found == -9999, np.nan, found) - expected)) < 1e-5


def test_the_bounds_are_those_of_the_compartments(asymmetric_stack: Path, tmp_path: Path) -> None:
    write(asymmetric_stack, tmp_path / "out")
    with rasterio.open(tmp_path / "out" / "layer_01.tif") as raster:
        assert raster.bounds == pytest.approx((WEST, SOUTH, WEST + 37 * 0.25, SOUTH + 24 * 0.25))
        assert raster.xy(0, 0) == pytest.approx((WEST + 0.125, SOUTH + 23.5 * 0.25))
        assert raster.descriptions == ("Layer 2",)


def test_feet_and_their_reference_system_stay(tmp_path: Path) -> None:
    """Coordinates beyond float32 and in feet: QGIS must find them where the scan is."""
    west, south = 636_000.5 * 0.3048, 848_900.25 * 0.3048
    layers = [layer + 130.0 for layer in asymmetric()]
    stack = stack_of(
        tmp_path / "s", layers, west=west, south=south, base=129.5, unit="ft", unit_factor=0.3048, crs=FEET
    )
    made = write(stack, tmp_path / "out")
    assert made.notes == ()
    with rasterio.open(tmp_path / "out" / "layer_00.tif") as raster:
        assert raster.crs.to_epsg() == 2992
        assert raster.bounds.left == pytest.approx(636_000.5, abs=1e-9)
        assert raster.bounds.bottom == pytest.approx(848_900.25, abs=1e-9)
        place = (636_000.5 + 5.5 * 0.25 / 0.3048, 848_900.25 + 7.5 * 0.25 / 0.3048)
        (height,) = next(iter(raster.sample([place])))
    assert height == pytest.approx(layers[0][24 - 1 - 7, 5] / 0.3048, abs=1e-3)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({}, "no coordinate reference system"),
        ({"crs": "PROJCS[nonsense"}, "does not understand"),
        ({"crs": FEET, "up": "y"}, "no longer holds"),
    ],
)
def test_without_a_reference_system_it_says_so(
    tmp_path: Path, more: dict[str, Any], said: str, capfd: pytest.CaptureFixture[str]
) -> None:
    made = write(stack_of(tmp_path / "s", asymmetric(), **more), tmp_path / "out")
    assert any(said in note for note in made.notes)
    assert said in (tmp_path / "out" / "README.txt").read_text()
    with rasterio.open(tmp_path / "out" / "layer_00.tif") as raster:
        assert raster.crs is None or not raster.crs.is_projected
    assert capfd.readouterr().err == "", "GDAL complains to the terminal"


def test_an_empty_layer_is_all_nodata_and_names_may_hold_anything(tmp_path: Path) -> None:
    bad = '<&>"\x00\n\u65e5'
    stack = stack_of(tmp_path / "s", [*asymmetric(), np.full((24, 37), np.nan)], names=[bad] * 3)
    write(stack, tmp_path / "out")
    with rasterio.open(tmp_path / "out" / "layer_02.tif") as raster:
        assert (raster.read(1) == -9999).all()
        assert raster.descriptions[0].startswith('<&>"')


def test_the_same_stack_makes_the_same_bytes(asymmetric_stack: Path, tmp_path: Path) -> None:
    made = write(asymmetric_stack, tmp_path / "a")
    write(asymmetric_stack, tmp_path / "b")
    for name in made.files:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
