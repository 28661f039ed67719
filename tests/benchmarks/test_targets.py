"""Targets of a large stack: four layers of 1024 by 1024, three of them full of holes."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.benchmarks.conftest import Table
from tests.benchmarks.test_whole import BUILD_AND_TELL_PEAK
from tests.core.targets.stacks import large, stack_of

from stepfield.targets import NAMES


@pytest.mark.parametrize("names", [*((name,) for name in NAMES), NAMES], ids=lambda names: "+".join(names))
def test_exporting(table: Table, tmp_path: Path, names: tuple[str, ...]) -> None:
    stack = stack_of(tmp_path / "stack", large(), cell=0.05, west=-20, south=-20)
    wanted = [word for name in names for word in ("--target", name)]
    command = [sys.executable, "-c", BUILD_AND_TELL_PEAK, "export", str(stack), "-o", str(tmp_path / "out")]
    start = time.perf_counter()
    told = subprocess.run([*command, *wanted], check=True, capture_output=True, text=True)
    took = time.perf_counter() - start
    peak = int(told.stderr.split()[-1]) / 1024
    size = sum(path.stat().st_size for path in (tmp_path / "out").rglob("*") if path.is_file()) / 1e6
    what = names[0] if len(names) == 1 else "all targets"
    table.add(f"export of 4 x 1024 x 1024 to {what}, {size:.0f} MB", took, "60 s for all", 60, "<= 1")
    table.add(f"  peak memory {peak:.0f} MB, in MB", peak, "1500 MB", 1500, "<= 1")
    shutil.rmtree(tmp_path)  # pytest would keep two gigabytes
