"""Every odd or broken file of the collection, with what a right reader makes of it written down beforehand.

The numbers come from the collection's notes, from the headers and from the files themselves, not from this
program: a number is how many points must be read, words are part of the one sentence that refuses the file.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from tests.conftest import SCANS
from tests.e2e.guarded import BYTES, Outcome, run_all

ODD = SCANS.parent / "scans-malformed"

EXPECTED: dict[str, int | str] = {
    "LASzip__5points_14.las": 5,
    "LASzip__broken_coder.laz": "coder 15",
    "LASzip__broken_compressor.laz": "LASzip kind 16",
    "LASzip__broken_size.laz": "is packed in a way that cannot be read",
    "LASzip__broken_type.laz": "items [6, 22]",
    "PDAL__1.0_0.las": 1,
    "PDAL__1.0_1.las": 1,
    "PDAL__1.1_0.las": 1,
    "PDAL__1.1_1.las": 1,
    "PDAL__1.2-empty-geotiff-vlrs.las": 43,
    "PDAL__1.2-no-points.las": "holds no points though its header promises 1065",
    "PDAL__1.2_0.las": 1,
    "PDAL__1.2_1.las": 1,
    "PDAL__1.2_2.las": 1,
    "PDAL__1.2_3.las": 1,
    "PDAL__A4.e57": 4,
    "PDAL__A4_moved.e57": 4,
    "PDAL__A_B.e57": 6,
    "PDAL__A_B_different_dims.e57": 2,
    "PDAL__A_merged_B.e57": 6,
    "PDAL__A_moved_B.e57": 6,
    "PDAL__B2.e57": 2,
    "PDAL__autzen-dd.las": 1065,
    "PDAL__autzen-utm.pcd": 1065,  # its header's POINTS; the fields are named in capitals
    "PDAL__bad-geotiff-keys.las": 10,
    "PDAL__bad_vlr_count.las": 10,
    "PDAL__badheader.txt": 8,  # names x twice and no z
    "PDAL__box.obj": 8,
    "PDAL__bunny_8.pts": 9,  # announces 8, holds 9
    "PDAL__complex-transform.ptx": 4,  # 12 rows, of which 8 are beams that hit nothing
    "PDAL__crlf_test.txt": 10,
    "PDAL__crlf_test2.txt": 10,
    "PDAL__data.xyz": 400,
    "PDAL__decimate_file_grid.txt": 81,
    "PDAL__duplicates-sorted.txt": 7,
    "PDAL__duplicates-unsorted.txt": 7,
    "PDAL__epsg_4326.las": 5380,
    "PDAL__extrabytes.las": 1065,
    "PDAL__faceraster_numerical_imprecision.laz": 18074,
    "PDAL__file1.txt": 9,
    "PDAL__file2.txt": 9,
    "PDAL__file3.txt": 9,
    "PDAL__garbage_nVariableLength.las": 718,  # room for 718.7 records of the 719 promised
    "PDAL__gps-time-nan.las": 1,
    "PDAL__hextest.las": 8,
    "PDAL__interesting.las": 1065,
    "PDAL__issue_2421.ply": 1,
    "PDAL__largescan.txt": 6,
    "PDAL__laszip-generated_with2bytespadding.laz": 1065,
    "PDAL__lots_of_vlr.las": 1,
    "PDAL__mesh.ply": 4,
    "PDAL__mesh_fixed.ply": 4,
    "PDAL__missingheader.pcd": 10,  # rows of text without a header
    "PDAL__missingheader.txt": 5,
    "PDAL__multiple-and-transform.ptx": 8,  # two scans of four
    "PDAL__no-color.ptx": 15,
    "PDAL__no-points.las": "holds no points; ",
    "PDAL__no_vertex.obj": "holds no points",
    "PDAL__no_vertex.ply": "no vertex element",
    "PDAL__noise-dirty.las": 1065,
    "PDAL__numeric_dim.txt": 5,
    "PDAL__prec3.las": 110,
    "PDAL__quoted.txt": 9,
    "PDAL__quoted2.txt": 9,
    "PDAL__simple-laszip-compressor-version-1.2r0.laz": 1065,  # the oldest LASzip, which others refuse
    "PDAL__simple_binary.obj": 3,
    "PDAL__simple_binary.ply": 3,
    "PDAL__simple_text.ply": 3,  # a blank behind the word ply
    "PDAL__site_56_8.pts": 8,
    "PDAL__sized_dims.ply": "its vertices have no z",
    "PDAL__spec_3.las": 10,
    "PDAL__spurious.las": 1065,
    "PDAL__synthetic_test.las": 1,
    "PDAL__test.pts": 19,
    "PDAL__test1_4.las": 1000,
    "PDAL__test_epsg_4047.las": 10,
    "PDAL__test_epsg_4326_axis.las": 10,
    "PDAL__text.txt": "no row of numbers",
    "PDAL__text_extradim.ply": 1,
    "PDAL__threedim.npy": "its records stand in 3 dimensions",
    "PDAL__twodim.npy": "its records stand in 2 dimensions",
    "PDAL__unsized_dims.ply": "its vertices have no z",
    "PDAL__utm17_1.txt": 10,
    "PDAL__utm17_2.txt": 10,
    "PDAL__utm17_3.txt": 11,  # blank lines, and a fourth number in one row
    "PDAL__utm17_comma.pcd": 10,
    "PDAL__utm17_space.pcd": 10,
    "PDAL__utm17_tab.pcd": 10,
    "PDAL__with_edgeofflightline.txt": 10000,
    "PDAL__wontcompress3.las": 1000,
    "assimp-testmodels__cube.ply": 8,
    "assimp-testmodels__cube_binary.ply": 8,
    "assimp-testmodels__cube_uv.ply": 24,
    "assimp-testmodels__empty.ply": "is no PLY file",
    "assimp-testmodels__float-color.ply": 3,
    "assimp-testmodels__issue623.ply": 24,  # declares a list that its rows do not have
    "assimp-testmodels__points.ply": 4,
    "assimp-testmodels__pond.0.ply": 69409,  # bytes are lost: 70048 whole records, 639 of them not finite
    "libE57Format-test-data__bad-crc.e57": "checksum mismatch",
    "pye57__testWithNormals.e57": 2,
    "pye57__translationWithoutRotation.e57": 4,
}

#: Files that can be read but not built into a stack.
UNBUILDABLE = {"assimp-testmodels__pond.0.ply": "has points 3.4e+38 m away"}


@pytest.fixture(scope="module")
def folder() -> Path:
    if not ODD.is_dir():
        pytest.skip(f"{ODD} is absent; set STEPFIELD_SCANS to the folder of real scans beside it")
    return ODD


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the stacks go, one folder a file."""
    return tmp_path_factory.mktemp("built")


@pytest.fixture(scope="module")
def outcomes(folder: Path, built: Path) -> dict[str, Outcome]:
    """Read and build every file, each in a process of its own."""
    there = [name for name in EXPECTED if (folder / name).exists()]
    jobs = {f"read {name}": ["read", str(folder / name)] for name in there}
    jobs |= {f"build {name}": ["build", str(folder / name), "-o", str(built / name)] for name in there}
    return run_all(jobs)


def test_the_table_names_every_file_and_no_other(folder: Path) -> None:
    """A file nobody has judged, or a judgement of a file that is gone, would make the table a fiction."""
    there = {path.name for path in folder.iterdir() if path.suffix != ".md"}
    assert there - EXPECTED.keys() == set(), "files without an expectation"
    assert EXPECTED.keys() - there == set(), "expectations without a file"


def _bounded(outcome: Outcome) -> None:
    """Check what holds for every file, whatever its content."""
    assert outcome.code != -14, "it did not end within the time"
    assert outcome.code >= 0, f"killed by signal {-outcome.code}: {outcome.stderr}"
    assert outcome.peak < BYTES, f"took {outcome.peak >> 20} MB"
    assert "Traceback" not in outcome.stderr, outcome.stderr


def _one_error(outcome: Outcome, words: str) -> None:
    """Check that a failure is one line that says what is expected."""
    assert outcome.code == 1, outcome.stderr
    assert outcome.stdout == ""
    (line,) = [line for line in outcome.stderr.splitlines() if not line.startswith("warning: ")]
    assert line.startswith("error: ")
    assert words in line


@pytest.mark.parametrize("name", EXPECTED)
def test_a_file_is_read_as_its_content_demands(outcomes: dict[str, Outcome], name: str) -> None:
    outcome, expected = outcomes[f"read {name}"], EXPECTED[name]
    _bounded(outcome)
    if isinstance(expected, str):
        _one_error(outcome, expected)
        assert name in outcome.stderr, "the sentence does not say which file"
        return
    assert outcome.code == 0, outcome.stderr
    assert int(outcome.stdout) == expected


@pytest.mark.parametrize("name", EXPECTED)
def test_a_build_ends_in_a_stack_or_in_one_sentence(
    outcomes: dict[str, Outcome], built: Path, name: str
) -> None:
    outcome, expected = outcomes[f"build {name}"], UNBUILDABLE.get(name, EXPECTED[name])
    _bounded(outcome)
    if isinstance(expected, str):
        _one_error(outcome, expected)
        assert not (built / name).exists(), "a refused file left a folder behind"
    else:
        assert outcome.code == 0, outcome.stderr
        assert re.fullmatch(r"(warning: .+\n)*", outcome.stderr), outcome.stderr
        assert (built / name / "manifest.json").is_file()
    assert not list(built.glob(".*")), "hidden folders were left behind"
