"""Inpainting some holes at a time is inpainting all at once, and can be stopped between them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from skimage.restoration import inpaint_biharmonic

from stepfield import inpainting
from stepfield.errors import Cancelled
from stepfield.inpainting import inpainted
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.scan.write import write


def holed(seed: int, share: float, rows: int, columns: int) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Make rough ground with holes in it, single ones and larger ones, also at its rim."""
    rng = np.random.default_rng(seed)
    raster = rng.normal(size=(rows, columns)).cumsum(axis=0)
    is_hole = rng.random((rows, columns)) < share
    row, column = rng.integers(0, rows), rng.integers(0, columns)
    is_hole[row : row + 5, column : column + 4] = True
    is_hole[rng.integers(0, rows), rng.integers(0, columns)] = False
    return raster, is_hole


@given(
    st.integers(0, 2**32),
    st.floats(0, 0.3),
    st.integers(2, 30),
    st.integers(2, 30),
    st.sampled_from([1, 5, 40]),
)
@settings(max_examples=100, deadline=None)
def test_some_at_a_time_is_all_at_once(seed: int, share: float, rows: int, columns: int, least: int) -> None:
    raster, is_hole = holed(seed, share, rows, columns)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(inpainting, "LEAST", least)
        made = inpainted(raster, is_hole)
    if is_hole.any():
        wanted = inpaint_biharmonic(raster, is_hole, split_into_regions=True)
        np.testing.assert_allclose(made, wanted, rtol=0, atol=1e-9)
    else:
        np.testing.assert_array_equal(made, raster)


def test_a_hole_may_reach_for_what_is_far_away_but_no_further() -> None:
    """The span is that of all that is known, not of what is near a hole."""
    raster = np.zeros((40, 12))
    raster[18], raster[24] = 1.0, 1.0  # towards the hole it gets steeper: its middle would be higher still
    raster[19], raster[23] = 3.0, 3.0
    is_hole = np.zeros(raster.shape, bool)
    is_hole[20:23, 3:9] = True
    raster[0, 0] = 3.5
    assert inpainted(raster, is_hole)[is_hole].max() == 3.5
    raster[0, 0] = 100.0
    assert 3.5 < inpainted(raster, is_hole)[is_hole].max() < 100.0


def test_it_is_stopped_between_holes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inpainting, "LEAST", 1)
    raster = np.arange(400.0).reshape(20, 20)
    is_hole = np.zeros(raster.shape, bool)
    is_hole[2::8, 2::8] = True
    before, asked = raster.copy(), list[float]()

    def stop(share: float, what: str) -> None:
        asked.append(share)
        if len(asked) == 4:
            raise Cancelled

    with pytest.raises(Cancelled):
        inpainted(raster, is_hole, stop)
    assert asked == pytest.approx([0, 1 / 9, 2 / 9, 3 / 9]), "nine holes, of which three are solved"
    np.testing.assert_array_equal(raster, before)


def test_a_run_that_is_cancelled_while_it_inpaints_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(inpainting, "LEAST", 1)
    row, column = (part.ravel() for part in np.indices((60, 60)))
    points = np.column_stack([column * 0.1 + 0.05, row * 0.1 + 0.05, 0.03 * column])
    is_hole = (column // 5 % 4 == 2) & (row // 5 % 4 == 2)
    path = tmp_path / "holed.ply"
    write(path, np.concatenate([[[0.0, 0.0, 0.0]], points[~is_hole]]), {})
    chosen: dict[str, Any] = {"cell_size": 0.5, "layer_tolerance": 0.3, "alpha": 0.5, "fill": "inpaint"}
    pipeline, parameters = Pipeline(), Parameters(**chosen)
    filling = list[float]()

    def stop(share: float, what: str) -> None:
        filling.extend([share] if what == "filling holes" else [])
        if len(set(filling)) == 4:
            raise Cancelled

    with pytest.raises(Cancelled):
        pipeline.run([path], parameters, progress=stop)
    made, fresh = pipeline.run([path], parameters), Pipeline().run([path], parameters)
    for layer, wanted in zip(made.layers, fresh.layers, strict=True):
        assert layer.filled.elevation.tobytes() == wanted.filled.elevation.tobytes()
    assert sum(len(layer.filled.compartment) for layer in made.layers) == np.count_nonzero(is_hole) / 25
