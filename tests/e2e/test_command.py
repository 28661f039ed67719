"""The command as an operator meets it: exit codes, one line of failure, nothing half written."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stepfield.project import Move, Project, ScanFile
from stepfield.stack import Stack

COMMAND = [sys.executable, "-m", "stepfield"]


def stepfield(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run the command in a pipe."""
    return subprocess.run(
        [*COMMAND, *map(str, arguments)], capture_output=True, text=True, timeout=120, check=False, **options
    )


def failure(done: subprocess.CompletedProcess[str], code: int) -> str:
    """Return the one line of a failure, checking that it is all there is."""
    lines = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
    assert done.returncode == code, done.stderr
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith("error: ")
    assert done.stdout == ""
    return lines[0]


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scan") / "table.ply"
    assert stepfield("synth", "table", "-o", path, "--points", 20000).returncode == 0
    return path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def test_a_scan_becomes_a_stack_that_passes_its_check(table: Path, tmp_path: Path) -> None:
    built = stepfield("build", table, "-o", tmp_path / "out", "--cell", 0.1, "--tolerance", 0.3)
    assert built.returncode == 0, built.stderr
    assert "2 layers" in built.stdout
    checked = stepfield("check", tmp_path / "out", "--scan", table, "--json")
    assert checked.returncode == 0, checked.stderr
    report = json.loads(checked.stdout)
    assert report["ok"]
    assert report["fidelity"]["vertical"]["median"] < 0.01  # the legs, being upright, are not surfaces


def test_json_is_one_object_and_progress_stays_out_of_pipes(table: Path, tmp_path: Path) -> None:
    built = stepfield("build", table, "-o", tmp_path / "out", "--json")
    assert json.loads(built.stdout)["format"] == "stepfield-stack"
    assert all(line.startswith("warning: ") for line in built.stderr.splitlines())


def test_info_has_the_promised_keys(table: Path) -> None:
    told = json.loads(stepfield("info", table, "--json").stdout)
    assert sorted(told) == ["attributes", "bounds", "points", "suggested", "unit", "up"]
    assert told["points"] == 20000
    assert 0 < told["suggested"]["cell_size"] < 1


def test_a_project_builds_the_same_bytes_as_its_parts(table: Path, tmp_path: Path) -> None:
    project = Project(scans=(ScanFile(path=Project.stored_path(table, tmp_path / "p.stepfield")),))
    project.save(tmp_path / "p.stepfield")
    assert stepfield("build", "--project", tmp_path / "p.stepfield", "-o", tmp_path / "a").returncode == 0
    assert stepfield("build", table, "-o", tmp_path / "b").returncode == 0
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


def test_moves_of_a_project_reach_the_images(table: Path, tmp_path: Path) -> None:
    everything = Move(text="all of it", to="unassigned", pillars=((-2.1, -1.6, 2.1, 1.6, 0.6, 0.9),))
    lost = Move(text="nowhere", to="unassigned", pillars=((50, 50, 51, 51, 0, 1),))
    Project(scans=(ScanFile(path=str(table), sha256="of another file"),), moves=(everything, lost)).save(
        tmp_path / "p.stepfield"
    )
    built = stepfield("build", "--project", tmp_path / "p.stepfield", "-o", tmp_path / "out")
    assert built.returncode == 0
    assert "the scan has changed" in built.stderr
    assert "move 2 was not applied" in built.stderr
    manifest = Stack.open(tmp_path / "out").manifest
    assert (manifest.moves, manifest.moves_unresolved) == (2, 1)
    assert manifest.layers[1].pillars < 0.1 * manifest.layers[0].pillars


@pytest.mark.parametrize(
    ("arguments", "code", "sentence"),
    [
        (["--cell", "-1"], 2, "cell_size"),
        (["--cell", "nan"], 2, "cell_size"),
        (["--cell", "0.000001"], 1, "use at least"),
        (["--bits", "12"], 2, "bits"),
        (["--crop", "1,2,3"], 2, "crop"),
        (["--crop", "a,b"], 2, "crop"),
        (["--crop", "90,90,90,91,91,91"], 1, "crop box leaves no points"),
        (["--layering", "best"], 2, "layering"),
        (["--min-points", "100000"], 2, "min_points"),
        (["--sideways"], 2, "sideways"),
    ],
)
def test_impossible_wishes_are_one_line(
    table: Path, tmp_path: Path, arguments: list[str], code: int, sentence: str
) -> None:
    done = stepfield("build", table, "-o", tmp_path / "out", *arguments)
    assert sentence in failure(done, code)
    assert list(tmp_path.iterdir()) == []


def test_missing_things_are_one_line(tmp_path: Path, table: Path) -> None:
    assert "no such file" in failure(stepfield("build", tmp_path / "no.ply", "-o", tmp_path / "out"), 1)
    assert "not both" in failure(stepfield("build", "-o", tmp_path / "out"), 2)
    assert "unknown kind of file" in failure(stepfield("info", __file__), 1)
    assert "manifest" in failure(stepfield("check", tmp_path), 1)
    assert "three-planes" in failure(stepfield("synth", "castle", "-o", tmp_path / "a.ply"), 1)
    (tmp_path / "file").write_text("")
    assert "cannot" in failure(stepfield("build", table, "-o", tmp_path / "file" / "out"), 1)


def test_a_fault_found_by_check_is_exit_one_on_stdout(table: Path, tmp_path: Path) -> None:
    stepfield("build", table, "-o", tmp_path / "out")
    (tmp_path / "out" / "layer_00.png").unlink()
    done = stepfield("check", tmp_path / "out")
    assert done.returncode == 1
    assert "image is missing" in done.stdout


@pytest.mark.parametrize(
    "name", ["mit blank.ply", "größe.ply", 'it\'s "quoted".ply', "new\nline.ply", "-dash.ply"]
)
def test_odd_names_work(table: Path, tmp_path: Path, name: str) -> None:
    (tmp_path / name).symlink_to(table)
    done = stepfield("build", "-o", tmp_path / ("out of " + name), "--", tmp_path / name)
    assert done.returncode == 0, done.stderr
    assert Stack.open(tmp_path / ("out of " + name)).manifest.source.files[0].name == name


def test_closed_standard_streams_do_no_harm(table: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    line = f'"$@" build {table} -o {out} <&- | true; exit ${{PIPESTATUS[0]}}'
    done = subprocess.run(["bash", "-c", line, "bash", *COMMAND], capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr
    assert (out / "manifest.json").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_build_leaves_the_old_stack(tmp_path: Path, number: signal.Signals) -> None:
    """The signal comes as soon as the images are being written."""
    scan = tmp_path / "scan.npy"
    rng = np.random.default_rng(0)
    np.save(scan, rng.random((200_000, 3)) * [100, 100, 3])
    out = tmp_path / "out"
    first = stepfield("build", scan, "-o", out, "--cell", 1, "--tolerance", 0.5)
    assert first.returncode == 0, first.stderr
    before = contents(out)
    command = [
        *COMMAND,
        "build",
        str(scan),
        "-o",
        str(out),
        "--overwrite",
        "--cell",
        "0.02",
        "--tolerance",
        "0.1",
    ]
    running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while not list(tmp_path.glob(".out.*/layer_00.png")) and running.poll() is None:
        assert time.monotonic() < deadline
        os.sched_yield()
    running.send_signal(number)
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 130, errors
    assert "interrupted" in errors
    assert "Traceback" not in errors
    assert contents(out) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "scan.npy"]


def test_two_builds_into_one_folder_leave_one_whole_stack(table: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    stepfield("build", table, "-o", out)
    running = [
        subprocess.Popen([*COMMAND, "build", str(table), "-o", str(out), "--overwrite", "--cell", cell])
        for cell in ("0.1", "0.2", "0.05", "0.15")
    ]
    codes = [process.wait(timeout=120) for process in running]
    assert codes == [0, 0, 0, 0]
    assert stepfield("check", out).returncode == 0
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_help_and_version_answer() -> None:
    for arguments in (["--help"], ["build", "--help"], ["--version"]):
        assert stepfield(*arguments).returncode == 0
    assert "--tolerance" in stepfield("build", "--help").stdout


def test_completion_is_offered() -> None:
    environment = os.environ | {
        "_STEPFIELD_COMPLETE": "complete_bash",
        "COMP_WORDS": "stepfield bu",
        "COMP_CWORD": "1",
    }
    assert "build" in stepfield(env=environment).stdout


@pytest.mark.parametrize(
    ("name", "least", "most"), [("data__room_scan1.pcd", 3, 5), ("3dfier__ahn3_cropped_2.laz", 2, 4)]
)
def test_real_scans_yield_whole_stacks(
    real_scan: Callable[[str], Path], tmp_path: Path, name: str, least: int, most: int
) -> None:
    scan = real_scan(name)
    built = stepfield("build", scan, "-o", tmp_path / "out", "--json")
    assert built.returncode == 0, built.stderr
    assert least <= len(json.loads(built.stdout)["layers"]) <= most
    checked = stepfield("check", tmp_path / "out", "--scan", scan, "--json")
    assert checked.returncode == 0, checked.stdout
