"""The pillars that take part in a classification, compartment by compartment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.layers.layering import UNASSIGNED
from stepfield.pillars import StepField

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Towers:
    """The pillars that take part, ordered by compartment and height."""

    total: int  # pillars of the whole step-field
    chosen: Integers  # (M,) which of them take part
    compartment: Integers  # (M,)
    elevation: Floats  # (M,)
    bottom: Integers  # (C,) where the pillars of each compartment begin
    size: Integers  # (C,) how many they are

    @classmethod
    def of(cls, field: StepField, chosen: Integers) -> Towers:
        """Take some pillars of a step-field, ascending."""
        if len(chosen) == len(field):
            whole = field.compartment, field.elevation, field.first[:-1], np.diff(field.first)
            return cls(len(field), chosen, *whole)
        compartment = field.compartment[chosen]
        bottom = np.flatnonzero(np.diff(compartment, prepend=-1))
        sizes = np.diff(np.append(bottom, len(chosen)))
        return cls(len(field), chosen, compartment, field.elevation[chosen], bottom, sizes)

    def every(self, nth: int) -> tuple[Towers, Integers]:
        """Take the pillars of every so manieth compartment, and tell which they are."""
        where = np.flatnonzero(np.repeat(np.arange(len(self.size)) % nth == 0, self.size))
        size = self.size[::nth]
        bottom = np.cumsum(size) - size
        chosen = np.arange(len(where))
        few = Towers(len(where), chosen, self.compartment[where], self.elevation[where], bottom, size)
        return few, where

    def ranks(self) -> Integers:
        """Place within the compartment among those that take part, shape (M,).

        Equal points can make a higher pillar's mean no higher than a lower one's by rounding only, so the
        order of creation is the order of height.
        """
        return np.arange(len(self.chosen)) - np.repeat(self.bottom, self.size)

    def spread(self, layer: Integers) -> Integers:
        """Layers of all pillars of the step-field, unassigned where they take no part."""
        if len(self.chosen) == self.total:
            return layer
        whole = np.full(self.total, UNASSIGNED, np.int64)
        whole[self.chosen] = layer
        return whole
