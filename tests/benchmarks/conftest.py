"""Benchmarks print figures and judge nothing: run them with ``python -m pytest tests/benchmarks -s``."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

#: Points of the large cloud; fewer for a quick look.
POINTS = int(float(os.environ.get("STEPFIELD_BENCHMARK_POINTS", "1e7")))
#: Real scans, and what SURFACES.md calls them.
REAL = {
    "data__room_scan1.pcd": "room_scan1",
    "3dfier__ahn3_cropped_2.laz": "ahn3_cropped_2",
    "pye57__pumpAVisualReferenceImage.e57": "pump",
    "ign-pdal-tools__test_data_77050_627755_LA93_IGN69.laz": "IGN tile 77050",
    "ign-pdal-tools__test_data_77060_627755_LA93_IGN69.laz": "IGN tile 77060",
    "ign-pdal-tools__sample_lareunion_epsg2975.laz": "La Réunion, slope",
    "ign-pdal-tools__test_semis_2023_0292_6833_LA93_IGN69.laz": "IGN 1 km tile",
    "CSF__sample.ply": "CSF hills",
}


def seconds(work: Callable[[], object], runs: int = 3) -> float:
    """Least time of a few runs: what the machine needs when nobody else disturbs it."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


@dataclass
class Table:
    """Figures of one run, each beside the floor it is measured against."""

    rows: list[tuple[str, float, str, float, str]] = field(default_factory=list)

    def add(self, what: str, took: float, floor_name: str, floor: float, target: str = "") -> None:
        """Note a time, its floor and the target as a ratio or a limit."""
        self.rows.append((what, took, floor_name, floor, target))

    def text(self) -> str:
        """Return the table, ready to read."""
        head = f"{'what':52} {'seconds':>9}  {'floor':34} {'seconds':>9} {'ratio':>7}  target"
        lines = [
            f"{what:52} {took:9.4f}  {name:34} {floor:9.4f} {took / floor:7.2f}  {target}"
            for what, took, name, floor, target in self.rows
        ]
        return "\n".join(
            ["", f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores", head, *lines]
        )


@pytest.fixture(scope="session")
def table() -> Iterator[Table]:
    """Collect figures and print them at the end."""
    table = Table()
    yield table
    print(table.text())  # noqa: T201 - printing is what a benchmark is for


@pytest.fixture(scope="module")
def lines(request: pytest.FixtureRequest) -> Iterator[list[str]]:
    """Collect the rows of a module's table and print them under its head at the end."""
    collected: list[str] = []
    yield collected
    print("\n".join(["", request.module.HEAD, *collected]))  # noqa: T201 - printing is what a benchmark is for


@pytest.fixture(scope="session")
def storeys() -> NDArray[np.float32]:
    """Three undulating storeys, 100 m by 100 m, in random order: the worst for caches."""
    rng = np.random.default_rng(20240607)
    plan = rng.random((POINTS, 2), dtype=np.float32) * np.float32(99.99)
    z = rng.integers(0, 3, POINTS) * 1.5 + 0.3 * np.sin(plan[:, 0] / 10) + rng.normal(0, 0.02, POINTS)
    return np.column_stack([plan, z.astype(np.float32)])


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where large files go."""
    return tmp_path_factory.mktemp("benchmarks")
