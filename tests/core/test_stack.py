"""The stack on disk: what is written can be read back, is the same on every run, and is never half there."""

import json
import os
import resource
import shutil
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from PIL import Image

import stepfield_resources
from stepfield.errors import StackError
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction
from stepfield.stack import Manifest, Stack, write_stack
from stepfield.stack.check import check_stack


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    rng = np.random.default_rng(4)
    floor = np.c_[rng.random((6000, 2)) * [3, 2], rng.normal(0, 0.01, 6000)]
    top = np.c_[rng.random((2000, 2)) + np.array([1, 0.5]), rng.normal(0.75, 0.01, 2000)]
    path = tmp_path_factory.mktemp("scan") / 'Tisch "β".npy'
    np.save(path, np.vstack([floor, top]) + np.array([600_000.25, 5_400_000.5, 300.0]))
    return path


@pytest.fixture(scope="module")
def result(table: Path) -> Reconstruction:
    return Pipeline().run([table], Parameters(cell_size=0.1))


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def test_the_manifest_obeys_the_schema_that_ships(result: Reconstruction, tmp_path: Path) -> None:
    write_stack(result, tmp_path / "out")
    document = json.loads((tmp_path / "out" / "manifest.json").read_text())
    jsonschema.validate(document, stepfield_resources.schema("stack"))
    assert document["source"]["files"][0]["name"] == 'Tisch "β".npy'
    assert document["parameters"]["cell_size"] == 0.1


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("white", ["shared", "layer"])
def test_elevations_come_back_within_half_a_level(table: Path, tmp_path: Path, bits: int, white: str) -> None:
    parameters = Parameters.checked(cell_size=0.1, bits=bits, range=white)
    result = Pipeline().run([table], parameters)
    write_stack(result, tmp_path / "out")
    stack = Stack.open(tmp_path / "out")
    for layer, entry in zip(result.layers, stack.manifest.layers, strict=True):
        row, column = stack.grid.row_column(result.field.compartment[layer.pillars])
        elevations = stack.elevations(entry)
        error = elevations[row, column] - (layer.heights + result.base_elevation)
        assert np.abs(error).max() <= entry.scale / 2 * (1 + 1e-6)
        assert np.isnan(elevations).sum() == elevations.size - len(layer.pillars)


def test_two_runs_give_the_same_bytes(table: Path, tmp_path: Path) -> None:
    for name in ("one", "two"):
        write_stack(Pipeline().run([table], Parameters()), tmp_path / name)
    assert contents(tmp_path / "one") == contents(tmp_path / "two")


def test_the_parameters_of_the_manifest_give_the_same_bytes_again(table: Path, tmp_path: Path) -> None:
    first = write_stack(Pipeline().run([table], Parameters()), tmp_path / "one")
    write_stack(Pipeline().run([table], first.parameters), tmp_path / "two")
    assert contents(tmp_path / "one") == contents(tmp_path / "two")


def test_a_stack_passes_its_own_check_with_its_scan(
    result: Reconstruction, table: Path, tmp_path: Path
) -> None:
    write_stack(result, tmp_path / "out")
    report = check_stack(tmp_path / "out", [table])
    assert report.faults == ()
    assert report.fidelity is not None
    assert report.fidelity.vertical.rmse < 0.02
    assert report.fidelity.explained > 0.99


def damage_gray(folder: Path) -> None:
    path = folder / "layer_01.png"
    pixels = np.asarray(Image.open(path)).copy()
    pixels[pixels > 0] = 7
    Image.fromarray(pixels).save(path)


def damage_manifest_number(folder: Path) -> None:
    path = folder / "manifest.json"
    path.write_text(path.read_text().replace('"pillars": ', '"pillars": 1'))


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (lambda folder: (folder / "layer_00.png").unlink(), "image is missing"),
        (lambda folder: (folder / "layer_00.png").write_bytes(b"GIF89a"), "image is damaged"),
        (
            lambda folder: os.truncate(
                folder / "layer_00.png", (folder / "layer_00.png").stat().st_size // 2
            ),
            "image is damaged",
        ),
        (lambda folder: shutil.copy(folder / "layer_00_mask.png", folder / "layer_00.png"), "bits a pixel"),
        (lambda folder: shutil.copy(folder / "layer_00_mask.png", folder / "layer_01_mask.png"), "disagree"),
        (lambda folder: Image.new("L", (3, 3)).save(folder / "layer_00_mask.png"), "3 x 3 pixels"),
        (damage_gray, "height"),
        (damage_manifest_number, "pillars"),
    ],
)
def test_check_finds_the_fault(result: Reconstruction, tmp_path: Path, damage: object, sentence: str) -> None:
    write_stack(result, tmp_path / "out")
    assert callable(damage)
    damage(tmp_path / "out")
    assert any(sentence in fault for fault in check_stack(tmp_path / "out").faults)


def test_check_notices_another_scan(result: Reconstruction, tmp_path: Path) -> None:
    write_stack(result, tmp_path / "out")
    other = tmp_path / "other.npy"
    np.save(other, result.scan.points() + np.array([0, 0, 0.25]))
    assert any("SHA-256" in fault for fault in check_stack(tmp_path / "out", [other]).faults)


def test_an_image_name_cannot_leave_the_folder(result: Reconstruction, tmp_path: Path) -> None:
    write_stack(result, tmp_path / "out")
    path = tmp_path / "out" / "manifest.json"
    path.write_text(path.read_text().replace('"layer_00.png"', '"../../etc/passwd"'))
    with pytest.raises(StackError, match="without folders"):
        Manifest.of(tmp_path / "out")


@pytest.mark.parametrize("text", ["", "{}", '{"format": "stepfield-stack", "version": 2}', "[1]"])
def test_a_folder_without_a_usable_manifest_is_one_sentence(tmp_path: Path, text: str) -> None:
    (tmp_path / "manifest.json").write_text(text)
    with pytest.raises(StackError) as caught:
        Stack.open(tmp_path)
    assert "\n" not in str(caught.value)


class TestFolder:
    """Nothing that was there may be lost, nothing half written may be left."""

    def test_an_empty_folder_is_filled(self, result: Reconstruction, tmp_path: Path) -> None:
        (tmp_path / "out").mkdir()
        write_stack(result, tmp_path / "out")
        assert (tmp_path / "out" / "manifest.json").exists()

    def test_a_folder_with_something_is_refused(self, result: Reconstruction, tmp_path: Path) -> None:
        write_stack(result, tmp_path / "out")
        with pytest.raises(StackError, match="--overwrite"):
            write_stack(result, tmp_path / "out")

    def test_overwrite_replaces_a_stack_and_all_its_files(
        self, result: Reconstruction, tmp_path: Path
    ) -> None:
        write_stack(result, tmp_path / "out")
        (tmp_path / "out" / "layer_07.png").write_bytes(b"of an older stack with more layers")
        write_stack(result, tmp_path / "out", overwrite=True)
        assert not (tmp_path / "out" / "layer_07.png").exists()
        assert [path.name for path in tmp_path.iterdir()] == ["out"]

    def test_overwrite_never_replaces_anything_else(self, result: Reconstruction, tmp_path: Path) -> None:
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "thesis.tex").write_text("years of work")
        with pytest.raises(StackError, match="other than a stack"):
            write_stack(result, tmp_path / "out", overwrite=True)
        assert (tmp_path / "out" / "thesis.tex").read_text() == "years of work"

    def test_a_file_in_the_way_is_refused(self, result: Reconstruction, tmp_path: Path) -> None:
        (tmp_path / "out").write_text("a file")
        with pytest.raises(StackError, match="is a file"):
            write_stack(result, tmp_path / "out")

    def test_a_symbolic_link_stays_and_its_folder_is_replaced(
        self, result: Reconstruction, tmp_path: Path
    ) -> None:
        write_stack(result, tmp_path / "real")
        (tmp_path / "link").symlink_to("real")
        write_stack(result, tmp_path / "link", overwrite=True)
        assert (tmp_path / "link").is_symlink()
        assert (tmp_path / "real" / "manifest.json").exists()

    def test_a_full_disk_leaves_the_old_stack_whole(self, result: Reconstruction, tmp_path: Path) -> None:
        write_stack(result, tmp_path / "out")
        before = contents(tmp_path / "out")
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (600, hard))
        try:
            with pytest.raises(StackError, match="cannot write"):
                write_stack(result, tmp_path / "out", overwrite=True)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        assert contents(tmp_path / "out") == before
        assert [path.name for path in tmp_path.iterdir()] == ["out"]

    def test_the_rights_are_those_of_any_new_folder(self, result: Reconstruction, tmp_path: Path) -> None:
        (tmp_path / "usual").mkdir()
        write_stack(result, tmp_path / "out")
        assert (tmp_path / "out").stat().st_mode == (tmp_path / "usual").stat().st_mode
