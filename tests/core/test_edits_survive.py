"""Three hundred random moves on a real scan, through other cell sizes and back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from stepfield import moving
from stepfield.moves import Replay
from stepfield.parameters import Parameters
from stepfield.pillars import StepField
from stepfield.pipeline import Pipeline
from stepfield.places import pillars_in, standing_in
from stepfield.project import Move, Project
from stepfield.reconstruction import Reconstruction

MOVES = 300
#: Samples along each side of a compartment when areas are compared.
SAMPLES = 6
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Edits:
    """Random moves, the step-field they were made on and what each of them came to.

    Attributes
    ----------
    moves : tuple of Move
    result : Reconstruction
        After all of them.
    moved : list of ndarray
        Pillars each move put into its layer.
    targets : list of int
    """

    moves: tuple[Move, ...]
    result: Reconstruction
    moved: list[Integers]
    targets: list[int]


@pytest.fixture(scope="module")
def room(real_scan: Callable[[str], Path]) -> Path:
    return real_scan("data__room_scan1.pcd")


@pytest.fixture(scope="module")
def edits(room: Path) -> Edits:
    """Move what lies within a metre or two of some place to some layer, over and over."""
    rng, pipeline, parameters = np.random.default_rng(1), Pipeline(), Parameters(cell_size=0.1)
    result = pipeline.run([room], parameters)
    project, moved, targets = Project(), [], []
    while len(project.moves) < MOVES:
        target = int(rng.integers(-1, len(result.layers)))
        plan = moving.move_to(result, near(result.field, rng), target)
        if plan.moves:
            before, project = result.layering.layer, plan.applied(project)
            result = pipeline.run([room], parameters, project.moves)
            moved.append(np.flatnonzero((before != target) & (result.layering.layer == target)))
            targets.append(target)
    return Edits(project.moves, result, moved, targets)


def near(field: StepField, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Choose the pillars around one of them, as an operator does with a lasso and a z range."""
    middle = rng.integers(len(field))
    centres = field.compartments.grid.centres(field.compartment)
    distance = np.hypot(*(centres - centres[middle]).T)
    height = np.abs(field.elevation - field.elevation[middle])
    chosen: NDArray[np.bool_] = (distance <= rng.uniform(1, 2)) & (height < 1)
    return chosen


def kept_area(
    before: StepField, chosen: Integers, wanted: Integers, after: StepField, layer: Integers
) -> float:
    """Share of pillars' area where a pillar of the same elevations is in the wanted layer.

    Area where another grid has no points at these elevations is in no layer and does not count.
    """
    x0, y0, x1, y1, low, high = before.boxes(chosen).T
    along, across = (np.indices((SAMPLES, SAMPLES)).reshape(2, -1) + 0.5) / SAMPLES
    grid = after.compartments.grid
    compartment = grid.compartment(
        (x0[:, None] + along * (x1 - x0)[:, None] - grid.west).ravel(),
        (y0[:, None] + across * (y1 - y0)[:, None] - grid.south).ravel(),
    )
    sample, pillar = standing_in(after, compartment)
    of = sample // SAMPLES**2
    lowest = after.compartments.lowest
    meets = (after.low[pillar] + lowest <= high[of] + 1e-6) & (after.high[pillar] + lowest >= low[of] - 1e-6)
    is_there, is_kept = (np.zeros(len(compartment), bool) for _ in range(2))
    is_there[sample[meets]] = True
    is_kept[sample[meets & (layer[pillar] == wanted[of])]] = True
    return float(np.count_nonzero(is_kept) / np.count_nonzero(is_there))


def test_another_cell_size_and_back_gives_the_identical_layers(edits: Edits, room: Path) -> None:
    pipeline = Pipeline()
    for cell in (0.1, 0.07):
        pipeline.run([room], Parameters(cell_size=cell), edits.moves)
    again = pipeline.run([room], Parameters(cell_size=0.1), edits.moves)
    assert again.layering.layer.tobytes() == edits.result.layering.layer.tobytes()
    assert all(outcome.resolved for outcome in again.outcomes)
    for ours, theirs in zip(again.height_maps(), edits.result.height_maps(), strict=True):
        assert np.array_equal(ours.gray, theirs.gray)


def test_a_coarser_grid_keeps_what_each_move_moved_in_its_layer(edits: Edits, room: Path) -> None:
    """Only compartments on the rim of what was moved may go with what is beside it."""
    coarse = Pipeline().run([room], Parameters(cell_size=0.15))
    replay, kept, area = Replay(coarse.field, coarse.automatic), 0.0, 0
    for nth, (moved, target) in enumerate(zip(edits.moved, edits.targets, strict=True), start=1):
        layer = replay.edited(edits.moves[:nth]).layering.layer
        # Swapped pillars that came to the layer from elsewhere in a compartment were not asked for.
        asked = pillars_in(edits.result.field, edits.moves[nth - 1].boxes(), one_only=target != -1)
        chosen = np.intersect1d(moved, asked)
        if len(chosen):
            wanted = np.full(len(chosen), target)
            kept += len(chosen) * kept_area(edits.result.field, chosen, wanted, coarse.field, layer)
            area += len(chosen)
    assert kept / area >= 0.9


def test_a_coarser_grid_keeps_the_end_of_it_all(edits: Edits, room: Path) -> None:
    """After hundreds of moves over one another there is a rim everywhere: at best 0.93 could be kept.

    Were every move to leave its rims to the one before, it would be 0.89.
    """
    coarse = Pipeline().run([room], Parameters(cell_size=0.15), edits.moves)
    result = edits.result
    chosen = np.flatnonzero(result.layering.layer != result.automatic.layer)
    wanted = result.layering.layer[chosen]
    assert kept_area(result.field, chosen, wanted, coarse.field, coarse.layering.layer) >= 0.9
    assert sum(outcome.resolved for outcome in coarse.outcomes) >= 0.98 * MOVES
