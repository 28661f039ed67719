"""Numbers for holes, in files that have one everywhere: the nearest sample's, so that no edge gets spikes."""

from __future__ import annotations

import numpy as np

from stepfield.targets.terrain import Raster


def nearest(elevations: Raster) -> Raster:
    """Fill every hole of a raster, which has at least one sample, by its nearest sample."""
    holes = np.isnan(elevations)
    if not holes.any():
        return elevations
    from scipy.ndimage import distance_transform_edt

    row, column = distance_transform_edt(holes, return_distances=False, return_indices=True)
    filled: Raster = elevations[row, column]
    return filled
