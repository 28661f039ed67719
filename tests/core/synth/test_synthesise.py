"""The public door: counts, seeds, noise, and the sentences of its errors."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepfield.errors import Cancelled, ParameterError, SceneError
from stepfield.synth import SCENES, synthesise
from stepfield.synth.scene import shares


@pytest.mark.parametrize("name", SCENES)
def test_a_scan_is_whole(name: str) -> None:
    scan = synthesise(name, points=5000)
    assert len(scan) == len(scan.surface) == len(scan.seen_from) == 5000
    assert scan.points.dtype == np.float64
    assert scan.surface.dtype == np.int32
    assert np.isfinite(scan.points).all()
    assert 0 <= scan.surface.min() <= scan.surface.max() < len(scan.names)
    mesh = scan.true_mesh
    assert len(mesh.triangles) == len(mesh.surface)
    assert 0 <= mesh.triangles.min() <= mesh.triangles.max() < len(mesh.vertices)
    assert set(mesh.surface.tolist()) == set(range(len(scan.names)))


@pytest.mark.parametrize("name", SCENES)
def test_the_same_seed_gives_the_same_scan(name: str) -> None:
    first, again, other = (synthesise(name, points=3000, seed=seed) for seed in (5, 5, 6))
    assert np.array_equal(first.points, again.points)
    assert np.array_equal(first.surface, again.surface)
    assert np.array_equal(first.true_mesh.vertices, again.true_mesh.vertices)
    assert not np.array_equal(first.points, other.points)


def test_results_are_read_only() -> None:
    scan = synthesise("table", points=100)
    for array in (scan.points, scan.surface, scan.seen_from, scan.true_mesh.vertices):
        assert not array.flags.writeable


def test_points_are_muddled() -> None:
    scan = synthesise("three-planes", points=3000)
    changes = np.count_nonzero(np.diff(scan.surface))
    assert changes == pytest.approx(2000, rel=0.1)


def test_noise_has_the_deviation_asked_for() -> None:
    scan = synthesise("three-planes", points=60_000, noise=0.02)
    off = scan.points[:, 2] - np.round(scan.points[:, 2])
    assert off.std() == pytest.approx(0.02, rel=0.03)
    assert np.abs(scan.points[:, :2]).max() <= 5.0


def test_scenes_have_a_number_of_points_of_their_own() -> None:
    assert len(synthesise("cylinder")) == 100_000
    assert len(synthesise("rubble")) == 400_000


@given(st.integers(1, 10**9), st.lists(st.floats(1e-6, 1e6), min_size=1, max_size=30))
def test_shares_add_up_and_are_fair(total: int, weights: list[float]) -> None:
    counts = shares(total, np.array(weights))
    assert counts.sum() == total
    exact = total * np.array(weights) / sum(weights)
    assert np.abs(counts - exact).max() < 1 + 1e-6 * total


@given(st.lists(st.integers(1, 10**7), min_size=1, max_size=50))
def test_shares_keep_whole_numbers(counts: list[int]) -> None:
    assert shares(sum(counts), np.array(counts, float)).tolist() == counts


def test_progress_can_stop_it() -> None:
    def stop(share: float, what: str) -> None:
        raise Cancelled

    with pytest.raises(Cancelled):
        synthesise("table", points=100, progress=stop)


def test_progress_rises_to_one() -> None:
    told: list[float] = []
    synthesise("bridge", points=1000, progress=lambda share, _: told.append(share))
    assert told == sorted(told)
    assert told[-1] == 1.0


def test_an_unknown_scene_names_those_there_are() -> None:
    with pytest.raises(SceneError, match=r'no scene is called "castle"; choose three-planes, .*rubble'):
        synthesise("castle")


@pytest.mark.parametrize("path", ["missing.json", Path("missing.json"), Path()])
def test_a_file_that_cannot_be_read(path: str | Path) -> None:
    with pytest.raises(SceneError, match="cannot read the scene"):
        synthesise(path)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"points": 0}, "points is 0"),
        ({"points": 10**9 + 1}, "points is 1,000,000,001"),
        ({"noise": -0.1}, "noise is -0.1"),
        ({"noise": float("nan")}, "noise is nan"),
        ({"seed": -1}, "seed is -1"),
    ],
)
def test_impossible_arguments(arguments: dict[str, float], sentence: str) -> None:
    with pytest.raises(ParameterError, match=sentence):
        synthesise("table", **arguments)  # type: ignore[arg-type]


def test_neither_the_library_nor_a_drawn_scene_loads_open3d() -> None:
    program = (
        "import sys, stepfield, stepfield.synth as synth; synth.synthesise('table', points=10); "
        "sys.exit('open3d' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
