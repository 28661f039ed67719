"""Cleaning drops what it was asked to drop, counts it, and never more than that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.conftest import scan_of

from stepfield.errors import ScanError
from stepfield.parameters import Parameters
from stepfield.scan import Scan, clean
from stepfield.scan.cleaning import isolated_points, sparse_points

RNG = np.random.default_rng(11)
GROUND = np.c_[RNG.random((5000, 2)) * 20, RNG.normal(0, 0.02, 5000)]
ROOF = np.c_[RNG.random((2000, 2)) * 8 + 5, RNG.normal(3, 0.02, 2000)]
STRAYS = np.array([[10, 10, -5], [3, 4, 9], [3.1, 4, 9.05], [15, 2, -2.5], [10, 10, 1.5]])


@pytest.fixture
def scan() -> Scan:
    return scan_of(np.vstack([GROUND, ROOF, STRAYS]))


def test_nothing_is_dropped_unless_asked(scan: Scan) -> None:
    assert clean(scan, Parameters()) is scan


def test_a_crop_box_keeps_its_own_faces(scan: Scan) -> None:
    corners = scan_of(np.array([[0, 0, 0], [1, 1, 1], [2, 2, 2], [2.5, 2, 2]]))
    kept = clean(corners, Parameters(crop=(1, 1, 1, 2, 2, 2)))
    assert kept.points().tolist() == [[1, 1, 1], [2, 2, 2]]
    assert kept.removed["crop"] == 2


def test_classes_keep_only_their_own_points_and_attributes_follow(scan: Scan) -> None:
    codes = (np.arange(len(scan)) % 3).astype(np.uint8)
    classed = replace(scan, attributes={"classification": codes})
    kept = clean(classed, Parameters(classes=(2, 0)))
    assert set(kept.attributes["classification"].tolist()) == {0, 2}
    assert kept.removed["classes"] == np.count_nonzero(codes == 1)
    assert np.array_equal(kept.points(), scan.points()[codes != 1])


def test_classes_of_a_scan_without_any_are_said_to_be_ignored(scan: Scan) -> None:
    kept = clean(scan, Parameters(classes=(2,)))
    assert len(kept) == len(scan)
    assert "no classification" in kept.warnings[-1]


@pytest.mark.parametrize("how", ["isolated", "radius"])
def test_every_stray_point_goes_and_hardly_another(scan: Scan, how: str) -> None:
    kept = clean(scan, Parameters.checked(outliers=how))
    surfaces = len(scan) - len(STRAYS)
    assert kept.z.bounds()[0] > -0.2
    assert kept.z.bounds()[1] < 3.2
    assert not ((kept.points()[:, 2] > 0.5) & (kept.points()[:, 2] < 2.5)).any()
    assert len(kept) > 0.99 * surfaces
    assert kept.removed["outliers"] == len(scan) - len(kept)


@pytest.mark.parametrize("how", ["isolated", "radius"])
@pytest.mark.parametrize("points", [1, 2, 5])
def test_scans_of_few_points_or_of_one_place_do_no_harm(how: str, points: int) -> None:
    stray = {"isolated": isolated_points, "radius": sparse_points}[how](scan_of(np.ones((points, 3))))
    assert len(stray) == points


def test_a_scan_with_nothing_left_is_one_sentence(scan: Scan) -> None:
    with pytest.raises(ScanError, match="the crop box leaves no points"):
        clean(scan, Parameters(crop=(90, 90, 90, 91, 91, 91)))
