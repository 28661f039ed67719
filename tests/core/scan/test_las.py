"""LAS and LAZ: laspy is the oracle for what is whole; what is not gives its points or one sentence."""

from __future__ import annotations

import struct
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import laspy
import numpy as np
import pytest

from stepfield.errors import ScanError
from stepfield.scan import crs, las
from stepfield.scan.cloud import Cloud

Maker = Callable[..., Path]
ODD = "../scans-malformed"
COLOURED = {2, 3, 5, 7, 8, 10}


@pytest.fixture
def make(tmp_path: Path) -> Maker:
    """Write a LAS or LAZ file of random points with laspy."""

    def write(suffix: str = ".las", point_format: int = 3, count: int = 3000, **extra: Any) -> Path:
        rng = np.random.default_rng(point_format)
        version = "1.4" if point_format >= 6 else "1.3" if point_format >= 4 else "1.2"
        header = laspy.LasHeader(point_format=point_format, version=version)
        header.scales, header.offsets = [0.01, 0.01, 0.001], [500000, 4_000_000, 0]
        if extra.get("extra_bytes"):
            header.add_extra_dim(laspy.ExtraBytesParams("surface", np.int32))
        for vlr in extra.get("vlrs", ()):
            header.vlrs.append(vlr)
        data = laspy.LasData(header)
        data.X, data.Y, data.Z = rng.integers(-10000, 10000, (3, count), np.int32).cumsum(axis=1)
        data.intensity = rng.integers(1, 60000, count)
        data.classification = rng.integers(1, 20, count)
        if point_format in COLOURED:
            data.red, data.green, data.blue = rng.integers(0, extra.get("deepest", 65535), (3, count))
        path = tmp_path / f"scan{point_format}{suffix}"
        data.write(path)
        return path

    return write


def outcome(path: Path) -> Cloud | ScanError:
    """Read a file that may be damaged: a cloud or one sentence, and nothing else."""
    try:
        return las.read(path)
    except ScanError as error:
        failure = error
    assert "\n" not in str(failure)
    assert str(failure).startswith(path.name)
    return failure


def patched(path: Path, offset: int, value: bytes) -> Path:
    raw = bytearray(path.read_bytes())
    raw[offset : offset + len(value)] = value
    path.write_bytes(raw)
    return path


def assert_like_laspy(cloud: Cloud, path: Path) -> None:
    expected = laspy.read(path)
    for axis, name, scale, offset in zip(
        cloud.axes, "XYZ", expected.header.scales, expected.header.offsets, strict=True
    ):
        assert axis.raw.dtype == np.int32
        np.testing.assert_array_equal(axis.raw, expected[name])
        assert (axis.scale, axis.offset) == (scale, offset)
    for name in ("intensity", "classification"):
        values = np.asarray(expected[name])
        assert (name in cloud.attributes) == values.any()
        np.testing.assert_array_equal(cloud.attributes.get(name, 0 * values), values)


@pytest.mark.parametrize("suffix", [".las", ".laz"])
@pytest.mark.parametrize("point_format", range(11))
def test_every_point_format_gives_the_integers_of_the_file(
    make: Maker, suffix: str, point_format: int
) -> None:
    path = make(suffix, point_format)
    cloud = las.read(path)
    assert_like_laspy(cloud, path)
    assert ("rgb" in cloud.attributes) == (point_format in COLOURED)
    if point_format in COLOURED:
        expected = laspy.read(path)
        np.testing.assert_array_equal(cloud.attributes["rgb"][:, 1], np.asarray(expected.green) >> 8)
    assert cloud.warnings == ()


@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_extra_bytes_are_passed_over(make: Maker, suffix: str) -> None:
    path = make(suffix, 7, extra_bytes=True)
    assert_like_laspy(las.read(path), path)


def test_colours_of_eight_bits_stay(make: Maker) -> None:
    path = make(".las", 3, deepest=256)
    np.testing.assert_array_equal(las.read(path).attributes["rgb"][:, 0], laspy.read(path).red)


def test_deep_colours_that_begin_late_darken_what_was_read_before(tmp_path: Path) -> None:
    count = 100_000
    data = laspy.LasData(laspy.LasHeader(point_format=2, version="1.2"))
    data.X = np.arange(count)
    data.red = np.where(np.arange(count) < count - 10, 200, 65535)
    data.write(tmp_path / "late.las")
    red = las.read(tmp_path / "late.las").attributes["rgb"][:, 0]
    assert set(red[:-10]) == {0}
    assert set(red[-10:]) == {255}


def test_many_chunks_and_blocks_are_joined_in_order(make: Maker) -> None:
    path = make(".laz", 6, count=1_120_000)
    assert_like_laspy(las.read(path), path)


@pytest.mark.parametrize(("point_format", "kept"), [(3, 100_000), (7, 100_000)])
def test_a_truncated_laz_gives_its_whole_chunks(make: Maker, point_format: int, kept: int) -> None:
    path = make(".laz", point_format, count=120_000)
    whole = las.read(path)
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * 0.95)])
    cloud = las.read(path)
    assert len(cloud) == kept
    np.testing.assert_array_equal(cloud.axes[0].raw, whole.axes[0].raw[:kept])
    assert f"{kept} of its 120000 points" in cloud.warnings[0]


def test_a_laz_with_a_damaged_chunk_table_is_read_through(make: Maker) -> None:
    path = make(".laz", 3, count=120_000)
    whole = las.read(path)
    raw = path.read_bytes()
    (start,) = struct.unpack_from("<I", raw, 96)
    (table,) = struct.unpack_from("<q", raw, start)
    cloud = las.read(patched(path, table + 4, struct.pack("<I", 0xFFFFFFF0)))
    np.testing.assert_array_equal(cloud.axes[2].raw, whole.axes[2].raw)


def test_a_laz_cut_before_its_first_chunk_ends_is_one_sentence(make: Maker) -> None:
    path = make(".laz", 6)
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(ScanError, match="holds no points though its header promises 3000"):
        las.read(path)


def test_a_truncated_las_gives_its_whole_records(make: Maker) -> None:
    path = make(".las", 1)
    path.write_bytes(path.read_bytes()[:-30])
    cloud = las.read(path)
    assert len(cloud) == 2998
    assert cloud.warnings == ("scan1.las: ends early: 2998 of its 3000 points are there",)


@pytest.mark.parametrize("suffix", [".las", ".laz"])
@pytest.mark.parametrize(
    ("offset", "value"),
    [
        (107, b"\xff\xff\xff\xff"),  # points
        (100, b"\xff\xff\xff\xff"),  # variable length records
        (94, b"\xff\xff"),  # length of the header
    ],
)
def test_counts_beyond_the_file_cost_nothing(make: Maker, suffix: str, offset: int, value: bytes) -> None:
    path = patched(make(suffix, 3), offset, value)
    las.read(make(suffix, 1))  # so that loading the decoder is not measured
    tracemalloc.start()
    result = outcome(path)
    assert tracemalloc.get_traced_memory()[1] < 100_000_000
    tracemalloc.stop()
    if suffix == ".las":
        assert isinstance(result, Cloud)
        assert len(result) == 3000


def test_a_wide_count_beyond_the_file_costs_nothing(make: Maker) -> None:
    path = patched(make(".laz", 6), 247, struct.pack("<Q", 1 << 60))
    cloud = las.read(path)
    assert len(cloud) == 3000
    assert "3000 of its" in cloud.warnings[0]


@pytest.mark.parametrize(
    ("offset", "value", "sentence"),
    [
        (0, b"PLY ", "does not begin with LASF"),
        (96, struct.pack("<I", 99), "begin at byte 99, inside the header"),
        (96, struct.pack("<I", 1 << 31), "the file ends at byte"),
        (104, b"\x0b", "point format 11"),
        (105, b"\x05\x00", "records of 5 bytes"),
        (107, b"\0\0\0\0", "holds no points"),
        (131, struct.pack("<d", 0), "scales x by 0"),
        (139, struct.pack("<d", np.nan), "scales y by nan"),
        (155, struct.pack("<d", np.inf), "shifts it by inf"),
    ],
)
def test_an_impossible_header_is_one_sentence(make: Maker, offset: int, value: bytes, sentence: str) -> None:
    error = outcome(patched(make(".las", 3), offset, value))
    assert isinstance(error, ScanError)
    assert sentence in str(error)


@pytest.mark.parametrize("size", [0, 3, 100, 226])
def test_a_file_shorter_than_the_header_is_one_sentence(make: Maker, size: int) -> None:
    path = make(".las", 0)
    path.write_bytes(path.read_bytes()[:size])
    assert isinstance(outcome(path), ScanError)


def test_a_missing_file_and_a_folder_are_one_sentence(tmp_path: Path) -> None:
    assert isinstance(outcome(tmp_path / "none.las"), ScanError)
    assert isinstance(outcome(tmp_path), ScanError)


@pytest.mark.parametrize(
    ("point_format", "suffix"), [(0, ".las"), (7, ".las"), (0, ".laz"), (3, ".laz"), (6, ".laz"), (8, ".laz")]
)
def test_flipped_and_missing_bytes_give_a_cloud_or_a_sentence(
    make: Maker, point_format: int, suffix: str
) -> None:
    path = make(suffix, point_format, count=300)
    raw = path.read_bytes()
    start = struct.unpack_from("<I", raw, 96)[0] + 80
    rng = np.random.default_rng(7)
    for turn in range(150):
        damaged = bytearray(raw)
        reach = start if turn % 2 else len(raw)
        for at in rng.integers(0, reach, rng.integers(1, 5)):
            damaged[at] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged[: rng.integers(len(raw)) if turn % 5 == 0 else None])
        result = outcome(path)
        assert isinstance(result, ScanError) or len(result) <= 1 << 20


def test_reading_leaves_the_slow_libraries_alone(make: Maker) -> None:
    script = (
        "import sys; from pathlib import Path; from stepfield.scan import las; las.read(Path(sys.argv[1]));"
        "assert not {'rasterio', 'laspy', 'pye57'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", script, str(make(".laz", 3))], check=True)


def wkt_record(text: str) -> Any:
    return laspy.VLR("LASF_Projection", 2112, record_data=text.encode() + b"\0")


PLAN = 'PROJCS["p",GEOGCS["g",UNIT["degree",0.017]],PROJECTION["x"],UNIT["{}",{}]]'


@pytest.mark.parametrize(
    ("text", "unit", "warnings"),
    [
        (PLAN.format("metre", 1), "m", 0),
        (PLAN.format("foot", 0.3048), "ft", 0),
        (PLAN.format("US survey foot", 0.304800609601219), "us-ft", 0),
        (PLAN.format("US survey foot", "1.0"), "us-ft", 0),
        (PLAN.format("link", 0.2), None, 0),
        ('GEOGCS["g",UNIT["degree",0.017]]', None, 1),
        ('COMPD_CS["c",' + PLAN.format("metre", 1) + ',VERT_CS["v",UNIT["foot",0.3048]]]', "m", 1),
        ('COMPD_CS["c",' + PLAN.format("metre", 1) + ',VERT_CS["v",UNIT["metre",1]]]', "m", 0),
        (
            'PROJCRS["p",BASEGEOGCRS["g",ANGLEUNIT["degree",0.017]],CS[Cartesian,2],'
            'AXIS["e",east,ORDER[1],LENGTHUNIT["metre",1]],AXIS["n",north,LENGTHUNIT["metre",1]]]',
            "m",
            0,
        ),
        ('GEODCRS["g",CS[ellipsoidal,2],ANGLEUNIT["degree",0.017]]', None, 1),
        ('GEODCRS["g",CS[Cartesian,3],LENGTHUNIT["metre",1]]', "m", 0),
        ('GEOCCS["g",UNIT["metre",1]]', "m", 0),
        ('PROJCS["p"', None, 1),
        ("]" * 10, None, 1),
        ("[" * 1000, None, 1),
        ("\x01\x02", None, 1),
    ],
)
def test_the_unit_is_the_one_of_the_reference_system(
    make: Maker, text: str, unit: str | None, warnings: int
) -> None:
    cloud = las.read(make(".las", 6, vlrs=[wkt_record(text)]))
    assert cloud.unit == unit
    assert len(cloud.warnings) == warnings


@pytest.mark.parametrize(
    ("keys", "unit", "has_wkt"),
    [
        ({1024: 1, 3072: 26915, 3076: 9001}, "m", True),
        ({1024: 1, 3072: 2994}, "ft", True),
        ({1024: 1, 3072: 32767, 3076: 9003}, "us-ft", False),
        ({1024: 1, 3072: 1999, 3076: 9002}, "ft", False),
        ({1024: 2, 2048: 4326}, None, False),
        ({}, None, False),
    ],
)
def test_geotiff_keys_tell_unit_and_system(keys: dict[int, int], unit: str | None, has_wkt: bool) -> None:
    numbers = [1, 1, 0, len(keys), *(n for key, value in keys.items() for n in (key, 0, 1, value))]
    reference = crs.from_geo_keys(struct.pack(f"<{len(numbers)}H", *numbers))
    assert (reference.unit, reference.wkt is not None) == (unit, has_wkt)
    assert bool(reference.warnings) == (keys.get(1024) == 2)


def test_heights_in_another_unit_are_remarked() -> None:
    numbers = [1, 1, 0, 3, 1024, 0, 1, 1, 3076, 0, 1, 9001, 4099, 0, 1, 9002]
    reference = crs.from_geo_keys(struct.pack(f"<{len(numbers)}H", *numbers))
    assert "heights in ft" in reference.warnings[0]


WHOLE = [
    "3dfier__ahn3_cropped_2.laz",
    "PDAL__1.2-with-color.las",
    "PDAL__4_6_crop.las",
    "PDAL__autzen_trim.laz",
    "PDAL__autzen_trim_7.las",
    "PDAL__lone-star.copc.laz",
    "ign-pdal-tools__las_with_origin_dsmMarker.laz",
    "ign-pdal-tools__sample_lareunion_epsg2975.laz",
    "ign-pdal-tools__test_data_77050_627755_LA93_IGN69.laz",
    "ign-pdal-tools__test_data_77060_627755_LA93_IGN69.laz",
    "3dfier__ahn3_cropped_1.laz",
    "ign-pdal-tools__test_semis_2023_0292_6833_LA93_IGN69.laz",
    f"{ODD}/PDAL__faceraster_numerical_imprecision.laz",
    f"{ODD}/PDAL__laszip-generated_with2bytespadding.laz",
    f"{ODD}/PDAL__extrabytes.las",
    f"{ODD}/PDAL__spurious.las",
]


@pytest.mark.parametrize("name", WHOLE)
def test_real_files_are_read_as_laspy_reads_them(real_scan: Callable[[str], Path], name: str) -> None:
    path = real_scan(name)
    assert_like_laspy(las.read(path), path)


@pytest.mark.parametrize(
    ("name", "count", "unit", "warnings"),
    [
        ("LASzip__5points_14.las", 5, None, 0),
        ("PDAL__1.0_0.las", 1, "m", 0),
        ("PDAL__1.0_1.las", 1, "m", 0),
        ("PDAL__1.1_0.las", 1, "m", 0),
        ("PDAL__1.1_1.las", 1, "m", 0),
        ("PDAL__1.2-empty-geotiff-vlrs.las", 43, "m", 0),
        ("PDAL__1.2_0.las", 1, "m", 0),
        ("PDAL__1.2_1.las", 1, "m", 0),
        ("PDAL__1.2_2.las", 1, "m", 0),
        ("PDAL__1.2_3.las", 1, "m", 0),
        ("PDAL__autzen-dd.las", 1065, None, 1),
        ("PDAL__bad-geotiff-keys.las", 10, "m", 0),
        ("PDAL__bad_vlr_count.las", 10, "m", 0),
        ("PDAL__epsg_4326.las", 5380, None, 1),
        ("PDAL__garbage_nVariableLength.las", 718, None, 1),
        ("PDAL__gps-time-nan.las", 1, None, 0),
        ("PDAL__hextest.las", 8, None, 0),
        ("PDAL__interesting.las", 1065, "ft", 0),
        ("PDAL__lots_of_vlr.las", 1, "us-ft", 0),
        ("PDAL__noise-dirty.las", 1065, None, 0),
        ("PDAL__prec3.las", 110, "ft", 0),
        ("PDAL__simple-laszip-compressor-version-1.2r0.laz", 1065, None, 0),
        ("PDAL__spec_3.las", 10, "m", 0),
        ("PDAL__synthetic_test.las", 1, None, 0),
        ("PDAL__test1_4.las", 1000, "us-ft", 0),
        ("PDAL__test_epsg_4047.las", 10, None, 1),
        ("PDAL__test_epsg_4326_axis.las", 10, None, 1),
        ("PDAL__wontcompress3.las", 1000, "m", 0),
    ],
)
def test_odd_real_files_give_their_points(
    real_scan: Callable[[str], Path], name: str, count: int, unit: str | None, warnings: int
) -> None:
    cloud = las.read(real_scan(f"{ODD}/{name}"))
    assert (len(cloud), cloud.unit, len(cloud.warnings)) == (count, unit, warnings)


def test_the_oldest_laszip_gives_the_points_of_its_uncompressed_twin(
    real_scan: Callable[[str], Path],
) -> None:
    old = las.read(real_scan(f"{ODD}/PDAL__simple-laszip-compressor-version-1.2r0.laz"))
    twin = las.read(real_scan("PDAL__1.2-with-color.las"))
    for ours, theirs in zip(old.axes, twin.axes, strict=True):
        np.testing.assert_array_equal(ours.raw, theirs.raw)
    for name, values in twin.attributes.items():
        np.testing.assert_array_equal(old.attributes[name], values)


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("LASzip__broken_coder.laz", "coder 15"),
        ("LASzip__broken_compressor.laz", "LASzip kind 16"),
        ("LASzip__broken_size.laz", "current LASzip or PDAL"),
        ("LASzip__broken_type.laz", "items \\[6, 22\\]"),
        ("PDAL__1.2-no-points.las", "holds no points though its header promises 1065"),
        ("PDAL__no-points.las", "holds no points; "),
    ],
)
def test_hopeless_real_files_are_one_sentence(
    real_scan: Callable[[str], Path], name: str, sentence: str
) -> None:
    with pytest.raises(ScanError, match=sentence):
        las.read(real_scan(f"{ODD}/{name}"))
