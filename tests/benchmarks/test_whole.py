"""Whole processes: start, read, build, write. Ten times the points should cost about ten times the time."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from tests.benchmarks.conftest import Table, seconds

from stepfield.scan.write import write

#: Clouds to build; the largest need disk space and minutes, so they are asked for by name.
SIZES = [int(float(size)) for size in os.environ.get("STEPFIELD_BENCHMARK_SIZES", "1e6 1e7").split()]
SUFFIX = os.environ.get("STEPFIELD_BENCHMARK_SUFFIX", ".ply")

#: The command, then its own peak memory in KiB: wait4 would count what this process held when it began.
BUILD_AND_TELL_PEAK = """
import sys
from stepfield.cli import run
code = run(sys.argv[1:])
with open("/proc/self/status") as status:
    sys.stderr.write(next(line.split()[1] for line in status if line.startswith("VmHWM")))
sys.exit(code)
"""


def cloud(path: Path, points: int) -> None:
    """Write three undulating storeys of 100 m by 100 m."""
    rng = np.random.default_rng(20240607)
    plan = rng.random((points, 2), dtype=np.float32) * np.float32(99.99)
    z = rng.integers(0, 3, points) * np.float32(1.5) + np.float32(0.3) * np.sin(plan[:, 0] / 10)
    z += rng.normal(0, 0.02, points).astype(np.float32)
    write(path, np.column_stack([plan, z]), {})


@pytest.mark.parametrize("points", SIZES)
def test_building(table: Table, folder: Path, points: int) -> None:
    path = folder / f"cloud{SUFFIX}"
    child = os.fork()
    if not child:  # in a process of its own, so that the making does not count as the building's memory
        cloud(path, points)
        os._exit(0)
    os.waitpid(child, 0)
    arguments = ["build", str(path), "-o", str(folder / "out"), "--overwrite"]
    arguments += ["--cell", "0.25", "--tolerance", "0.3"]
    start = time.perf_counter()
    command = [sys.executable, "-c", BUILD_AND_TELL_PEAK, *arguments]
    told = subprocess.run(command, check=True, capture_output=True, text=True)
    took = time.perf_counter() - start
    peak = int(told.stderr) / 1024
    floor, size = seconds(lambda: path.read_bytes(), 1), path.stat().st_size
    bound = 400 + 60e-6 * points
    name = f"build of {points / 1e6:g} M points, {SUFFIX[1:]}, {size / 1e6:.0f} MB"
    table.add(name, took, "its bytes, read once", floor)
    table.add(f"  peak memory {peak:.0f} MB, in MB", peak, "400 MB and 60 bytes a point", bound, "<= 1")
    path.unlink()
