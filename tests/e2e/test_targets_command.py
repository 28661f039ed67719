"""``build --target`` and ``export`` as an operator meets them: the same bytes, one line of failure."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.e2e.test_command import failure, stepfield

from stepfield.project import Project, ScanFile

NAMES = ("mesh", "geotiff", "gazebo", "usarsim")
TARGETS = [word for name in NAMES for word in ("--target", name)]


def contents(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scan") / "table.ply"
    assert stepfield("synth", "table", "-o", path, "--points", 20000).returncode == 0
    return path


@pytest.fixture(scope="module")
def built(scan: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("built") / "out"
    done = stepfield("build", scan, "-o", folder, "--cell", 0.2, *TARGETS)
    assert done.returncode == 0, done.stderr
    assert "  gazebo/  " in done.stdout
    assert "warning: geotiff: the scan has no coordinate reference system" in done.stderr
    return folder


def test_build_and_export_make_the_same_bytes(built: Path, tmp_path: Path) -> None:
    done = stepfield("export", built, *TARGETS, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "out").iterdir()} == set(NAMES)
    for name in NAMES:
        assert contents(tmp_path / "out" / name) == contents(built / name)
    assert stepfield("check", built).returncode == 0


def test_a_project_is_exported_without_a_stack(scan: Path, built: Path, tmp_path: Path) -> None:
    project = tmp_path / "p.stepfield"
    made = Project(scans=(ScanFile(path=Project.stored_path(scan, project)),))
    made.model_copy(update={"parameters": made.parameters.model_copy(update={"cell_size": 0.2})}).save(
        project
    )
    done = stepfield("export", project, "--target", "mesh", "-o", tmp_path / "out", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["folder"] == str(tmp_path / "out")
    assert "layer_00.glb" in told["targets"]["mesh"]["files"]
    assert contents(tmp_path / "out" / "mesh") == contents(built / "mesh")


def test_targets_of_a_build_are_in_its_json(scan: Path, tmp_path: Path) -> None:
    told = json.loads(
        stepfield("build", scan, "-o", tmp_path / "out", "--target", "geotiff", "--json").stdout
    )
    assert told["format"] == "stepfield-stack"
    assert told["targets"]["geotiff"]["files"][0] == "layer_00.tif"
    plain = json.loads(stepfield("build", scan, "-o", tmp_path / "plain", "--json").stdout)
    assert "targets" not in plain


def test_a_built_stack_is_replaced_with_its_targets(scan: Path, tmp_path: Path) -> None:
    first = ("build", scan, "-o", tmp_path / "out", "--cell", 0.5)
    assert stepfield(*first, "--target", "mesh").returncode == 0
    assert stepfield(*first, "--target", "geotiff", "--overwrite").returncode == 0
    assert not (tmp_path / "out" / "mesh").exists()
    assert (tmp_path / "out" / "geotiff" / "layer_00.tif").exists()


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("--target", "unity"), 2, "unknown target 'unity'; choose among mesh, geotiff, mujoco"),
        ((), 2, "no target is named"),
        (("--target", "mesh", "--thicken", "-1"), 2, "impossible thicken -1.0"),
        (("--target", "mesh", "--decimate", "nan"), 2, "impossible decimate nan"),
    ],
)
def test_wrong_usage_is_one_line(
    built: Path, tmp_path: Path, arguments: tuple[str, ...], code: int, said: str
) -> None:
    assert said in failure(stepfield("export", built, "-o", tmp_path / "out", *arguments), code)
    assert not (tmp_path / "out").exists()


def test_an_unknown_target_is_found_before_the_scan_is_read(tmp_path: Path) -> None:
    done = stepfield("build", tmp_path / "absent.ply", "-o", tmp_path / "out", "--target", "unity")
    assert "unknown target" in failure(done, 2)


def test_what_is_no_stack_is_one_line(built: Path, tmp_path: Path) -> None:
    def refusal(source: Path) -> str:
        return failure(stepfield("export", source, "-o", tmp_path / "out", "--target", "mesh"), 1)

    assert "cannot read the stack" in refusal(tmp_path)
    assert "absent" in refusal(tmp_path / "absent")
    newer = tmp_path / "newer"
    newer.mkdir()
    document = json.loads((built / "manifest.json").read_text()) | {"version": 2}
    (newer / "manifest.json").write_text(json.dumps(document))
    assert "newer Stepfield" in refusal(newer)
    assert not (tmp_path / "out").exists()


def test_a_build_whose_target_fails_leaves_nothing(tmp_path: Path) -> None:
    """Two points two kilometres apart: a stack, but no world of UT2004."""
    far = tmp_path / "far.xyz"
    far.write_text("".join(f"{x} {y} 0\n" for x in (0, 1, 2, 2500) for y in (0, 1, 2)))
    done = stepfield("build", far, "-o", tmp_path / "out", "--cell", 1, "--target", "usarsim")
    assert "the world of UT2004 ends at" in failure(done, 1)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["far.xyz"]
