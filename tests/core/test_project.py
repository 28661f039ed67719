"""Projects and parameters: what is saved comes back, and what is damaged is one sentence."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stepfield.boxes import Boxes
from stepfield.errors import ParameterError, ProjectError
from stepfield.parameters import Parameters
from stepfield.project import ExistingLayer, LayerStyle, Move, NewLayer, Project, ScanFile

SAMPLES = Path(__file__).parent / "samples"
PROJECT = Project(
    scans=(ScanFile(path="scan.ply", sha256="ab"),),
    parameters=Parameters(cell_size=0.1, layering="elevation", crop=(0, 0, 0, 1, 1, 1), classes=(6, 2)),
    layers=(LayerStyle(index=1, name='Tisch "β"', locked=True),),
    moves=(
        Move(
            text="Move 1 pillar to Layer 3",
            to=ExistingLayer(layer=2, of=3, elevation=1.03),
            pillars=((600000.1, 5400000.2, 600000.2, 5400000.3, 0.1, 0.30000000000000004),),
        ),
        Move(to="unassigned", conflict="leave", pillars=()),
        Move(to=NewLayer(new="Shelf"), layer=ExistingLayer(layer=0, of=3, elevation=0.5), above=0.75),
        Move(to=ExistingLayer(layer=0, of=3, elevation=0), layer=NewLayer(new="Shelf"), conflict="fewest"),
    ),
)


A_LAYER = '{"layer": 0, "of": 2, "elevation": 0}'


def moved(rest: str) -> str:
    """Return the text of a project of one move."""
    return '{"format": "stepfield-project", "moves": [{"to": "unassigned", ' + rest + "}]}"


def test_a_project_comes_back_equal_to_the_last_digit(tmp_path: Path) -> None:
    PROJECT.save(tmp_path / "a.stepfield")
    assert Project.read(tmp_path / "a.stepfield") == PROJECT


def test_an_equal_project_is_the_same_bytes(tmp_path: Path) -> None:
    PROJECT.save(tmp_path / "a.stepfield")
    Project.read(tmp_path / "a.stepfield").save(tmp_path / "b.stepfield")
    assert (tmp_path / "a.stepfield").read_bytes() == (tmp_path / "b.stepfield").read_bytes()


@pytest.mark.parametrize("name", ["version_1_first.stepfield", "version_1.stepfield"])
def test_projects_of_the_past_keep_loading(name: str) -> None:
    """The first was written before layers could be merged, split, exchanged or removed."""
    project = Project.read(SAMPLES / name)
    assert project.layers == (LayerStyle(index=1, name='Tisch "β"', locked=True),)
    first, second = project.moves[:2]
    assert first == PROJECT.moves[0]
    assert (second.to, second.conflict, len(second.pillars)) == ("unassigned", "leave", 0)
    if name == "version_1.stepfield":
        assert project == PROJECT


def test_boxes_are_equal_by_value_and_can_not_be_changed() -> None:
    """A history holds them many times over: what is shared must never change."""
    rows = np.arange(12.0).reshape(2, 6)
    one, other = Boxes(rows), Boxes(rows.tolist())
    rows[0, 0] = 99
    assert one == other
    assert hash(one) == hash(other)
    assert one != Boxes(rows)
    assert one.array[0, 0] == 0
    with pytest.raises(ValueError, match="read-only"):
        one.array[0, 0] = 1
    assert Boxes(one.array).array is one.array
    assert np.asarray(one).shape == one.shape == (len(one), 6)


@pytest.mark.parametrize("rows", [[[1]], [[]], "six", None, [[[1, 2, 3, 4, 5, 6]]], [1, 2, 3, 4, 5, 6]])
def test_what_is_no_box_is_refused(rows: Any) -> None:
    with pytest.raises(ValueError, match="six numbers"):
        Boxes(rows)


def test_a_missing_parameter_takes_its_default(tmp_path: Path) -> None:
    file = tmp_path / "a.stepfield"
    file.write_text('{"format": "stepfield-project", "version": 1, "parameters": {"bits": 8}}')
    assert Project.read(file).parameters == Parameters(bits=8)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "it is not JSON"),
        ('{"format": "stepfield-project", "ver', "it is not JSON"),
        ("[" * 100_000, "it is not JSON"),
        ("[]", "not a project of Stepfield"),
        ('{"format": "stepfield-project", "version": 99}', "newer Stepfield"),
        ('{"format": "stepfield-project", "parameters": {"cell_size": -1}}', "parameters.cell_size"),
        ('{"format": "stepfield-project", "moves": [{"to": "up", "pillars": []}]}', "moves.0.to"),
        (
            '{"format": "stepfield-project", "moves": [{"to": "unassigned", "pillars": [[1]]}]}',
            "moves.0.pillars",
        ),
        (moved('"pillars": [[1, 2, 3, 4, 5, Infinity]]'), "moves.0.pillars"),
        (moved('"pillars": [[1, 2, 3, 4, 5, null]]'), "moves.0.pillars"),
        (moved('"pillars": {}'), "moves.0.pillars"),
        (moved('"above": 1.0'), "a layer is needed"),
        (moved('"conflict": "exchange"'), "a layer is needed"),
        (moved(f'"layer": {A_LAYER}, "pillars": [[0, 0, 1, 1, 0, 1]]'), "not both"),
        (moved(f'"layer": {A_LAYER}, "conflict": "exchange"'), "only two whole layers"),
    ],
)
def test_a_damaged_project_is_one_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    file = tmp_path / "bad.stepfield"
    file.write_text(text)
    with pytest.raises(ProjectError, match=sentence) as caught:
        Project.read(file)
    assert "\n" not in str(caught.value)


def test_a_project_that_cannot_be_saved_leaves_the_old_one_whole(tmp_path: Path) -> None:
    file = tmp_path / "a.stepfield"
    PROJECT.save(file)
    with pytest.raises(ProjectError, match="cannot write"):
        PROJECT.save(tmp_path / "missing" / "a.stepfield")
    assert Project.read(file) == PROJECT
    assert [path.name for path in tmp_path.iterdir()] == ["a.stepfield"]


@pytest.mark.parametrize(
    "values",
    [
        {"cell_size": -1},
        {"cell_size": 0},
        {"cell_size": float("nan")},
        {"cell_size": float("inf")},
        {"cell_size": True},
        {"alpha": "much"},
        {"bits": 12},
        {"min_points": 0},
        {"max_layers": "some"},
        {"crop": (0, 0, 0, 0, 1, 1)},
        {"classes": (300,)},
        {"layering": "surfaces"},
        {"unknown": 1},
    ],
)
def test_impossible_parameters_are_one_sentence_naming_the_parameter(values: dict[str, object]) -> None:
    with pytest.raises(ParameterError, match=next(iter(values))) as caught:
        Parameters.checked(**values)
    assert "\n" not in str(caught.value)


def test_paths_are_stored_relative_to_the_project(tmp_path: Path) -> None:
    (tmp_path / "scans").mkdir()
    stored = Project.stored_path(tmp_path / "scans" / "a.ply", tmp_path / "p.stepfield")
    project = Project(scans=(ScanFile(path=stored),))
    assert json.loads(project.model_dump_json())["scans"][0]["path"] == "scans/a.ply"
    assert project.scan_paths(tmp_path / "p.stepfield") == (tmp_path / "scans" / "a.ply",)
