"""The real window, worked with a real mouse under Xvfb, and its pictures taken by the command."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from tests.conftest import REPOSITORY
from tests.e2e.homes import environment, left_running

from stepfield.scan.write import write
from stepfield.synth import synthesise

#: A room, a hillside with a bridge, a collapsed building.
ROOM, AHN, RUBBLE = "data__room_scan1.pcd", "3dfier__ahn3_cropped_2.laz", "rubble.laz"
SCANS = (ROOM, AHN, RUBBLE)


@dataclass(frozen=True)
class Driven:
    """What came of working the window."""

    report: dict[str, Any]
    folder: Path
    scans: dict[str, Path]


@pytest.fixture(scope="module")
def driven(
    display: str, tmp_path_factory: pytest.TempPathFactory, real_scan: Callable[[str], Path]
) -> Driven:
    """Work the window: all there is on one scan, then two more in the same window."""
    folder = tmp_path_factory.mktemp("driven")
    scans = {name: real_scan(name) for name in (ROOM, AHN)} | {RUBBLE: folder / RUBBLE}
    made = synthesise("rubble", 150_000, scanner=True)
    write(scans[RUBBLE], made.points, {"surface": made.surface})
    done = subprocess.run(
        [sys.executable, "-m", "tests.e2e.drive_window", str(folder), *map(str, scans.values())],
        cwd=REPOSITORY,
        env=environment(folder, display),
        capture_output=True,
        text=True,
        timeout=400,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr, "the window wrote to the terminal"
    return Driven(json.loads((folder / "report.json").read_text()), folder, scans)


@pytest.mark.parametrize("scan", SCANS)
def test_everything_can_be_done_with_the_mouse(driven: Driven, scan: str) -> None:
    assert driven.report["failure"] is None, driven.report
    assert driven.report["welcome"], "an empty window offers nothing"
    report = driven.report[scan]
    for name in ("tolerance", "alpha", "cell_size"):
        assert report[name]["steps"] == 1, f"a drag of {name} is not one undo step"
        assert report[name]["answers"] >= 2, f"the result does not follow the slider of {name}"
    assert report["orbited"]
    assert report["profile"] > 0, "the profile that was drawn has no points"
    assert report["cropped"] > 0


def test_a_crop_is_undone_and_a_dead_drawing_process_comes_back(driven: Driven) -> None:
    report = driven.report[ROOM]
    assert report["undone"], "undo does not give the cropped points back"
    assert report["came back"], "the document noticed that the drawing process died"
    assert not left_running(driven.folder)


@pytest.mark.parametrize("name", SCANS)
def test_the_exported_stack_is_the_commands(driven: Driven, name: str, tmp_path: Path) -> None:
    scan, given = driven.scans[name], driven.report[name]["exported"]
    assert (given["crop"] is None) == (name == ROOM), "the crop was not taken along, or not undone"
    options = {
        "cell_size": "--cell",
        "alpha": "--alpha",
        "layer_tolerance": "--tolerance",
        "link_step": "--link-step",
    }
    words = [word for name, option in options.items() for word in (option, repr(given[name]))]
    if given["crop"]:
        words.append(f"--crop={','.join(map(repr, given['crop']))}")
    built = tmp_path / "stack"
    subprocess.run(
        [sys.executable, "-m", "stepfield", "build", str(scan), "-o", str(built), *words],
        check=True,
        capture_output=True,
    )
    exported = driven.folder / scan.stem
    assert sorted(path.name for path in exported.iterdir()) == sorted(path.name for path in built.iterdir())
    for path in exported.glob("*.png"):
        assert path.read_bytes() == (built / path.name).read_bytes(), (
            f"{path.name} differs from the command's"
        )
    ours, theirs = (json.loads((place / "manifest.json").read_text()) for place in (exported, built))
    assert ours == theirs


def test_pictures_show_the_scan(driven: Driven) -> None:
    for name in ("opened", "large", "cropped", Path(AHN).stem, Path(RUBBLE).stem):
        picture = Image.open(driven.folder / f"{name}.png").convert("RGB")
        colours = picture.getcolors(picture.width * picture.height)
        assert colours is not None
        assert len(colours) > 500, f"{name}.png shows next to nothing"


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_a_picture_without_a_screen(real_scan: Callable[[str], Path], tmp_path: Path, theme: str) -> None:
    scan, file = real_scan("data__room_scan1.pcd"), tmp_path / "window.png"
    done = view(tmp_path, str(scan), "--screenshot", str(file), "--size", "1280x720", "--theme", theme)
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    picture = Image.open(file)
    assert picture.size == (1280, 720)
    ground = np.asarray(picture.convert("L"), int).mean()
    assert (ground < 90) if theme == "dark" else (ground > 160)
    assert not left_running(tmp_path)


def test_what_cannot_be_opened_is_one_sentence(tmp_path: Path) -> None:
    damaged = tmp_path / "damaged.ply"
    damaged.write_bytes(b"ply\nformat binary_little_endian 1.0\nelement vertex 5\n")
    done = view(tmp_path, str(damaged), "--screenshot", str(tmp_path / "window.png"))
    assert done.returncode == 1
    assert done.stderr.startswith("error: damaged.ply")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "window.png").exists()
    assert not left_running(tmp_path)


def test_no_display_is_one_sentence(tmp_path: Path) -> None:
    done = view(tmp_path)
    assert done.returncode == 1
    assert "there is no display" in done.stderr
    assert done.stderr.count("\n") == 1


def test_impossible_sizes_are_refused(tmp_path: Path) -> None:
    done = view(tmp_path, "--screenshot", str(tmp_path / "window.png"), "--size", "99999x2")
    assert done.returncode == 2
    assert "1600x1000" in done.stderr


def view(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run ``stepfield view`` where there is no screen."""
    return subprocess.run(
        [sys.executable, "-m", "stepfield", "view", *words],
        env=environment(folder, None),
        capture_output=True,
        text=True,
        timeout=180,
        check=False,
    )
