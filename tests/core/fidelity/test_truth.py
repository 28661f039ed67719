"""Against the truth: a right reconstruction is near it both ways, and what is wrong or missing shows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stepfield.errors import SceneError
from stepfield.fidelity import (
    Surface,
    Way,
    against_truth,
    compare_result,
    layer_figures,
    result_against_truth,
    true_mesh,
)
from stepfield.fidelity.reconstructions import layers_of
from stepfield.fidelity.truth import TruthFidelity, sampled
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.stack import write_stack
from stepfield.stack.check import check_stack
from stepfield.surface import Mesh
from stepfield.synth import synthesise

#: A square of two metres, level.
SQUARE = Mesh(
    np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]), np.array([[0, 1, 2], [0, 2, 3]], np.int64)
)


def shifted(mesh: Mesh, by: tuple[float, float, float]) -> Mesh:
    return Mesh(mesh.vertices + np.array(by), mesh.triangles)


def between(made: Mesh, truth: Mesh) -> TruthFidelity:
    return against_truth([made], Surface.of([made]), truth, 0.1, samples=5000)


def test_the_truth_is_true() -> None:
    found = between(SQUARE, SQUARE)
    assert found.accuracy.max == found.completeness.max == pytest.approx(0, abs=1e-9)
    assert found.completeness.explained == 1


def test_a_surface_that_is_off_is_off_by_as_much() -> None:
    found = between(shifted(SQUARE, (0, 0, 0.05)), SQUARE)
    assert found.accuracy.rmse == found.completeness.rmse == pytest.approx(0.05)


def test_what_is_missing_shows_in_completeness_only() -> None:
    half = Mesh(SQUARE.vertices * [0.5, 1, 1], SQUARE.triangles)
    found = between(half, SQUARE)
    assert found.accuracy.max == pytest.approx(0, abs=1e-9)
    assert found.completeness.explained == pytest.approx(0.55, abs=0.01)  # the half, and 0.1 m beside it
    assert found.completeness.rmse == pytest.approx(np.sqrt(0.5 / 3), rel=0.02)
    assert between(SQUARE, half).accuracy.rmse == pytest.approx(found.completeness.rmse)


def test_samples_lie_evenly() -> None:
    places = sampled([SQUARE, shifted(SQUARE, (2, 0, 1))], 4000)
    east, north = np.floor(places[:, :2].T / 0.5).astype(int)
    counts = np.bincount(8 * north + east)
    assert counts.sum() == 4000
    assert np.abs(counts - 125).max() <= 8
    assert np.array_equal(places, sampled([SQUARE, shifted(SQUARE, (2, 0, 1))], 4000))


@pytest.mark.parametrize(
    ("scene", "way", "most"),
    [
        ("three-planes", "edges", 0.002),
        ("three-planes", "pillars", 0.002),
        ("inclined-plane", "edges", 0.05),
        ("crossing-plane", "edges", 0.08),
        ("cylinder", "edges", 0.08),
    ],
)
def test_figures_of_the_paper_are_reconstructed_truly(
    scene: str, way: Way, most: float, tmp_path: Path
) -> None:
    np.save(tmp_path / "scan.npy", synthesise(scene, points=60_000, noise=0.001).points)
    result = Pipeline().run([tmp_path / "scan.npy"], Parameters(cell_size=0.2, layer_tolerance=0.3))
    found = result_against_truth(result, true_mesh(scene), way, samples=20_000)
    assert found.accuracy.rmse < most
    assert found.completeness.rmse < most
    assert found.completeness.explained > 0.97  # of a cylinder the flanks are too steep


def test_a_stack_is_checked_against_its_scene(tmp_path: Path) -> None:
    np.save(tmp_path / "scan.npy", synthesise("table", points=60_000, noise=0.001).points)
    result = Pipeline().run([tmp_path / "scan.npy"], Parameters(cell_size=0.1, layer_tolerance=0.3))
    write_stack(result, tmp_path / "stack")
    report = check_stack(tmp_path / "stack", [tmp_path / "scan.npy"], "table")
    assert report.faults == ()
    assert report.truth is not None
    assert report.fidelity is not None
    assert report.truth.accuracy.median < 0.002
    grid, layers = result.field.compartments.grid, layers_of(result)
    assert report.figures == layer_figures(grid, layers, 0.3)
    here = compare_result(result).fidelity  # within half a gray level the same as in memory
    assert report.fidelity.vertical.rmse == pytest.approx(here.vertical.rmse, abs=1e-4)
    assert report.fidelity.nearest.rmse == pytest.approx(here.nearest.rmse, abs=1e-4)
    with pytest.raises(SceneError):
        check_stack(tmp_path / "stack", truth="nowhere")


def test_a_simulator_loses_what_the_edges_keep(tmp_path: Path) -> None:
    np.save(tmp_path / "scan.npy", synthesise("table", points=60_000, noise=0.001).points)
    result = Pipeline().run([tmp_path / "scan.npy"], Parameters(cell_size=0.1, layer_tolerance=0.3))
    truth, missing = true_mesh("table"), {}
    ways: tuple[Way, ...] = ("edges", "simulator")
    for way in ways:
        near = result.parameters.model_copy(update={"layer_tolerance": 0.02})
        found = result_against_truth(replace(result, parameters=near), truth, way, samples=20_000)
        missing[way] = found.completeness.explained
    assert missing["simulator"] < missing["edges"] - 0.02
