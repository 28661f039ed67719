"""The points of a scan as a view draws them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepfield.scan import Scan
from stepfield_app.render.scene import Points
from stepfield_app.scenes.arrays import frozen, in_chunks, sample
from stepfield_app.scenes.colouring import Colouring

Floats = NDArray[np.float64]

#: Points that stand for all when a view is framed, the share of them at either end of an axis that may be
#: strays, and the room beside the others as a share of their extent.
FRAMED, STRAYS, BESIDE = 100_000, 0.005, 0.03


@dataclass(frozen=True, eq=False)
class Cloud:
    """A scan in local coordinates.

    Attributes
    ----------
    scan : Scan
    origin : ndarray of shape (3,), float64
        What was subtracted from the scan's coordinates, metres.
    places : ndarray of shape (N, 3), float32
        In the order of the scan, metres.
    """

    scan: Scan
    origin: Floats
    places: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.places)

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner in local coordinates, metres."""
        low, high = self.scan.bounds()
        return low - self.origin, high - self.origin

    @cached_property
    def core(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of nearly all points: a few strays far away would make the rest tiny."""
        some = self.places[sample(len(self), FRAMED)]
        if not len(some):
            return self.box
        low, high = np.quantile(some, [STRAYS, 1 - STRAYS], axis=0).astype(np.float64)
        beside = BESIDE * (high - low)
        return np.maximum(low - beside, self.box[0]), np.minimum(high + beside, self.box[1])


def cloud(scan: Scan, origin: Floats) -> Cloud:
    """Bring a scan near ``origin``, subtracting before anything is rounded to float32.

    Parameters
    ----------
    scan : Scan
    origin : ndarray of shape (3,)
        Scan coordinates, metres.
    """
    origin = frozen(np.array(origin, np.float64))
    places = np.empty((len(scan), 3), np.float32)
    for i, axis in enumerate(scan.axes):
        shift, distance = axis.bounds()[0] - origin[i], axis.measure()
        column = places[:, i]

        def fill(part: slice) -> None:
            values = distance(part)  # noqa: B023 - used up before the next axis
            if shift:  # noqa: B023
                values += shift  # noqa: B023
            column[part] = values  # noqa: B023

        in_chunks(len(scan), fill)
    return Cloud(scan, origin, frozen(places))


def points(cloud: Cloud, colouring: Colouring, size: float = 1.0) -> Points:
    """Put places and colours together for a view; nothing is copied."""
    return Points(cloud.places, colouring.codes, colouring.palette, size)
