"""Groups of pillars that touch: in compartments that share a side or a corner, and about as high."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.pillars import StepField

Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Groups:
    """Pillars that touch.

    Attributes
    ----------
    pillars : ndarray of shape (n,), int64
        Indices into the step-field in order of group, ascending in each.
    start : ndarray of shape (groups + 1,), int64
        Where each group begins among them; the last entry is n.
    """

    pillars: Integers
    start: Integers

    def __len__(self) -> int:
        return len(self.start) - 1

    @classmethod
    def of(cls, field: StepField, chosen: Integers, reach: float) -> Groups:
        """Group some pillars, ascending, whose heights differ by up to ``reach`` metres."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        one, other = _touching(field, chosen, reach)
        graph = coo_array((np.ones(len(one), bool), (one, other)), shape=(len(chosen), len(chosen)))
        count, group = connected_components(graph, directed=False) if len(chosen) else (0, chosen)
        sizes = np.bincount(group, minlength=count)
        return cls(chosen[np.argsort(group, kind="stable")], np.append(0, np.cumsum(sizes)))

    def largest(self, most: int) -> list[Integers]:
        """Pillars of the largest groups, ascending; the largest group first."""
        order = np.argsort(-np.diff(self.start), kind="stable")[:most]
        return [self.pillars[self.start[number] : self.start[number + 1]] for number in order]


def _touching(field: StepField, chosen: Integers, reach: float) -> tuple[Integers, Integers]:
    """Pairs of places in ``chosen`` whose compartments touch and whose heights differ by up to ``reach``."""
    grid, compartment, elevation = field.compartments.grid, field.compartment[chosen], field.elevation[chosen]
    # Whole steps, so that compartment and elevation make one ascending key.
    scale = (2**31 - 1) / max(float(elevation.max(initial=0.0)), reach, 1e-30)
    height, within = (elevation * scale).astype(np.int64), int(reach * scale)
    key = compartment << 32 | height
    row, column = grid.row_column(compartment)
    above = np.flatnonzero((np.diff(compartment) == 0) & (np.diff(height) <= within))
    pairs = [(above, above + 1)]
    for down, right in ((0, 1), (1, -1), (1, 0), (1, 1)):
        is_inside = (column + right >= 0) & (column + right < grid.columns) & (row + down < grid.rows)
        there = (compartment + down * grid.columns + right) << 32
        found = np.searchsorted(key, there + np.maximum(height - within, 0))
        found = np.minimum(found, len(key) - 1)
        near = (key[found] >= there) & (key[found] <= there + np.minimum(height + within, 2**31 - 1))
        pairs.append((np.flatnonzero(is_inside & near), found[is_inside & near]))
    one, other = (np.concatenate(ends) for ends in zip(*pairs, strict=True))
    return one, other
