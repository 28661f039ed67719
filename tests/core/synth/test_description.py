"""Scenes from JSON: what is described is drawn, what is wrong is said in one sentence."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stepfield.errors import SceneError
from stepfield.synth import SyntheticScan, synthesise
from stepfield.synth.description import Description

PLANE = {"kind": "plane", "size": [2, 1]}


def write(folder: Path, content: Any) -> Path:
    path = folder / "scene.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return path


def drawn(folder: Path, *objects: dict[str, Any], **more: Any) -> SyntheticScan:
    return synthesise(write(folder, {"objects": objects, **more}))


def test_all_kinds_with_pose_points_and_noise(tmp_path: Path) -> None:
    scan = drawn(
        tmp_path,
        {"kind": "plane", "name": "floor", "size": [4, 4], "points": 100, "noise": 0},
        {"kind": "box", "size": [1, 1, 1], "position": [0, 0, 0.5], "without": ["bottom"], "points": 200},
        {"kind": "sphere", "radius": 0.5, "position": [5, 6, 7], "points": 300, "noise": 0},
        {"kind": "cylinder", "radius": 0.2, "height": 3, "rotation": [90, 0, 0], "points": 400, "caps": True},
        noise=0.001,
    )
    assert scan.names == ("floor", "box 2", "sphere 3", "cylinder 4")
    assert np.bincount(scan.surface).tolist() == [100, 200, 300, 400]
    sphere = scan.points[scan.surface == 2]
    assert np.abs(np.linalg.norm(sphere - [5, 6, 7], axis=1) - 0.5).max() < 1e-9
    lying = scan.points[scan.surface == 3]
    assert np.ptp(lying[:, 1]) == pytest.approx(3, abs=0.05)


def test_objects_without_a_number_share_the_rest_by_area(tmp_path: Path) -> None:
    larger = {"kind": "plane", "size": [2, 3]}
    scan = drawn(tmp_path, {**PLANE, "points": 50}, PLANE, larger, points=400)
    assert np.bincount(scan.surface).tolist() == [50, 100, 300]


def test_points_and_noise_asked_for_win_over_the_file(tmp_path: Path) -> None:
    path = write(tmp_path, {"objects": [{**PLANE, "points": 300, "noise": 0.5}, {**PLANE, "points": 100}]})
    scan = synthesise(path, points=40, noise=0.0)
    assert np.bincount(scan.surface).tolist() == [30, 10]
    assert np.all(scan.points[:, 2] == 0)


def test_noise_may_go_every_way(tmp_path: Path) -> None:
    scan = drawn(tmp_path, {**PLANE, "points": 20_000, "noise": 0.1, "noise_kind": "isotropic"})
    assert scan.points[:, 2].std() == pytest.approx(0.1, rel=0.05)
    assert np.ptp(scan.points[:, 0]) > 2.2


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("", "not valid JSON"),
        ('{"objects": [}', "line 1 column"),
        ("[" * 5000, "not valid JSON"),
        ("[]", "should be an object"),
        ({}, "field objects: is missing"),
        ({"objects": []}, "at least one object"),
        ({"objects": [{"kind": "cube"}]}, "object 1, field kind: should be plane, box, sphere or cylinder"),
        ({"objects": [{"size": [1, 1]}]}, "object 1, field kind: is missing"),
        (
            {"objects": [PLANE, {"kind": "sphere", "radius": -1}]},
            r"object 2 \(sphere\), field radius: .*than 0, not -1",
        ),
        ({"objects": [{"kind": "sphere"}]}, r"object 1 \(sphere\), field radius: is missing"),
        ({"objects": [{"kind": "plane", "size": [1, float("nan")]}]}, r"field size\[1\]: .*finite"),
        ({"objects": [{"kind": "plane", "size": [1, float("inf")]}]}, r"field size\[1\]: .*finite"),
        ({"objects": [{**PLANE, "position": [0, float("nan"), 0]}]}, r"field position\[1\]: .*finite"),
        ({"objects": [{**PLANE, "colour": "red"}]}, r"object 1 \(plane\), field colour: no such field"),
        ({"objects": [{**PLANE, "points": 0}]}, "field points: .*greater than or equal to 1"),
        ({"objects": [{**PLANE, "points": 10**9 + 1}]}, "field points: .*less than or equal to 1000000000"),
        ({"objects": [{**PLANE, "points": "many"}]}, "field points: .*integer"),
        ({"objects": [{**PLANE, "points": 6 * 10**8}] * 2}, "1,200,000,000 points in all"),
        ({"objects": [{**PLANE, "noise": -0.1}]}, "field noise: .*greater than or equal to 0"),
        ({"objects": [{**PLANE, "holes": [[1, 0, 0, 1]]}]}, r"a hole is \[x0, y0, x1, y1\]"),
        ({"objects": [{**PLANE, "holes": [[-9, -9, 9, 9]]}]}, "leave nothing of the plane"),
        ({"objects": [{"kind": "box", "size": [1, 1, 1], "holes": [[-1, 0, 0.1, 0.2]]}]}, "inside its rim"),
        ({"objects": [{"kind": "box", "size": [1, 1, 1], "without": ["lid"]}]}, r"without\[0\]: .*'bottom'"),
        ({"objects": [PLANE], "noise": -1}, "field noise: "),
        ({"objects": [PLANE], "title": "x"}, "field title: no such field"),
    ],
)
def test_what_is_wrong_is_said_in_one_sentence(tmp_path: Path, content: Any, sentence: str) -> None:
    with pytest.raises(SceneError, match=sentence) as caught:
        synthesise(write(tmp_path, content))
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith("scene.json")


def test_shafts_of_a_box_must_not_overlap(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="must not overlap"):
        drawn(tmp_path, {"kind": "box", "size": [4, 4, 1], "holes": [[-1, -1, 1, 1], [0, 0, 1.5, 1.5]]})


def test_a_box_needs_a_face(tmp_path: Path) -> None:
    faces = ["bottom", "top", "south", "north", "west", "east"]
    with pytest.raises(SceneError, match="without any face"):
        drawn(tmp_path, {"kind": "box", "size": [1, 1, 1], "without": faces})


def test_bytes_that_are_no_text(tmp_path: Path) -> None:
    path = tmp_path / "scene.json"
    path.write_bytes(b"\xff\xfe\x00{")
    with pytest.raises(SceneError, match="not valid JSON"):
        synthesise(path)


def test_a_file_too_large_to_be_a_description(tmp_path: Path) -> None:
    path = tmp_path / "scene.json"
    path.write_bytes(b" " * (17 * 2**20))
    with pytest.raises(SceneError, match="larger than 16 MiB"):
        synthesise(path)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=8,
)


FILE_FIELDS = st.sampled_from([*Description.model_fields, "else"])
OBJECT_FIELDS = st.sampled_from(
    ["kind", "size", "radius", "height", "holes", "points", "noise", "position", "without", "name"]
)
KINDS = st.sampled_from(["plane", "box", "sphere", "cylinder"])
NEEDED: dict[str, dict[str, Any]] = {
    "plane": {"size": [1, 1]},
    "box": {"size": [1, 1, 1]},
    "sphere": {"radius": 1},
    "cylinder": {"radius": 1, "height": 1},
}


@settings(deadline=None)
@given(content=st.dictionaries(FILE_FIELDS, JSON, max_size=4))
def test_no_file_ends_in_another_error(
    tmp_path_factory: pytest.TempPathFactory, content: dict[str, Any]
) -> None:
    path = write(tmp_path_factory.mktemp("scene"), content)
    with pytest.raises(SceneError):
        synthesise(path, points=10)


@settings(deadline=None)
@given(kind=KINDS, fields=st.dictionaries(OBJECT_FIELDS, JSON, max_size=4))
def test_no_object_ends_in_another_error(
    tmp_path_factory: pytest.TempPathFactory, kind: str, fields: dict[str, Any]
) -> None:
    described = {"kind": kind, **NEEDED[kind], **fields}
    path = write(tmp_path_factory.mktemp("scene"), {"objects": [described]})
    try:
        said = str(len(synthesise(path, points=10)))
    except SceneError as error:
        said = str(error)
    assert "\n" not in said
