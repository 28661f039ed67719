"""A robot in MuJoCo: over and under the bridge, on the truth and on its reconstruction."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from tests.core.bridges import DECK, bridge_stack
from tests.core.targets.stacks import stack_of

from stepfield.cli import run
from stepfield.errors import Cancelled, ParameterError, SceneError, SimulationError
from stepfield.simulate import meshes, pictures, worlds
from stepfield.simulate.behaviour import behaviour, difference
from stepfield.simulate.drive import Track, drive
from stepfield.simulate.engine import engine
from stepfield.simulate.robot import WHEEL_RADIUS, Place, wheel_speeds
from stepfield.simulate.route import Command, Route, parse_commands, parse_start
from stepfield.simulate.way import SPEED, longest_way
from stepfield.stack import Stack
from stepfield.surface import Mesh
from stepfield.targets.terrain import Terrain

pytest.importorskip("mujoco", reason="mujoco is not installed: no robot is driven")


@pytest.fixture(scope="module")
def bridge(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return bridge_stack(tmp_path_factory.mktemp("bridge"))


def route_of(terrain: Terrain, start: str, commands: str) -> Route:
    return Route(parse_start(start, terrain), parse_commands(commands))


def driven(terrain: Terrain, route: Route) -> Track:
    return drive(worlds.of_stack("made", terrain, route.start), route)


def test_the_robot_crosses_the_bridge(bridge: Path) -> None:
    terrain = Terrain.of_stack(bridge)
    track = driven(terrain, route_of(terrain, "-9,0,0", "19,1,0"))
    gone = behaviour(track)
    assert (gone.stuck, gone.fell, gone.overturned) == (0, False, False)
    assert gone.end[0] > 8
    on_deck = np.abs(track.positions[:, 0]) < 5
    np.testing.assert_allclose(track.positions[on_deck, 2], DECK + WHEEL_RADIUS, atol=0.06)


def test_the_robot_passes_beneath_the_bridge(bridge: Path) -> None:
    # Were the deck's height-fields solid down to the road, it would drive into them.
    terrain = Terrain.of_stack(bridge)
    track = driven(terrain, route_of(terrain, "0.5,-6,90", "12,1,0"))
    gone = behaviour(track)
    assert (gone.stuck, gone.fell, gone.overturned) == (0, False, False)
    assert gone.end[1] > 5
    np.testing.assert_allclose(track.positions[50:, 2], WHEEL_RADIUS, atol=0.06)


def test_a_start_below_a_layer_is_found_by_its_elevation(bridge: Path) -> None:
    terrain = Terrain.of_stack(bridge)
    assert parse_start("0,0,0", terrain).z > DECK
    assert parse_start("0,0,0,0", terrain).z < 1


def test_the_truth_and_its_reconstruction_make_a_robot_behave_alike(bridge: Path) -> None:
    terrain = Terrain.of_stack(bridge)
    route = route_of(terrain, "-9,0,0", "6,1,0;4,0.8,10")
    truth = drive(worlds.of_mesh("truth", meshes.true_mesh("bridge", terrain), route.start), route)
    apart = difference(driven(terrain, route), truth)
    assert apart.stuck == 0
    assert apart.path_max < 0.6
    assert apart.height_rmse < 0.1
    assert apart.pitch_rmse < 5
    same = difference(truth, truth)
    assert (same.path_max, same.pitch_max, same.roll_max, same.height_max) == (0, 0, 0, 0)


def test_equal_routes_give_equal_tracks(bridge: Path) -> None:
    terrain = Terrain.of_stack(bridge)
    route = route_of(terrain, "-9,0,0", "2,1,0")
    np.testing.assert_array_equal(driven(terrain, route).states, driven(terrain, route).states)


def test_a_wall_stops_the_robot_and_that_is_counted(tmp_path: Path) -> None:
    walled = np.zeros((30, 40))
    walled[:, 25:] = 1.0
    terrain = Terrain.of_stack(stack_of(tmp_path / "walled", [walled], west=0.0, south=0.0))
    gone = behaviour(driven(terrain, route_of(terrain, "2,3.7,0", "8,0.8,0")))
    assert gone.stuck >= 1
    assert gone.stuck_seconds > 2
    assert gone.end[0] < 6.5


def test_an_edge_is_fallen_over_and_that_is_said(tmp_path: Path) -> None:
    terrain = Terrain.of_stack(stack_of(tmp_path / "flat", [np.zeros((20, 20))], west=0.0, south=0.0))
    gone = behaviour(driven(terrain, route_of(terrain, "2,2.5,0", "8,0.8,0")))
    assert gone.fell
    assert gone.seconds < 8


def test_a_level_floor_gives_the_way_that_was_asked_for(tmp_path: Path) -> None:
    # Wheels that turn the wrong way round, or by degrees for radians, would end elsewhere.
    terrain = Terrain.of_stack(stack_of(tmp_path / "flat", [np.zeros((60, 60))], west=0.0, south=0.0))
    straight = driven(terrain, route_of(terrain, "3,7,0", "5,0.8,0"))
    assert straight.positions[-1, :2] == pytest.approx((7, 7), abs=0.15)
    turned = driven(terrain, route_of(terrain, "7,7,0", "3,0,60"))
    assert 135 < turned.yaw[-1] % 360 < 225  # how much wheels skid is not the same everywhere
    assert turned.positions[-1, :2] == pytest.approx((7, 7), abs=0.2)


@pytest.mark.parametrize(("heading", "pitch", "roll"), [(0, -1, 0), (180, 1, 0), (90, 0, -1), (-90, 0, 1)])
def test_a_slope_shows_in_pitch_and_roll(tmp_path: Path, heading: int, pitch: int, roll: int) -> None:
    east = np.indices((40, 40))[1] * 0.25
    terrain = Terrain.of_stack(stack_of(tmp_path / "slope", [0.2 * east], west=0.0, south=0.0))
    track = driven(terrain, route_of(terrain, f"5,5,{heading}", "2,0.5,0"))
    slope = np.degrees(np.arctan(0.2))
    assert np.median(track.pitch) == pytest.approx(pitch * slope, abs=1)
    assert np.median(track.roll) == pytest.approx(roll * slope, abs=1)
    assert np.abs(np.cos(np.radians(track.yaw - heading))).min() > 0.95


def test_a_mesh_is_met_where_it_is(tmp_path: Path) -> None:
    # MuJoCo's triangles are thick: unless they are lowered by that, the robot floats.
    corners = np.array([[0.0, 0, 1], [4, 0, 1], [4, 4, 1], [0, 4, 1]])
    for triangles in ([[0, 1, 2], [0, 2, 3]], [[0, 2, 1], [0, 3, 2]]):
        mesh = Mesh(corners, np.array(triangles))
        world = worlds.of_mesh("square", mesh, Place(2, 2, 1 + WHEEL_RADIUS + 0.05))
        track = drive(world, Route(Place(2, 2, 0), (Command(1, 0, 0),)))
        assert track.positions[-1, 2] == pytest.approx(1 + WHEEL_RADIUS, abs=0.003)


def test_wheel_speeds_are_of_the_whole_robot() -> None:
    np.testing.assert_allclose(wheel_speeds(0.6, 0), 0.6 / WHEEL_RADIUS)
    left, right = wheel_speeds(0, 90)[:2]
    assert left == -right < 0  # to the left


def test_the_longest_way_keeps_clear_of_steps_and_holes(tmp_path: Path) -> None:
    ground = np.zeros((40, 60))
    ground[:, 30] = np.nan
    ground[20, :30] = 0.5
    terrain = Terrain.of_stack(stack_of(tmp_path / "made", [ground], west=0.0, south=0.0))
    way = longest_way(terrain)
    assert way.start.heading == -90.0  # 10 m southwards, in the east, where nothing is in the way
    assert way.start.x > 31 * 0.25
    assert way.commands[0].seconds * SPEED > 8
    assert not behaviour(driven(terrain, way)).fell


def test_no_way_is_one_sentence(tmp_path: Path) -> None:
    rough = np.random.default_rng(0).random((30, 30)) * 3
    terrain = Terrain.of_stack(stack_of(tmp_path / "made", [rough]))
    with pytest.raises(SimulationError, match="--start"):
        longest_way(terrain)


def test_commands_follow_each_other() -> None:
    route = Route(Place(0, 0, 0), (Command(2, 1, 0), Command(1, 0, 30)))
    assert [route.at(t).forward for t in (0.5, 1.0, 2.9, 3.0, 4.5)] == [0, 1, 1, 0, 0]
    assert route.seconds == 4.0


@pytest.mark.parametrize("text", ["", "1,2", "0,1,1", "1,nan,0", "9999,1,0", "1,5,0", "1,1,1;x"])
def test_impossible_commands_are_one_sentence(text: str) -> None:
    with pytest.raises(ParameterError, match="impossible commands"):
        parse_commands(text)


def test_a_cloud_becomes_a_mesh_of_all_its_points(bridge: Path) -> None:
    from stepfield.scan import open_scan

    stack, terrain = Stack.open(bridge), Terrain.of_stack(bridge)
    scan = open_scan([bridge.with_name("bridge.ply")], stack.manifest.parameters).thinned(120_000)
    mesh = meshes.cloud_mesh(scan, stack, terrain)
    assert len(mesh.vertices) > 0.95 * len(scan)
    assert mesh.triangles.max() < len(mesh.vertices)
    assert len(mesh.triangles) > 1.2 * len(scan)
    sides = mesh.vertices[mesh.triangles][:, :, :2]
    assert np.linalg.norm(sides - np.roll(sides, 1, axis=1), axis=2).max() <= 2 * 0.15 + 1e-9


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl", ".glb"])
def test_truth_comes_from_files_too(tmp_path: Path, suffix: str) -> None:
    trimesh = pytest.importorskip("trimesh")
    corners = np.array([[0.0, 0, 1], [4, 0, 1], [4, 3, 2], [0, 3, 2]])
    turned = corners[:, [0, 2, 1]] * [1, 1, -1] if suffix == ".glb" else corners
    trimesh.Trimesh(turned, [[0, 1, 2], [0, 2, 3]], process=False).export(tmp_path / f"truth{suffix}")
    terrain = Terrain.of_stack(stack_of(tmp_path / "made", [np.zeros((5, 5))]))
    mesh = meshes.true_mesh(str(tmp_path / f"truth{suffix}"), terrain)
    assert {tuple(corner) for corner in mesh.vertices.round(6)} == {tuple(corner) for corner in corners}


@pytest.mark.parametrize("source", ["nothing", "nothing.obj", "damaged.stl", "empty.ply"])
def test_no_truth_is_one_sentence(tmp_path: Path, source: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "damaged.stl").write_bytes(b"\x00" * 30)
    (tmp_path / "empty.ply").write_text("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")
    terrain = Terrain.of_stack(stack_of(tmp_path / "made", [np.zeros((5, 5))]))
    with pytest.raises(SceneError) as caught:
        meshes.true_mesh(source, terrain)
    assert "\n" not in str(caught.value)


def test_a_drive_can_be_stopped(tmp_path: Path) -> None:
    terrain = Terrain.of_stack(stack_of(tmp_path / "flat", [np.zeros((20, 20))], west=0.0, south=0.0))
    route = route_of(terrain, "2,2.5,0", "8,0.1,0")

    def stop(share: float, what: str) -> None:
        if share > 0:
            raise Cancelled

    with pytest.raises(Cancelled):
        drive(worlds.of_stack("flat", terrain, route.start), route, stop)


def test_without_anything_that_draws_there_is_a_plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    terrain = Terrain.of_stack(stack_of(tmp_path / "flat", [np.zeros((20, 30))], west=0.0, south=0.0))
    route = route_of(terrain, "1,2.5,0", "3,0.8,0")
    world = worlds.of_stack("flat", terrain, route.start)
    track = drive(world, route)
    monkeypatch.setenv("MUJOCO_GL", "nothing of that name")
    assert pictures.strip([(world, track)]) is None
    (tmp_path / "plan.png").write_bytes(pictures.plan(terrain, [(world, track)]))
    with Image.open(tmp_path / "plan.png") as image:
        line = np.argwhere((np.asarray(image)[:600] == 20).all(axis=2)).mean(axis=0)
    assert line == pytest.approx((300, 264), abs=20)  # along the middle, from 1 m to 3.4 m of 7.5 m


@pytest.mark.parametrize("fault", [ImportError("no mujoco"), RuntimeError("invalid MUJOCO_GL\n")])
def test_no_mujoco_is_one_sentence(fault: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(name: str) -> None:
        raise fault

    monkeypatch.setattr("stepfield.simulate.engine.importlib.import_module", fail)
    with pytest.raises(SimulationError) as caught:
        engine()
    assert "\n" not in str(caught.value)


def called(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, Any]:
    code = run(["simulate", *map(str, arguments)])
    shown = capsys.readouterr()
    return code, json.loads(shown.out) if "--json" in arguments else shown


def test_the_command_compares_and_tells_costs(
    bridge: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ("--truth", "bridge", "--start", "-19,0,0", "--commands", "2,0.8,0", "--json")
    code, said = called(capsys, bridge, *given, "--picture", tmp_path / "strip.png")
    assert code == 0
    assert said["reference"] == "truth"
    assert set(said["drives"]) == {"truth", "bridge"}
    assert said["differences"]["bridge"]["path_max"] < 0.1
    assert said["costs"]["bridge"]["megabytes"] < said["costs"]["truth"]["megabytes"]
    assert said["costs"]["bridge"]["step_milliseconds"] > 0
    assert said["picture"] in {"strip", "plan"}
    with Image.open(tmp_path / "strip.png") as image:
        assert image.format == "PNG"


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["nowhere"], 1),
        (["flat", "--start", "1,1,0"], 2),
        (["flat", "--start", "99,99,0", "--commands", "1,1,0"], 2),
        (["flat", "--commands", "fast"], 2),
        (["flat", "--truth", "nothing"], 1),
        (["flat", "--picture", "no/such/folder.png"], 1),
        (["holes"], 1),
    ],
)
def test_bad_input_is_one_sentence(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    code: int,
) -> None:
    monkeypatch.chdir(tmp_path)
    stack_of(tmp_path / "flat", [np.zeros((20, 20))], west=0.0, south=0.0)
    stack_of(tmp_path / "holes", [np.where(np.indices((9, 9)).sum(axis=0) % 2, np.nan, 1.0)])
    found, shown = called(capsys, *arguments)
    assert found == code
    assert shown.out == ""
    assert shown.err.startswith("error: ")
    assert shown.err.count("\n") == 1
