"""A whole correction in the real window: by mouse alone, then by keyboard alone."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.conftest import REPOSITORY
from tests.e2e.correction import CEILING, TABLE_TOP, Patch
from tests.e2e.homes import environment, left_running

from stepfield.project import Project, ScanFile
from stepfield.stack.read import Stack

SCAN = "data__room_scan1.pcd"
#: Seconds after which a part of a correction will never end, on a busy machine too; and between two looks.
PATIENCE, LOOK = 400.0, 0.05
HANDS = ("mouse", "keyboard")


@dataclass(frozen=True)
class Corrected:
    """What came of a correction.

    Attributes
    ----------
    edited, recovered : dict
        What was true in the window that was killed, and in the one after it.
    folder, scan : Path
    """

    edited: dict[str, Any]
    recovered: dict[str, Any]
    folder: Path
    scan: Path

    @property
    def stack(self) -> Path:
        """Where the window has put the stack."""
        return Path(self.recovered["stack"])

    def built(self, project: Project | None = None) -> Path:
        """Build a stack of the saved project, or of another one beside it."""
        file = self.folder / "room.stepfield"
        if project is not None:
            file = file.with_stem("other")
            project.save(file)
        folder = self.folder / file.stem
        stepfield("build", "--project", file, "-o", folder)
        return folder


@pytest.fixture(scope="module", params=HANDS)
def corrected(
    request: pytest.FixtureRequest,
    display: str,
    tmp_path_factory: pytest.TempPathFactory,
    real_scan: Callable[[str], Path],
) -> Corrected:
    """Carry the correction out; the window is killed in the middle of it."""
    hand, scan, folder = request.param, real_scan(SCAN), tmp_path_factory.mktemp(request.param)
    file = scan
    if hand == "mouse":  # which types no name of a file
        file = folder / "room.stepfield"
        Project(scans=(ScanFile(path=str(scan)),)).save(file)
    edited = until_killed([hand, str(file), str(folder)], folder, environment(folder, display))
    done = subprocess.run(
        command(hand, str(folder)),
        cwd=REPOSITORY,
        env=environment(folder, display),
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert not done.stderr, "the window wrote to the terminal"
    return Corrected(edited, json.loads((folder / "recovered.json").read_text()), folder, scan)


def command(*words: str) -> list[str]:
    """What drives the window."""
    return [sys.executable, "-m", "tests.e2e.drive_correction", *words]


def until_killed(words: list[str], folder: Path, own: dict[str, str]) -> dict[str, Any]:
    """Edit until there is something to lose, then kill the window; return what it said."""
    window = subprocess.Popen(command(*words), cwd=REPOSITORY, env=own, stderr=subprocess.PIPE, text=True)
    ready, given_up = folder / "ready.json", time.monotonic() + PATIENCE
    while window.poll() is None and not ready.exists() and time.monotonic() < given_up:
        time.sleep(LOOK)
    window.kill()  # as kill -9 does
    _, said = window.communicate()
    failed = folder / "edited.json"
    assert ready.exists(), failed.read_text() if failed.exists() else said or "the window took too long"
    assert not said, "the window wrote to the terminal"
    while left_running(folder) and time.monotonic() < given_up:
        time.sleep(LOOK)
    assert not left_running(folder), "the process that draws has outlived the window"
    content: dict[str, Any] = json.loads(ready.read_text())
    return content


def stepfield(*words: object) -> str:
    """Run the command, and return what it says."""
    done = subprocess.run(
        [sys.executable, "-m", "stepfield", *map(str, words)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_correction_can_be_carried_out(corrected: Corrected) -> None:
    edited = corrected.edited
    of_layer, in_all = edited["selected"]
    assert of_layer == in_all > 0, "the selection reaches beyond the layer"
    assert edited["moved"] == in_all, "more or less than the selection was moved"
    assert edited["undone"], "undo does not give the layers back"
    assert edited["redone"], "redo does not move the same pillars"
    assert edited["cell sizes"][0] != edited["cell sizes"][1]
    for said, (_, count) in zip(
        edited.get("said", ()), (edited["selected"], edited["selected then"]), strict=False
    ):
        assert said == f"move {count}", "the row does not say what a drop does"


def test_nothing_is_lost_when_the_window_is_killed(corrected: Corrected) -> None:
    recovered = corrected.recovered
    assert recovered["failure"] is None, recovered
    assert len(recovered["offers"]) == 1
    assert "room.stepfield" in recovered["offers"][0]
    assert recovered["recovered"] == 2, "a move is lost"
    assert recovered["dirty"], "what was recovered is taken for saved"
    assert not recovered["messages left"]
    assert not left_running(corrected.folder)
    drafts = corrected.folder / "state" / "stepfield" / "recovery"
    assert not list(drafts.iterdir()), "edits that are saved are kept on"


def test_the_stack_is_sound_and_the_commands(corrected: Corrected) -> None:
    stepfield("check", corrected.stack, "--scan", corrected.scan)
    built = corrected.built()
    names = sorted(path.name for path in built.iterdir())
    assert sorted(path.name for path in corrected.stack.iterdir()) == names
    for name in names:
        assert (corrected.stack / name).read_bytes() == (built / name).read_bytes(), f"{name} differs"


def test_what_was_moved_is_in_the_other_layer_and_nothing_else_differs(corrected: Corrected) -> None:
    project = Project.read(corrected.folder / "room.stepfield")
    before = Stack.open(corrected.built(project.model_copy(update={"moves": ()})))
    after = Stack.open(corrected.stack)
    then, now = corrected.edited["cell sizes"]
    moved_area = corrected.edited["selected"][1] * then**2
    for patch, least, most in (
        (TABLE_TOP, 0.6 * moved_area / now**2, 1.5 * moved_area / now**2),
        (CEILING, corrected.edited["selected then"][1], corrected.edited["selected then"][1]),
    ):
        left, came = (different(before, after, layer) for layer in (patch.wrong, patch.right))
        assert np.array_equal(left, came), "what left one layer did not come to the other"
        assert least <= np.count_nonzero(came) <= most
        assert not (came & ~near(patch, after)).any(), "pillars elsewhere have changed"
        emptied = np.isnan(after.elevations(after.manifest.layers[patch.wrong]))
        assert emptied[left].all(), "nothing was in the way, yet something has come back"


def different(one: Stack, other: Stack, layer: int) -> NDArray[np.bool_]:
    """Return in which compartments a layer of two stacks differs, shape (rows, columns)."""
    before, after = (stack.elevations(stack.manifest.layers[layer]) for stack in (one, other))
    return ~np.isclose(before, after, rtol=0, atol=1e-9, equal_nan=True)


def near(patch: Patch, stack: Stack) -> NDArray[np.bool_]:
    """Return which compartments touch a patch or are beside it, shape (rows, columns)."""
    grid = stack.grid
    side = grid.cell_size
    x = grid.west + (np.arange(grid.columns) + 0.5) * side
    y = grid.south + (grid.rows - np.arange(grid.rows) - 0.5) * side
    in_x = (x > patch.west - side) & (x < patch.east + side)
    in_y = (y > patch.south - side) & (y < patch.north + side)
    return in_y[:, None] & in_x[None, :]
