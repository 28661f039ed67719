"""Projects and parameters: what is saved comes back, and what is damaged is one sentence."""

import json
from pathlib import Path

import pytest

from stepfield.errors import ParameterError, ProjectError
from stepfield.parameters import Parameters
from stepfield.project import ExistingLayer, LayerStyle, Move, Project, ScanFile

PROJECT = Project(
    scans=(ScanFile(path="scan.ply", sha256="ab"),),
    parameters=Parameters(cell_size=0.1, crop=(0, 0, 0, 1, 1, 1), classes=(6, 2)),
    layers=(LayerStyle(index=1, name='Tisch "β"', locked=True),),
    moves=(
        Move(
            text="Move 1 pillar to Layer 3",
            to=ExistingLayer(layer=2, of=3, elevation=1.03),
            pillars=((600000.1, 5400000.2, 600000.2, 5400000.3, 0.1, 0.30000000000000004),),
        ),
        Move(to="unassigned", conflict="leave", pillars=()),
    ),
)


def test_a_project_comes_back_equal_to_the_last_digit(tmp_path: Path) -> None:
    PROJECT.save(tmp_path / "a.stepfield")
    assert Project.read(tmp_path / "a.stepfield") == PROJECT


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
