"""A small scene to edit, and operations drawn at random as an operator might wish for them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepfield import moving
from stepfield.layers import Layering
from stepfield.parameters import Parameters
from stepfield.pillars import StepField
from stepfield.pipeline import Pipeline
from stepfield.plan import Plan
from stepfield.project import LayerStyle, Project
from stepfield.reconstruction import Reconstruction

PARAMETERS = Parameters(cell_size=0.4, layer_tolerance=0.3, alpha=0.1)


def write_shelves(path: Path) -> Path:
    """Write a floor and two shelves above part of it, with holes and clutter, as points."""
    rng = np.random.default_rng(5)
    parts = [
        np.c_[rng.random((600, 2)) * 4, rng.normal(0, 0.005, 600)],
        np.c_[rng.random((250, 2)) * 2 + 1, rng.normal(0.8, 0.005, 250)],
        np.c_[rng.random((150, 2)) * 2 + 1.5, rng.normal(1.6, 0.005, 150)],
        np.c_[rng.random((40, 2)) * 4, rng.random(40) * 2.5],
    ]
    np.save(path, np.vstack(parts))
    return path


class Window:
    """What the window does to a project, without a window: plans, edits, and the pipeline after them."""

    def __init__(self, scan: Path, parameters: Parameters = PARAMETERS) -> None:
        self._scan, self._pipeline = scan, Pipeline()
        self.project = Project(parameters=parameters)
        self.result = self.run(self.project)

    def run(self, project: Project) -> Reconstruction:
        """Return the result of a project."""
        return self._pipeline.run([self._scan], project.parameters, project.moves, project.layers)

    def fresh(self) -> Reconstruction:
        """Return the result of the project as another program would make it."""
        return Pipeline().run([self._scan], self.project.parameters, self.project.moves, self.project.layers)

    def do(self, plan: Plan) -> None:
        """Carry a plan out."""
        self.open(plan.applied(self.project))

    def open(self, project: Project) -> None:
        """Go on with another project: an undone, redone or changed one."""
        self.project, self.result = project, self.run(project)


def random_plan(
    result: Reconstruction, styles: Sequence[LayerStyle], rng: np.random.Generator, locked: Sequence[int] = ()
) -> Plan:
    """Wish for something, possible or not."""
    layers = len(result.layers)
    one, other = (int(layer) for layer in rng.integers(0, layers, 2))
    name = moving.free_name(result, styles)
    match rng.integers(0, 9):
        case 0:
            return moving.merge(result, one, other, locked)
        case 1:
            return moving.split(result, one, float(rng.random() * 2), name, locked)
        case 2:
            return moving.new_layer(result, name)
        case 3:
            return moving.exchange(result, one, other)
        case 4:
            return moving.remove(result, one, locked)
    target = name if rng.random() < 0.2 else int(rng.integers(-1, layers))
    conflict: Literal["swap", "leave"] = "swap" if rng.random() < 0.5 else "leave"
    chosen = rng.random(len(result.field)) < rng.random()
    return moving.move_to(result, chosen, target, conflict=conflict, locked=locked)


def is_one_a_place(field: StepField, layering: Layering) -> bool:
    """Whether no compartment has two pillars in one layer, and every layer has a number that there is."""
    assigned = layering.layer >= 0
    places: NDArray[np.int64] = np.c_[field.compartment[assigned], layering.layer[assigned]]
    return len(np.unique(places, axis=0)) == len(places) and bool(
        (layering.layer >= -1).all() and (layering.layer < layering.count).all()
    )
