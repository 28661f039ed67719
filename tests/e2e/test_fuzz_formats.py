"""Real scans of every format, damaged at random: each is read or refused in one sentence, whatever it says.

The seeds are fixed, so that a failure can be repeated: ``python tests/e2e/fuzz.py SCAN SEED 1 FOLDER``.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.e2e import fuzz

from stepfield.errors import ScanError
from stepfield.scan import read_scan

REPEATS = 25
FORMATS = {
    "ply": "CSF__sample.ply",
    "pcd compressed": "plane_seg__06.pcd",
    "pcd ascii": "plane_seg__terrain_close_rect.pcd",
    "pcd binary": "plane_seg__tilted-steps.pcd",
    "las": "PDAL__4_6_crop.las",
    "laz": "PDAL__autzen_trim.laz",
    "copc": "PDAL__lone-star.copc.laz",
    "e57": "pye57__pumpAVisualReferenceImage.e57",
    "ptx": "PDAL__1.2-with-color.ptx",
    "xyz": "libpointmatcher__apartment_cloud_0_converted.xyz",
    "csv": "libpointmatcher__car_cloud400.csv",
    "pts": "PDAL__autzen.pts",
    "npy": "PDAL__1.2-with-color.npy",
    "obj": "PDAL__1.2-with-color.obj",
}


@pytest.mark.parametrize("kind", FORMATS)
def test_a_damaged_scan_is_read_or_refused(
    real_scan: Callable[[str], Path], tmp_path: Path, kind: str
) -> None:
    """A crash, a hang, a warning of numpy's, a lying count that takes all memory: each would show here."""
    scan = real_scan(FORMATS[kind])
    done = subprocess.run(
        [sys.executable, fuzz.__file__, scan, "0", str(REPEATS), tmp_path],
        env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=fuzz.SECONDS * REPEATS,
        check=False,
    )
    lines = done.stdout.splitlines()
    end = "it took too long" if done.returncode == -signal.SIGALRM else f"it ended with {done.returncode}"
    assert done.returncode == 0, f"{scan.name}, seed {lines[-1:]}: {end}; {done.stderr[-2000:]}"
    told = json.loads(lines[-1])
    assert told["faults"] == [], scan.name
    assert told["peak"] < fuzz.BYTES, f"{scan.name} took {told['peak'] >> 20} MB"
    assert sum(told["figures"].values()) == REPEATS


def test_the_damage_is_the_same_for_a_seed_and_another_for_another() -> None:
    """Without that a failure could not be repeated, or the repeats would try one thing only."""
    content = bytes(range(256)) * 40
    assert fuzz.damaged(content, 3, ".las") == fuzz.damaged(content, 3, ".las")
    assert len({fuzz.damaged(content, seed, ".las") for seed in range(40)}) > 30


def test_e57_pages_are_signed_anew() -> None:
    """With a wrong checksum every damage of an E57 file would be refused for that alone."""
    assert fuzz.checksum(bytearray(b"123456789")) == 0xE3069283  # the check value of CRC-32C


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("header.npy", b"\x93NUMPY\x02\x00" + b"\xff" * 8, "its header claims 4294967295 bytes"),
        ("quoted.pcd", b"VERSION .7\nFIELDS x y z\nSIZE 4 4 \x03\nTYPE F F F\nDATA ascii\n", r"\\x03"),
        ("far.xyz", b"1e200 0 0\n0 1e308 0\n", "only 2 that are not finite"),
    ],
)
def test_what_longer_campaigns_found_stays_mended(
    tmp_path: Path, name: str, content: bytes, words: str
) -> None:
    """Room for a header that is not there, control characters in a sentence, squares that overflow."""
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ScanError, match=words) as refused:
        read_scan([tmp_path / name])
    assert str(refused.value).isprintable()


def test_points_too_far_to_compute_with_are_dropped_and_counted(tmp_path: Path) -> None:
    """Damage makes numbers of 1e300 whose differences and squares are infinite."""
    (tmp_path / "far.xyz").write_text("1 2 3\n1e200 0 0\n-1e308 1e308 0\n4 5 6\n")
    scan = read_scan([tmp_path / "far.xyz"])
    assert len(scan) == 2
    assert scan.removed["not finite"] == 2


def test_a_signalling_nan_is_dropped_without_a_word(tmp_path: Path) -> None:
    """Flipped bits make NaNs of a kind that numpy warns of whenever it converts them."""
    odd = np.array([[1, 2, 3], [4, 5, 6]], "<f4")
    odd.view("<u4")[1, 2] = 0x7F800001
    (tmp_path / "odd.pcd").write_bytes(
        b"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nDATA binary\n" + odd.tobytes()
    )
    assert len(read_scan([tmp_path / "odd.pcd"])) == 1
