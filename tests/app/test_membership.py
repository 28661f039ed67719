"""Which layer a point of the cloud belongs to, seen from a result that may be of other points."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.app.scenes_made import table_result

from stepfield_app.scenes.membership import point_codes
from stepfield_app.scenes.palette import UNASSIGNED_CODE


@pytest.mark.parametrize("chosen", [None, np.arange(0, 50)])
def test_points_beyond_the_grid_belong_to_no_layer(tmp_path: Path, chosen: np.ndarray | None) -> None:
    """A profile of the cloud before may still be cut when another scan has just been opened."""
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    here, there = table_result(tmp_path / "here"), table_result(tmp_path / "there", (900.0, 900.0, 0.0))
    codes = point_codes(here.scan, there, chosen)
    assert len(codes) == (len(here.scan) if chosen is None else len(chosen))
    assert (codes == UNASSIGNED_CODE).all()
