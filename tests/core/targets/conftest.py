"""The stacks that every target is tried with, each built once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.core.targets.stacks import asymmetric, stack_of

from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.scan.write import write
from stepfield.stack import write_stack
from stepfield.synth import synthesise

#: Name, and what it is built with.
SCENES: dict[str, dict[str, Any]] = {
    "table": {"cell_size": 0.1, "layer_tolerance": 0.3},
    "bridge": {"cell_size": 0.25, "layer_tolerance": 0.5},
    "ramp": {"cell_size": 0.25, "layer_tolerance": 0.5},
}
STACKS = ("asymmetric", *SCENES, "room_scan1")


@pytest.fixture(scope="session")
def find_stack(
    tmp_path_factory: pytest.TempPathFactory, real_scan: Callable[[str], Path]
) -> Callable[[str], Path]:
    """Find one of the stacks by name; a real scan that is absent skips the test."""
    folder = tmp_path_factory.mktemp("stacks")

    def find(name: str) -> Path:
        if (folder / name).exists():
            return folder / name
        if name == "asymmetric":
            return stack_of(folder / name, asymmetric())
        if name in SCENES:
            scan = folder / f"{name}.ply"
            write(scan, synthesise(name, 200_000).points, {})
        else:
            scan = real_scan("data__room_scan1.pcd")
        parameters = Parameters(**SCENES.get(name, {"cell_size": 0.1}), reconstruction="simulator")
        write_stack(Pipeline().run([scan], parameters), folder / name)
        return folder / name

    return find


@pytest.fixture(scope="session", params=STACKS)
def stack(request: pytest.FixtureRequest, find_stack: Callable[[str], Path]) -> Path:
    """Give every one of the stacks in turn."""
    return find_stack(request.param)


@pytest.fixture(scope="session")
def asymmetric_stack(find_stack: Callable[[str], Path]) -> Path:
    """Give the stack whose every height is known."""
    return find_stack("asymmetric")
