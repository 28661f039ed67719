"""Walls in layers of their own: were they wrong, robots would drive through walls or not through doors."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.core.walled import CELL, COLUMN_TOP, LINTEL, TOLERANCE, TOP, walled

from stepfield.layers import UNASSIGNED
from stepfield.moving import exchange, merge, move_to, new_layer, remove
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.plan import Plan
from stepfield.project import Move, Project
from stepfield.reconstruction import Reconstruction
from stepfield.scan.write import write
from stepfield.stack import Stack, write_stack
from stepfield.stack.check import check_stack
from stepfield.suspects import suspects


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("room") / "room.ply"
    write(path, walled(), {})
    return path


def built(room: Path, moves: tuple[Move, ...] = (), **chosen: Any) -> Reconstruction:
    values = {"cell_size": CELL, "layer_tolerance": TOLERANCE, "alpha": 0.1} | chosen
    return Pipeline().run([room], Parameters(**values), moves)


def test_mean_is_the_papers_and_a_wall_is_a_pit_at_half_its_height(room: Path) -> None:
    result = built(room)
    walls = result.field.vertical
    assert walls.sum() == 21  # twenty compartments along the wall, the lintel among them, and a column
    assert result.field.elevation[walls].max() < LINTEL + 0.3
    assert [layer.name for layer in result.layers] == ["Layer 1", "Layer 2"]


@pytest.mark.parametrize("height", ["mean", "median", "p90", "max"])
def test_top_raises_walls_whatever_height_other_pillars_have(room: Path, height: str) -> None:
    result = built(room, walls="top", pillar_height=height)
    walls = result.field.vertical
    assert sorted(set(result.field.elevation[walls].round(3))) == [COLUMN_TOP, TOP]
    assert result.field.elevation[~walls].max() < 0.01
    assert result.layering.obstacles == ()


@pytest.mark.parametrize("method", ["rank", "elevation"])
def test_a_layer_of_obstacles_is_the_last_and_leaves_the_floor_whole_in_the_door(
    room: Path, method: str
) -> None:
    result = built(room, walls="layer", layering=method)
    assert [layer.name for layer in result.layers] == ["Layer 1", "Obstacles"]
    floor, obstacles = result.layers
    assert obstacles.is_obstacles
    assert not floor.is_obstacles
    field = result.field
    assert field.vertical[obstacles.pillars].all()
    assert not field.vertical[floor.pillars].any()
    both = np.intersect1d(field.compartment[floor.pillars], field.compartment[obstacles.pillars])
    assert len(both) == 5  # the door's
    assert len(result.seams) == 0


def test_obstacles_are_nothing_suspicious(room: Path) -> None:
    """A column stands alone: that is what columns do."""
    result = built(room, walls="layer")
    among = result.layering.in_obstacles()
    assert not any(mask[among].any() for mask in suspects(result).masks.values())


def test_names_of_the_operators_own_are_kept_apart(room: Path) -> None:
    result = built(room, (new_layer(built(room, walls="layer"), "Mine").moves[0],), walls="layer")
    assert [layer.name for layer in result.layers] == ["Layer 1", "Obstacles", "Mine"]
    assert [layer.is_obstacles for layer in result.layers] == [False, True, False]


def kinds_after(room: Path, *plans: Callable[[Reconstruction], Plan]) -> list[bool]:
    moves: tuple[Move, ...] = ()
    for plan in plans:
        made = plan(built(room, moves, walls="layer"))
        assert made.moves, made.reason
        moves += made.moves
    return [layer.is_obstacles for layer in built(room, moves, walls="layer").layers]


def test_a_layer_of_obstacles_stays_one_wherever_moves_put_it(room: Path) -> None:
    def mine(result: Reconstruction) -> Plan:
        return new_layer(result, "Mine")

    assert kinds_after(room, lambda r: exchange(r, 0, 1)) == [True, False]
    assert kinds_after(room, mine, lambda r: exchange(r, 1, 2)) == [False, False, True]
    assert kinds_after(room, mine, lambda r: remove(r, 0)) == [True, False]
    assert kinds_after(room, lambda r: merge(r, 1, 0)) == [False]


def test_taking_back_a_move_gives_the_layer_of_obstacles_back(room: Path) -> None:
    pipeline, parameters = Pipeline(), built(room, walls="layer").parameters
    first = pipeline.run([room], parameters)
    merged = pipeline.run([room], parameters, merge(first, 1, 0).moves)
    again = pipeline.run([room], parameters)
    assert merged.layering.obstacles == ()
    assert again.layering.obstacles == (1,)
    assert np.array_equal(again.layering.layer, first.layering.layer)


def test_a_move_to_obstacles_waits_while_there_are_none(room: Path) -> None:
    """It must not put walls into the floor, nor be lost."""
    result = built(room, walls="layer")
    chosen = np.zeros(len(result.field), bool)
    chosen[0] = True
    moves = move_to(result, chosen, 1).moves
    assert built(room, moves, walls="layer").layering.layer[0] == 1
    waiting = built(room, moves, walls="top")
    assert not waiting.outcomes[0].resolved
    assert "obstacles" in waiting.outcomes[0].reason


def test_a_move_to_a_surface_does_not_end_among_obstacles(room: Path) -> None:
    """Without layers of obstacles there were two; now layer 2 of 2 is another one."""
    before = built(room, walls="top")
    chosen = before.field.vertical & (before.field.low > LINTEL - 0.1)
    moves = move_to(before, chosen, "Beams").moves + move_to(before, ~chosen, 1).moves
    after = built(room, moves, walls="layer")
    assert all(outcome.resolved for outcome in after.outcomes)
    assert after.layers[1].is_obstacles
    assert not (after.layering.layer[~after.field.vertical] == 1).any()


def test_projects_without_obstacles_are_as_they_were(room: Path) -> None:
    """Older programs read them: nothing new is in their moves."""
    result = built(room, walls="top")
    moves = merge(result, 1, 0).moves
    text = Project(moves=moves).content().decode()
    assert '"kind"' not in text


def test_most_layers_holds_for_surfaces_and_obstacles_apart(room: Path) -> None:
    result = built(room, walls="layer", max_layers=1)
    assert [layer.is_obstacles for layer in result.layers] == [False, True]
    assert result.layering.unassigned == 0


def test_walls_of_few_points_stay_out(room: Path) -> None:
    most = int(built(room).field.points.max())
    result = built(room, walls="layer", min_points=most)
    among = result.layering.layer != UNASSIGNED
    assert (result.field.points[among] >= most).all()


def test_nothing_but_walls_makes_obstacles_only(tmp_path: Path) -> None:
    write(tmp_path / "wall.ply", walled()[walled()[:, 2] > 0.04], {})
    result = built(tmp_path / "wall.ply", walls="layer")
    assert [layer.name for layer in result.layers] == ["Obstacles"]
    assert check_stack(_written(result, tmp_path / "stack")).faults == ()


def _written(result: Reconstruction, folder: Path) -> Path:
    write_stack(result, folder)
    return folder


@pytest.mark.parametrize("bits", [8, 16])
def test_a_stack_says_where_obstacles_begin_and_end(room: Path, tmp_path: Path, bits: int) -> None:
    result = built(room, walls="layer", bits=bits)
    folder = _written(result, tmp_path / "stack")
    assert check_stack(folder, [room]).faults == ()
    stack = Stack.open(folder)
    floor, obstacles = stack.manifest.layers
    assert (floor.kind, floor.bottom) == ("surface", None)
    assert (obstacles.kind, obstacles.bottom) == ("obstacles", "layer_01_bottom.png")
    tops, bottoms = stack.elevations(obstacles), stack.bottoms(obstacles)
    assert bottoms is not None
    assert np.array_equal(np.isnan(tops), np.isnan(bottoms))
    level = obstacles.scale
    assert np.nanmax(tops) == pytest.approx(TOP, abs=level)
    assert np.nanmin(bottoms) == pytest.approx(0, abs=1.5 * level)
    assert np.nanmax(bottoms) == pytest.approx(LINTEL, abs=level)
    assert stack.bottoms(floor) is None


def test_obstacles_are_written_the_same_each_time(room: Path, tmp_path: Path) -> None:
    folders = [_written(built(room, walls="layer"), tmp_path / name) for name in ("one", "other")]
    files = [{file.name: file.read_bytes() for file in folder.iterdir()} for folder in folders]
    assert files[0] == files[1]
    assert "layer_01_bottom.png" in files[0]


def test_check_finds_obstacles_without_or_with_wrong_lower_ends(room: Path, tmp_path: Path) -> None:
    folder = _written(built(room, walls="layer"), tmp_path / "stack")
    tops = (folder / "layer_01.png").read_bytes()
    (folder / "layer_01.png").write_bytes((folder / "layer_01_bottom.png").read_bytes())
    (folder / "layer_01_bottom.png").write_bytes(tops)
    assert any("higher than" in fault for fault in check_stack(folder).faults)
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["layers"][1]["bottom"] = None
    (folder / "manifest.json").write_text(json.dumps(manifest))
    assert any("bottom is None" in fault for fault in check_stack(folder).faults)


@pytest.mark.parametrize("cell", [0.1, 0.15])
def test_what_was_put_right_survives_another_cell_size(room: Path, cell: float) -> None:
    """The lintel is a layer of its own, the column is ground: both stay so on another grid."""
    result = built(room, walls="layer")
    field = result.field
    lintel, column = field.vertical & (field.low > 1), field.vertical & (field.high < TOP - 0.5)
    moves = move_to(result, lintel, "Lintel").moves + move_to(result, column, 0).moves
    other = built(room, moves, walls="layer", cell_size=cell)
    assert all(outcome.resolved for outcome in other.outcomes)
    assert [layer.name for layer in other.layers] == ["Layer 1", "Obstacles", "Lintel"]
    assert [layer.is_obstacles for layer in other.layers] == [False, True, False]
    low = other.field.low
    assert (low[other.layers[2].pillars] > 1).all()
    assert (other.field.high[other.layers[0].pillars] > 1).any()
