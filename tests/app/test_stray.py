"""The outlier preview shows what the filter then drops, no more and no less."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from tests.conftest import scan_of

from stepfield.parameters import Parameters
from stepfield.scan import clean
from stepfield_app.stray import StrayQuestion, find_stray

RNG = np.random.default_rng(2)
POINTS = np.vstack([np.c_[RNG.random((3000, 2)) * 10, RNG.normal(0, 0.02, 3000)], [[5, 5, 6], [2, 8, -4]]])


@pytest.mark.parametrize("mode", ["radius", "isolated"])
def test_what_is_shown_is_what_is_dropped(mode: Literal["radius", "isolated"]) -> None:
    scan = scan_of(POINTS)
    chosen = Parameters(crop=(0.0, 0.0, -5.0, 10.0, 9.0, 7.0), outliers=mode)
    shown = find_stray(StrayQuestion(scan, chosen, mode))
    kept = clean(scan, chosen)
    assert len(shown) == kept.removed["outliers"]
    assert shown.among == len(kept) + len(shown)
    assert [5.0, 5.0, 6.0] in shown.places.tolist()
