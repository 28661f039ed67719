"""What a scan holds before anything is cleaned away: what the cleaning panel offers to choose from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from stepfield.parameters import Box, Unit, Up
from stepfield.scan import Scan


@dataclass(frozen=True, eq=False)
class ScanFacts:
    """A scan as it was read.

    Attributes
    ----------
    scan : Scan
        All its points.
    bounds : tuple of float
        x0, y0, z0, x1, y1, z1 in metres.
    classes : mapping of int to int
        Points of each LAS class present, by code, ascending; empty when the scan has no classes.
    """

    scan: Scan
    bounds: Box
    classes: Mapping[int, int] = field(default_factory=dict)

    @property
    def points(self) -> int:
        """How many points were read."""
        return len(self.scan)

    @property
    def unit(self) -> Unit:
        """The unit of the files' coordinates: as they declare it, or as the operator says."""
        return self.scan.unit

    @property
    def up(self) -> Up:
        """The files' axis that points up."""
        return self.scan.up


def facts_of(scan: Scan) -> ScanFacts:
    """Look at every point once."""
    low, high = (tuple(ends.tolist()) for ends in scan.bounds())
    codes = scan.attributes.get("classification")
    held = np.bincount(codes, minlength=1) if codes is not None else np.zeros(0, np.int64)
    classes = {int(code): int(held[code]) for code in np.flatnonzero(held)}
    return ScanFacts(scan, (*low, *high), classes)
