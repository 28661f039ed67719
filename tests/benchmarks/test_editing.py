"""Editing a million pillars in five layers: planning, doing and undoing a move, and the project's file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest
from tests.benchmarks.conftest import Table, seconds

from stepfield import moving
from stepfield.moves import Replay
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.places import pillars_in
from stepfield.project import Move, Project
from stepfield.reconstruction import Reconstruction

#: A blink: what the hand may wait for on the screen, of which the core may take a part.
BLINK = 0.2
MOVED = 100_000
STEPS = 10_000
PARAMETERS = Parameters(cell_size=1.0, layer_tolerance=0.3, alpha=0.1)


@pytest.fixture(scope="module")
def scan(folder: Path) -> Path:
    rng, n = np.random.default_rng(1), 500
    east, north = (a.ravel() + 0.5 for a in np.meshgrid(np.arange(n), np.arange(n)))
    stacks = [np.c_[east, north, np.full(n * n, 2.0 * k) + 0.3 * np.sin(east / 30)] for k in range(5)]
    path = folder / "five_storeys.npy"
    np.save(path, np.vstack(stacks)[rng.random(5 * n * n) < 0.8])
    return path


def taking_turns(pipeline: Callable[[Project], object], *projects: Project) -> list[float]:
    """Least seconds to get to each of some projects from the one before it, in turns."""
    times = []
    pipeline(projects[-1])
    for _ in range(5):
        for project in projects:
            start = perf_counter()
            pipeline(project)
            times.append(perf_counter() - start)
    return [min(times[n :: len(projects)]) for n in range(len(projects))]


def chosen_in(result: Reconstruction, number: int) -> np.ndarray:
    """Choose the first pillars of the middle layer."""
    mask = np.zeros(len(result.field), bool)
    mask[result.layering.members(2)[:number]] = True
    return mask


def test_a_move_and_its_undoing(scan: Path, table: Table) -> None:
    pipeline = Pipeline()

    def run(project: Project) -> Reconstruction:
        return pipeline.run([scan], PARAMETERS, project.moves, project.layers)

    none = Project(parameters=PARAMETERS)
    result = run(none)
    name = f"{MOVED / 1000:g} k of {len(result.field) / 1e6:.2f} M pillars"
    chosen = chosen_in(result, MOVED)
    plan = moving.move_to(result, chosen, 1)
    one = plan.applied(none)
    boxes = one.moves[0].boxes()
    table.add(f"plan to move {name}", seconds(lambda: moving.move_to(result, chosen, 1)), "a blink", BLINK)
    found = seconds(lambda: pillars_in(result.field, boxes, one_only=True))
    table.add(f"find {len(boxes) / 1000:.0f} k places again", found, "asked for", 0.04, "<= 1")
    undo, move = taking_turns(run, none, one)
    table.add(f"move {name}, through the pipeline", move, "a blink", BLINK, "<= 0.5")
    table.add(f"undo it; {plan.swapped} had swapped", undo, "a blink", BLINK, "<= 0.5")
    for plan in (moving.merge(result, 0, 1), moving.exchange(result, 0, 1), moving.remove(result, 3)):
        undo, done = taking_turns(run, none, plan.applied(none))
        table.add(plan.text, done, "a blink", BLINK, "<= 0.5")
        table.add("  undone", undo, "a blink", BLINK, "<= 0.5")


def test_a_long_history(scan: Path, table: Table) -> None:
    result = Pipeline().run([scan], PARAMETERS)
    rng, members = np.random.default_rng(2), result.layering.members(2)
    moves: list[Move] = []
    start = perf_counter()
    for _ in range(STEPS):
        mask = np.zeros(len(result.field), bool)
        mask[rng.choice(members, 10)] = True
        moves += moving.move_to(result, mask, 1).moves
    table.add(f"{STEPS} plans of 10 pillars", perf_counter() - start, "a blink each", BLINK * STEPS)
    replay = Replay(result.field, result.automatic)
    table.add(f"{len(moves)} moves at once", seconds(lambda: replay.edited(moves), 1), "a blink", BLINK)
    one_less = moves[:-1]
    again = seconds(lambda: (replay.edited(one_less), replay.edited(moves)), 5)
    table.add("  the last of them undone and redone", again, "a blink", BLINK, "<= 0.5")


def test_the_file(scan: Path, folder: Path, table: Table) -> None:
    result = Pipeline().run([scan], PARAMETERS)
    project = moving.move_to(result, chosen_in(result, MOVED), 1).applied(Project(parameters=PARAMETERS))
    path = folder / "edited.stepfield"
    table.add(
        "save a project of 100 k moved pillars", seconds(lambda: project.save(path)), "a second", 1.0, "<= 1"
    )
    table.add("open it", seconds(lambda: Project.read(path)), "a second", 1.0, "<= 1")
    assert Project.read(path) == project
