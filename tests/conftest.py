"""What all tests share: small scans with known answers, and the real ones where they are present."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings
from numpy.typing import ArrayLike

from stepfield.scan import Axis, Scan

REPOSITORY = Path(__file__).parents[1]
SCANS = Path(os.environ.get("STEPFIELD_SCANS", REPOSITORY.parent / "shared" / "scans"))

# No test judges by the clock: the machine may be busy.
settings.register_profile("unhurried", deadline=None)
settings.load_profile("unhurried")


def scan_of_axes(x: Axis, y: Axis, z: Axis) -> Scan:
    """Make a scan of its three coordinates."""
    return Scan(x, y, z)


def scan_of(points: ArrayLike) -> Scan:
    """Make a scan of an (N, 3) array, metres, without copying it."""
    array = np.asarray(points).reshape(-1, 3)
    return scan_of_axes(*(Axis(array[:, i]) for i in range(3)))


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Begin with the longest files where cores share the tests: at the end all would wait for one of them."""
    if hasattr(config, "workerinput"):
        items.sort(key=lambda item: "e2e" not in item.path.parts)


@pytest.fixture(scope="session")
def real_scan() -> Callable[[str], Path]:
    """Find a real scan by name, skipping the test where the scans are absent."""

    def find(name: str) -> Path:
        path = SCANS / name
        if not path.exists():
            pytest.skip(f"{path} is absent; set STEPFIELD_SCANS to the folder of real scans")
        return path

    return find


@pytest.fixture(scope="session", autouse=True)
def interruptible() -> None:
    """Let children be interrupted even where the tests run in the background, which ignores SIGINT."""
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def no_stray_log_lines(caplog: pytest.LogCaptureFixture) -> Iterator[None]:
    """Fail a test that leaves warnings or errors in the log: nobody would read them."""
    yield
    stray = [record.getMessage() for record in caplog.get_records("call") if record.levelno >= 30]
    assert not stray, f"unexpected log lines: {stray}"
