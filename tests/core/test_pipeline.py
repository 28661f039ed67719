"""The pipeline remembers stages: a slider that sorts points again for a new alpha is not live."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stepfield import pipeline as stages
from stepfield.errors import Cancelled, ParameterError
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.project import Move

BASE = Parameters(cell_size=0.2, layer_tolerance=0.3, alpha=0.1)


@pytest.fixture
def table(tmp_path: Path) -> Path:
    rng = np.random.default_rng(3)
    floor = np.c_[rng.random((6000, 2)) * 3, rng.normal(0, 0.01, 6000)]
    top = np.c_[rng.random((2000, 2)) + 1, rng.normal(0.75, 0.01, 2000)]
    path = tmp_path / "table.npy"
    np.save(path, np.vstack([floor, top]))
    return path


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the stages that really ran."""
    names: list[str] = []

    def watch(name: str) -> None:
        original: Callable[..., Any] = getattr(stages, name)

        def watched(*args: Any, **keywords: Any) -> Any:
            names.append(name)
            return original(*args, **keywords)

        monkeypatch.setattr(stages, name, watched)

    for name in ("open_scan", "sort_into_compartments", "build_pillars", "classify", "apply_moves", "link"):
        watch(name)
    return names


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({}, []),
        ({"alpha": 0.5}, []),
        ({"bits": 8}, []),
        ({"range": "layer"}, []),
        ({"pad": "none"}, []),
        ({"link_step": 0.1}, ["link"]),
        ({"min_points": 3}, ["classify", "apply_moves", "link"]),
        ({"layering": "rank"}, ["classify", "apply_moves", "link"]),
        ({"layer_tolerance": 0.2}, ["build_pillars", "classify", "apply_moves", "link"]),
        ({"cell_size": 0.3}, ["sort_into_compartments", "build_pillars", "classify", "apply_moves", "link"]),
        (
            {"up": "-z"},
            ["open_scan", "sort_into_compartments", "build_pillars", "classify", "apply_moves", "link"],
        ),
    ],
)
def test_only_what_depends_on_a_change_runs_again(
    table: Path, ran: list[str], change: dict[str, Any], expected: list[str]
) -> None:
    pipeline = Pipeline()
    pipeline.run([table], BASE)
    ran.clear()
    again = pipeline.run([table], BASE.model_copy(update=change))
    assert ran == expected
    fresh = Pipeline().run([table], BASE.model_copy(update=change))
    for ours, theirs in zip(again.height_maps(), fresh.height_maps(), strict=True):
        assert np.array_equal(ours.gray, theirs.gray)


def test_a_move_runs_from_the_layering_on(table: Path, ran: list[str]) -> None:
    pipeline = Pipeline()
    first = pipeline.run([table], BASE)
    ran.clear()
    boxes = first.field.boxes(first.layering.members(1)[:3])
    move = Move.model_validate({"to": "unassigned", "pillars": [tuple(box) for box in boxes.tolist()]})
    edited = pipeline.run([table], BASE, [move])
    assert ran == ["apply_moves", "link"]
    assert edited.layering.unassigned == first.layering.unassigned + 3


def test_a_scan_saved_anew_is_read_anew(table: Path, ran: list[str]) -> None:
    pipeline = Pipeline()
    pipeline.run([table], BASE)
    np.save(table, np.load(table)[:5000])
    ran.clear()
    assert len(pipeline.run([table], BASE).scan) == 5000
    assert "open_scan" in ran


@pytest.mark.parametrize("at", [0.0, 0.5, 0.8, 0.95])
def test_cancelling_stops_and_the_next_run_is_right(table: Path, at: float) -> None:
    def stop(share: float, what: str) -> None:
        if share >= at:
            raise Cancelled

    pipeline = Pipeline()
    with pytest.raises(Cancelled):
        pipeline.run([table], BASE, progress=stop)
    assert len(pipeline.run([table], BASE).layers) == 2


def test_progress_runs_from_nought_to_one(table: Path) -> None:
    shares: list[float] = []
    Pipeline().run([table], BASE, progress=lambda share, what: shares.append(share))
    assert shares == sorted(shares)
    assert shares[0] == 0.0
    assert shares[-1] == 1.0


def test_results_cannot_be_changed_by_those_who_look_at_them(table: Path) -> None:
    result = Pipeline().run([table], BASE)
    for array in (result.field.elevation, result.field.compartment, result.layering.layer):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_too_high_a_wish_for_points_is_one_sentence(table: Path) -> None:
    with pytest.raises(ParameterError, match="lower min_points"):
        Pipeline().run([table], BASE.model_copy(update={"min_points": 5000}))


def test_auto_replaces_every_length_by_a_number(table: Path) -> None:
    chosen = Pipeline().run([table], Parameters()).parameters
    assert all(
        isinstance(getattr(chosen, name), float)
        for name in ("cell_size", "alpha", "layer_tolerance", "link_step")
    )
