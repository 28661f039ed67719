"""Clearance: the room between a pillar and what hangs above it, as an image a robot can trust."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from tests.conftest import scan_of

import stepfield_resources
from stepfield.clearance import clearance
from stepfield.compartments import sort_into_compartments
from stepfield.layers import classify
from stepfield.parameters import Parameters
from stepfield.pillars import build_pillars
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction
from stepfield.stack import Manifest, Stack, write_stack
from stepfield.stack.check import check_stack
from stepfield.targets import geotiff
from stepfield.targets.target import Options
from stepfield.targets.terrain import Terrain


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Reconstruction:
    rng = np.random.default_rng(4)
    floor = np.c_[rng.random((6000, 2)) * [3, 2], rng.normal(0, 0.01, 6000)]
    top = np.c_[rng.random((2000, 2)) + np.array([1, 0.5]), rng.normal(0.75, 0.01, 2000)]
    path = tmp_path_factory.mktemp("scan") / "table.npy"
    np.save(path, np.vstack([floor, top]) + np.array([600_000.25, 5_400_000.5, 300.0]))
    return Pipeline().run([path], Parameters(cell_size=0.1, clearance=True))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 3), st.floats(0, 5, width=16)), min_size=1, max_size=25), st.data())
def test_room_is_up_to_the_next_exported_pillar(drawn: list[tuple[int, float]], data: st.DataObject) -> None:
    points = np.array([[column + 0.5, 0.5, z] for column, z in drawn])
    field = build_pillars(sort_into_compartments(scan_of(points), 1.0), 0.5)
    layer = classify(field, "rank", max_layers="none").layer.copy()
    layer[data.draw(st.lists(st.integers(0, len(field) - 1), max_size=3))] = -1
    room = clearance(field, layer)
    for pillar in range(len(field)):
        above = [
            field.low[other] - field.elevation[pillar]
            for other in range(pillar + 1, len(field))
            if field.compartment[other] == field.compartment[pillar] and layer[other] >= 0
        ]
        if layer[pillar] < 0:
            assert np.isnan(room[pillar])
        else:
            assert room[pillar] == (pytest.approx(above[0]) if above else np.inf)


def test_a_robot_that_fits_by_the_map_fits(result: Reconstruction, tmp_path: Path) -> None:
    write_stack(result, tmp_path / "out")
    stack = Stack.open(tmp_path / "out")
    floor, top = stack.manifest.layers
    room = clearance(result.field, result.layering.layer)
    row, column = stack.grid.row_column(result.field.compartment[result.layers[0].pillars])
    read = stack.clearances(floor)
    assert read is not None
    assert floor.clearance is not None
    true, found = room[result.layers[0].pillars], read[row, column]
    assert np.array_equal(np.isinf(true), np.isinf(found))
    bounded = np.isfinite(true)
    assert np.all(found[bounded] <= true[bounded] + 1e-12)
    assert np.all(true[bounded] - found[bounded] < floor.clearance.scale * (1 + 1e-6))
    assert floor.clearance.least == pytest.approx(true[bounded].min())
    assert 0.7 < floor.clearance.least <= 0.75  # type: ignore[operator]
    assert top.clearance is not None
    assert top.clearance.pillars == 0
    assert top.clearance.least is None


def test_it_is_written_only_where_asked_for(result: Reconstruction, tmp_path: Path) -> None:
    parameters = result.parameters.model_copy(update={"clearance": False})
    source = tmp_path / "scan.npy"
    np.save(source, result.scan.points())
    write_stack(Pipeline().run([source], parameters), tmp_path / "without")
    assert not list((tmp_path / "without").glob("*clearance*"))
    write_stack(result, tmp_path / "with")
    names = {path.name for path in (tmp_path / "with").glob("*clearance*")}
    assert names == {"layer_00_clearance.png", "layer_01_clearance.png"}
    assert check_stack(tmp_path / "with").faults == ()
    document = json.loads((tmp_path / "with" / "manifest.json").read_text())
    jsonschema.validate(document, stepfield_resources.schema("stack"))
    assert document["layers"][0]["clearance"]["image"] == "layer_00_clearance.png"


def test_a_stack_from_before_there_was_any_still_loads(result: Reconstruction, tmp_path: Path) -> None:
    write_stack(result, tmp_path / "out")
    path = tmp_path / "out" / "manifest.json"
    document = json.loads(path.read_text())
    del document["parameters"]["clearance"]
    for layer in document["layers"]:
        del layer["clearance"]
    path.write_text(json.dumps(document))
    assert all(layer.clearance is None for layer in Manifest.of(tmp_path / "out").layers)
    assert check_stack(tmp_path / "out").faults == ()


def _edit(folder: Path, change: str) -> None:
    path = folder / "layer_00_clearance.png"
    pixels = np.asarray(Image.open(path)).copy()
    if change == "hole":
        pixels[0, 0] = 9
    elif change == "gone":
        pixels[pixels > 0] = 0
    else:
        pixels[np.nonzero(pixels)[0][0], np.nonzero(pixels)[1][0]] = 65535
    Image.fromarray(pixels).save(path)
    if change == "high":  # by the manifest's own word there is a metre more
        manifest = folder / "manifest.json"
        document = json.loads(manifest.read_text())
        entry = document["layers"][0]["clearance"]
        for name in ("offset", "least", "greatest"):
            entry[name] += 1.0
        manifest.write_text(json.dumps(document))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ("hole", "have room above where"),
        ("gone", "0 pixels where the manifest says"),
        ("high", "more room than there is below the next layer"),
    ],
)
def test_check_finds_what_is_wrong(
    result: Reconstruction, tmp_path: Path, change: str, sentence: str
) -> None:
    write_stack(result, tmp_path / "out")
    _edit(tmp_path / "out", change)
    assert any(sentence in fault for fault in check_stack(tmp_path / "out").faults)


def test_a_missing_map_is_a_fault(result: Reconstruction, tmp_path: Path) -> None:
    write_stack(result, tmp_path / "out")
    (tmp_path / "out" / "layer_00_clearance.png").unlink()
    assert any("is missing" in fault for fault in check_stack(tmp_path / "out").faults)


def test_geotiff_has_it_too(result: Reconstruction, tmp_path: Path) -> None:
    import rasterio

    write_stack(result, tmp_path / "stack")
    stack = Stack.open(tmp_path / "stack")
    (tmp_path / "tif").mkdir()
    written = geotiff.write(Terrain.of_stack(tmp_path / "stack"), tmp_path / "tif", Options())
    assert "layer_01_clearance.tif" in written.files
    with rasterio.open(tmp_path / "tif" / "layer_00_clearance.tif") as file:
        room, nodata = file.read(1), file.nodata
    read = stack.clearances(stack.manifest.layers[0])
    assert read is not None
    assert np.array_equal(room != nodata, np.isfinite(read))
    assert np.allclose(room[room != nodata], read[np.isfinite(read)])
