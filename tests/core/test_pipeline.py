"""The pipeline remembers stages: a slider that sorts points again for a new alpha is not live."""

import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.conftest import scan_of

from stepfield import links
from stepfield import pipeline as stages
from stepfield.compartments import sort_into_compartments
from stepfield.errors import Cancelled, GridError, ParameterError
from stepfield.layers import UNASSIGNED
from stepfield.links import link
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.project import Move
from stepfield.reconstruction import Reconstruction

STAGES = [
    *("read_scan", "cleaned", "sort_into_compartments", "build_pillars"),
    *("classify", "Replay", "Links"),
]
BASE = Parameters(layering="elevation", cell_size=0.2, layer_tolerance=0.3, alpha=0.1)


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

    for name in STAGES:
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
        ({"link_step": 0.1}, ["Links"]),
        ({"min_points": 3}, STAGES[4:]),
        ({"layering": "rank"}, ["classify", "Replay"]),
        ({"layer_tolerance": 0.2}, STAGES[3:]),
        ({"cell_size": 0.3}, STAGES[2:]),
        ({"crop": (0.0, 0.0, -1.0, 3.0, 2.0, 2.0)}, STAGES[1:]),
        ({"up": "-z"}, STAGES),
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


def test_by_surface_links_come_first_and_are_not_found_again(table: Path, ran: list[str]) -> None:
    pipeline, parameters = Pipeline(), BASE.model_copy(update={"layering": "surface"})
    pipeline.run([table], parameters)
    ran.clear()
    pipeline.run([table], parameters.model_copy(update={"link_step": 0.1}))
    assert ran == ["classify", "Links", "Replay"]


def moved(result: Reconstruction, to: Any) -> Move:
    """Move three pillars of the second layer."""
    boxes = result.field.boxes(result.layering.members(1)[:3])
    return Move.model_validate({"to": to, "pillars": [tuple(box) for box in boxes.tolist()]})


def test_a_move_runs_from_the_layering_on(table: Path, ran: list[str]) -> None:
    pipeline = Pipeline()
    first = pipeline.run([table], BASE)
    ran.clear()
    edited = pipeline.run([table], BASE, [moved(first, "unassigned")])
    assert ran == ["Links"], "only the moves and what follows from them"
    assert edited.layering.unassigned == first.layering.unassigned + 3


def test_a_move_between_layers_cuts_other_seams_but_links_stay(table: Path, ran: list[str]) -> None:
    pipeline = Pipeline()
    first = pipeline.run([table], BASE)
    ran.clear()
    lower = {"layer": 0, "of": 2, "elevation": 0.0}
    edited = pipeline.run([table], BASE, [moved(first, lower)])
    assert ran == []
    fresh = Pipeline().run([table], BASE, [moved(first, lower)])
    assert len(edited.seams) > len(first.seams)
    assert np.array_equal(edited.seams, fresh.seams)
    assert np.array_equal(edited.links, fresh.links)


def test_layers_that_an_edit_leaves_alone_stay_the_very_same(table: Path) -> None:
    """Whoever draws them need not look at them again; of those it touches none may be stale."""
    pipeline = Pipeline()
    first = pipeline.run([table], BASE)
    for moves in ([moved(first, "unassigned")], [], [moved(first, {"new": "Layer 9"})], []):
        edited, fresh = pipeline.run([table], BASE, moves), Pipeline().run([table], BASE, moves)
        assert edited.layers[0].pillars is first.layers[0].pillars
        for ours, theirs in zip(edited.layers, fresh.layers, strict=True):
            assert np.array_equal(ours.pillars, theirs.pillars)
            assert np.array_equal(ours.elevation, theirs.elevation)
        assert edited.max_height == fresh.max_height


def test_links_are_found_when_asked_for(table: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A slider that looks for links nobody sees takes twice as long to follow."""
    looked: list[int] = []

    def watched(*given: Any) -> Any:
        looked.append(1)
        return link(*given)

    monkeypatch.setattr(links, "link", watched)
    result = Pipeline().run([table], BASE)
    assert not looked
    assert np.array_equal(result.links, link(result.field, result.layering.layer != UNASSIGNED, 0.3))
    assert np.array_equal(result.seams, result.layering.seams(result.links))
    assert len(looked) == 1, "found anew each time"


@pytest.mark.parametrize("change", [{}, {"cell_size": 0.17}, {"crop": (0.5, 0.5, -1.0, 2.5, 2.5, 2.0)}])
def test_a_preview_has_fewer_points_over_the_same_grid(table: Path, change: dict[str, Any]) -> None:
    """Otherwise the picture would jump when the exact result takes the preview's place."""
    parameters = Parameters().model_copy(update=change)
    preview = Pipeline().run([table], parameters, most_points=1000)
    exact = Pipeline().run([table], parameters)
    ours, theirs = preview.field.compartments, exact.field.compartments
    assert 900 <= len(ours.ticks) <= 1006
    assert (ours.grid, ours.lowest, ours.tick) == (theirs.grid, theirs.lowest, theirs.tick)
    assert preview.parameters == exact.parameters, "auto is picked from all points"
    assert len(preview.scan) == len(exact.scan)
    assert preview.base_elevation == exact.base_elevation


def test_previews_and_exact_results_leave_each_other_their_stages(table: Path, ran: list[str]) -> None:
    pipeline = Pipeline()
    pipeline.run([table], BASE)
    pipeline.run([table], BASE.model_copy(update={"cell_size": 0.4}), most_points=1000)
    ran.clear()
    pipeline.run([table], BASE)
    pipeline.run([table], BASE.model_copy(update={"cell_size": 0.4}), most_points=1000)
    assert ran == []


def test_a_preview_asks_for_fewer_points_a_pillar(table: Path) -> None:
    """With the least number of points left as it is, a preview would be empty where the result is full."""
    fussy = BASE.model_copy(update={"min_points": 8, "cell_size": 0.1})
    exact, preview = Pipeline().run([table], fussy), Pipeline().run([table], fussy, most_points=1000)
    assert len(preview.layers) == len(exact.layers)
    assert len(preview.layers[0].pillars) > 100


def test_a_preview_of_a_small_scan_is_exact(table: Path, ran: list[str]) -> None:
    pipeline = Pipeline()
    assert len(pipeline.run([table], BASE, most_points=8000).field.compartments.ticks) == 8000
    ran.clear()
    pipeline.run([table], BASE)
    assert ran == []


def test_what_was_made_from_a_stage_is_freed_before_that_is_made_anew(
    table: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At ten million points two generations of everything would not fit side by side."""
    pipeline = Pipeline()
    field = weakref.ref(pipeline.run([table], BASE).field)
    alive: list[bool] = []
    original = sort_into_compartments

    def watched(*args: Any) -> Any:
        alive.append(field() is not None)
        return original(*args)

    monkeypatch.setattr(stages, "sort_into_compartments", watched)
    pipeline.run([table], BASE.model_copy(update={"cell_size": 0.3}))
    assert alive == [False]


def test_an_absurd_cell_size_costs_nothing_that_was_made(table: Path, ran: list[str]) -> None:
    pipeline = Pipeline()
    pipeline.run([table], BASE)
    with pytest.raises(GridError):
        pipeline.run([table], BASE.model_copy(update={"cell_size": 1e-7}))
    ran.clear()
    pipeline.run([table], BASE)
    assert ran == []


def test_the_raw_scan_is_there_without_reading_it_again(table: Path, ran: list[str]) -> None:
    pipeline = Pipeline()
    result = pipeline.run([table], BASE.model_copy(update={"crop": (0.0, 0.0, -1.0, 1.0, 1.0, 2.0)}))
    assert len(pipeline.raw) == 8000 > len(result.scan)
    assert ran.count("read_scan") == 1


def test_a_thinned_scan_is_spread_evenly_and_keeps_the_outermost_points() -> None:
    rows = np.c_[np.arange(10_000) % 100, np.arange(10_000) // 100, np.zeros(10_000)]
    scan = scan_of(rows)
    thinned = scan.thinned(500)
    assert len(thinned) == pytest.approx(500, abs=10)
    assert np.array_equal(thinned.bounds(), scan.bounds())
    columns, held = np.unique(thinned.points()[:, 0], return_counts=True)
    assert len(columns) > 90, "every 20th point of a sweep of 100 would be one of five columns"
    assert held.max() < 20
    assert np.array_equal(thinned.points(), scan.thinned(500).points())
    assert scan.thinned(10_000) is scan


def test_a_scan_saved_anew_is_read_anew(table: Path, ran: list[str]) -> None:
    pipeline = Pipeline()
    pipeline.run([table], BASE)
    np.save(table, np.load(table)[:5000])
    ran.clear()
    assert len(pipeline.run([table], BASE).scan) == 5000
    assert "read_scan" in ran


@pytest.mark.parametrize("at", [0.0, 0.5, 0.6, 0.8, 0.85, 0.9])
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
