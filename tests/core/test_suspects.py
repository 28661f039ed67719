"""Suspicious places: what is found, how it is grouped and told, and what is left in peace."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.project import ExistingLayer, Move
from stepfield.reconstruction import Reconstruction
from stepfield.suspects import CLOSE, ISOLATED, KINDS, SEAMS, nearly_in, suspects


def reconstruct(folder: Path, points: NDArray[np.float64], moves: Any = (), **values: Any) -> Reconstruction:
    path = folder / "scan.npy"
    np.save(path, points)
    chosen = {"cell_size": 1.0, "layer_tolerance": 0.5, "link_step": 0.5, **values}
    return Pipeline().run([path], Parameters.checked(**chosen), moves)


def sheet(
    height: float | NDArray[np.float64], columns: int = 12, rows: int = 8, west: int = 0
) -> NDArray[np.float64]:
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(columns) + 0.5 + west, np.arange(rows) + 0.5))
    return np.column_stack([x, y, np.broadcast_to(height, x.shape)])


def floors(middle: float) -> NDArray[np.float64]:
    """Return two whole sheets and some lone pillars in one corner at an elevation between them."""
    between = sheet(middle, 3, 2, 12)
    corner = np.array([[0.0, 0.0, 0.0], [15.0, 8.0, 0.0]])
    return np.vstack([sheet(0.0), sheet(4.0), between, corner])


def test_two_clean_floors_are_not_suspicious(tmp_path: Path) -> None:
    found = suspects(reconstruct(tmp_path, np.vstack([sheet(0.0), sheet(4.0)])))
    assert not found.places
    assert not any(mask.any() for mask in found.masks.values())
    assert found.found == dict.fromkeys(KINDS, 0)


@pytest.mark.parametrize(("height", "is_close"), [(0.4, False), (1.9, True), (2.1, True), (3.6, False)])
def test_pillars_half_way_between_two_layers_are_close(tmp_path: Path, height: float, is_close: bool) -> None:
    result = reconstruct(tmp_path, floors(height))
    between = np.abs(result.field.elevation - height) < 1e-3
    close = suspects(result).masks[CLOSE]
    assert close[between].all() == is_close
    assert not close[~between].any()


def test_a_taken_layer_is_no_alternative(tmp_path: Path) -> None:
    both = np.vstack([sheet(0.0), sheet(4.0), sheet(1.9, 3, 2), sheet(8.0, 6)])
    result = reconstruct(tmp_path, both, max_layers=2)
    nearly = nearly_in(result)
    full = np.bincount(result.field.compartment[result.layering.layer >= 0]) == 2
    assert (nearly[full[result.field.compartment]] == -1).all()


def test_what_a_hand_has_moved_is_not_doubtful(tmp_path: Path) -> None:
    before = reconstruct(tmp_path, floors(1.9))
    chosen = np.flatnonzero(np.abs(before.field.elevation - 1.9) < 1e-3)
    other = 1 - int(before.layering.layer[chosen[0]])
    elevation = float(before.layering.averages(before.field.elevation)[other])
    target = ExistingLayer(layer=other, of=2, elevation=elevation)
    boxes = [tuple(box) for box in before.field.boxes(chosen).tolist()]
    after = reconstruct(tmp_path, floors(1.9), [Move(text="m", to=target, pillars=boxes)])
    assert (after.layering.layer[chosen] == other).all()
    assert suspects(before).masks[CLOSE][chosen].all()
    assert not suspects(after).masks[CLOSE].any()


def test_a_ramp_through_two_layers_has_one_seam(tmp_path: Path) -> None:
    x = np.arange(12) + 0.5
    ramp = np.tile(0.4 * x, 8)
    result = reconstruct(tmp_path, np.vstack([sheet(ramp), sheet(8.0, 4, 8, 0), sheet(6.0, 2, 8, 10)]))
    found = suspects(result)
    assert np.array_equal(np.flatnonzero(found.masks[SEAMS]), np.unique(result.seams))
    seams = [place for place in found.places if place.kind == SEAMS]
    assert found.found[SEAMS] == len(seams)
    assert sum(len(place.pillars) for place in seams) == len(np.unique(result.seams))
    for place in seams:
        layers = set(result.layering.layer[place.pillars].tolist())
        assert len(layers) > 1, "a seam has two sides"
        assert all(result.layers[layer].name in place.sentence for layer in sorted(layers)[:1])


def test_a_lone_pillar_is_isolated_and_its_place_is_where_it_stands(tmp_path: Path) -> None:
    shift = (400_000.0, 5_000_000.0, 100.0)
    points = np.vstack([sheet(0.0), sheet(4.0), [[14.5, 3.5, 4.0], [15.0, 8.0, 0.0]]]) + shift
    result = reconstruct(tmp_path, points)
    lone = [place for place in suspects(result).places if place.kind == ISOLATED]
    assert any(np.allclose(place.centre[2] - shift[2], 4.0) for place in lone)
    place = next(place for place in lone if abs(place.centre[2] - shift[2] - 4.0) < 0.1)
    assert place.sentence == "1 pillar of Layer 2 continues no other of its layer"
    assert place.box[0] <= 14.5 + shift[0] <= place.box[2]
    assert place.box[0] <= place.centre[0] <= place.box[2]
    assert place.box[1] <= place.centre[1] <= place.box[3]
    assert place.layer == 1


def test_pillars_that_touch_make_one_place_and_others_do_not(tmp_path: Path) -> None:
    corner = np.array([[0.0, 0.0, 0.0], [30.0, 8.0, 0.0]])
    apart = np.vstack([sheet(0.0), sheet(4.0), sheet(1.9, 3, 2, 14), sheet(1.9, 2, 2, 20), corner])
    places = [place for place in suspects(reconstruct(tmp_path, apart)).places if place.kind == CLOSE]
    assert [len(place.pillars) for place in places] == [6, 4]


def test_only_the_most_serious_are_listed_and_all_are_counted(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    rough = np.vstack([sheet(rng.uniform(0, 9, 40 * 40), 40, 40), sheet(20.0, 2, 2)])
    result = reconstruct(tmp_path, rough)
    found = suspects(result, most=3)
    assert found.found[ISOLATED] > 3
    assert len(found.places) <= 3 * len(KINDS)
    sizes = [len(place.pillars) for place in found.places if place.kind == ISOLATED]
    assert sizes == sorted(sizes, reverse=True)
    everything = suspects(result, most=10**6)
    for kind in KINDS:
        held = [pillar for place in everything.places if place.kind == kind for pillar in place.pillars]
        assert np.array_equal(np.sort(held), np.flatnonzero(everything.masks[kind])), (
            "a pillar is in no place or two"
        )
