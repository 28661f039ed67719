"""Folders of targets: whole or not there, never in the way of anything else."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.core.targets.stacks import asymmetric, stack_of

from stepfield.errors import Cancelled, ParameterError, StackError, TargetError
from stepfield.targets import NAMES, WHAT, usarsim
from stepfield.targets.target import Options, Written
from stepfield.targets.terrain import Terrain
from stepfield.targets.writing import checked, limits, wishes, write_targets

OURS = ("mesh", "geotiff", "gazebo", "usarsim")


def contents(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_every_target_says_what_it_writes_and_has_its_module() -> None:
    assert NAMES == ("mesh", "geotiff", "mujoco", "pybullet", "gazebo", "usarsim")
    assert all(len(what) < 90 for what in WHAT.values())


@pytest.mark.parametrize("name", NAMES)
def test_each_has_its_folder_with_steps_and_numbers(
    name: str, asymmetric_stack: Path, tmp_path: Path
) -> None:
    written = write_targets(asymmetric_stack, [name], tmp_path / "out")
    found = contents(tmp_path / "out" / name)
    assert set(found) == {*written[name].files, "target.json"}
    document = json.loads(found["target.json"])
    assert document["format"] == "stepfield-target"
    assert (document["target"], document["local_origin"]) == (name, [0, 0, 0])
    readme = found["README.txt"].decode()
    assert "Layers, the lowest first" in readme
    assert "0.25 m apart" in readme
    assert all(note in readme for note in written[name].notes)
    assert set(limits(Terrain.of_stack(asymmetric_stack), name)) <= set(written[name].notes)
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize("name", NAMES)
def test_the_same_stack_makes_the_same_bytes(name: str, asymmetric_stack: Path, tmp_path: Path) -> None:
    for folder in ("a", "b"):
        write_targets(asymmetric_stack, [name], tmp_path / folder)
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


def test_a_target_that_fails_leaves_none(
    asymmetric_stack: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(terrain: Terrain, folder: Path, options: Options) -> Written:
        (folder / "half").touch()
        raise TargetError("usarsim: too large")

    monkeypatch.setattr(usarsim, "write", fail)
    with pytest.raises(TargetError):
        write_targets(asymmetric_stack, OURS, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_stopping_leaves_nothing(asymmetric_stack: Path, tmp_path: Path) -> None:
    def stop(share: float, what: str) -> None:
        if "gazebo" in what:
            raise Cancelled

    with pytest.raises(Cancelled):
        write_targets(asymmetric_stack, OURS, tmp_path / "out", progress=stop)
    assert not list(tmp_path.iterdir())


def test_only_targets_are_replaced_and_only_when_asked(asymmetric_stack: Path, tmp_path: Path) -> None:
    write_targets(asymmetric_stack, ["mesh"], tmp_path)
    (tmp_path / "mine.txt").touch()
    with pytest.raises(StackError, match="not empty; use --overwrite"):
        write_targets(asymmetric_stack, ["mesh", "geotiff"], tmp_path)
    assert not (tmp_path / "geotiff").exists()
    thick = write_targets(asymmetric_stack, ["mesh"], tmp_path, Options(thicken=0.1), overwrite=True)
    assert "0.1 m thick" in (tmp_path / "mesh" / "README.txt").read_text()
    assert set(contents(tmp_path / "mesh")) == {*thick["mesh"].files, "target.json"}
    (tmp_path / "geotiff").mkdir()
    (tmp_path / "geotiff" / "map.tif").touch()
    with pytest.raises(StackError, match="other than a target"):
        write_targets(asymmetric_stack, ["geotiff"], tmp_path, overwrite=True)
    assert (tmp_path / "mine.txt").exists()


def test_names_are_checked_and_come_once() -> None:
    assert checked(["gazebo", "mesh", "gazebo"]) == ("mesh", "gazebo")
    with pytest.raises(ParameterError, match="unknown target 'unity'; choose among mesh, geotiff"):
        checked(["mesh", "unity"])


@pytest.mark.parametrize("length", [0.0, -1.0, float("nan"), float("inf"), 1e9])
def test_lengths_have_to_be_some(length: float) -> None:
    with pytest.raises(ParameterError, match="impossible thicken"):
        wishes(length, None, None)
    with pytest.raises(ParameterError, match="impossible decimate"):
        wishes(None, length, None)


def test_a_stack_that_is_none_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(StackError, match="cannot read the stack"):
        write_targets(tmp_path, ["mesh"], tmp_path / "out")
    damaged = stack_of(tmp_path / "s", asymmetric())
    (damaged / "layer_01.png").write_bytes(b"no image")
    with pytest.raises(StackError, match="damaged"):
        write_targets(damaged, ["mesh"], tmp_path / "out")
    assert not (tmp_path / "out").exists()
