"""``stepfield simulate``: how a robot behaves on a stack, and how on the truth (paper, section 7)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from stepfield.cli.report import Reporter, counted
from stepfield.errors import ParameterError, SimulationError
from stepfield.files import write_atomically
from stepfield.progress import Progress, part
from stepfield.scan import open_scan
from stepfield.simulate import meshes, pictures, worlds
from stepfield.simulate.behaviour import Behaviour, Difference, behaviour, difference
from stepfield.simulate.drive import Track, drive
from stepfield.simulate.engine import engine, viewer
from stepfield.simulate.route import Route, parse_commands, parse_start
from stepfield.simulate.way import longest_way
from stepfield.simulate.worlds import World
from stepfield.stack import Stack
from stepfield.targets.terrain import Terrain

TRUTH, CLOUD = "truth", "cloud"
#: Seconds of driving that tell what a step on the mesh of all points costs.
TRIAL = 2.0


@dataclass(frozen=True)
class Wish:
    """What is asked for on the command line."""

    stacks: tuple[Path, ...]
    truth: str | None = None
    scan: tuple[Path, ...] = ()
    start: str | None = None
    commands: str | None = None
    picture: Path | None = None
    viewer: bool = False


@dataclass(frozen=True, eq=False)
class Drive:
    """One world and what happened in it."""

    world: World
    track: Track


def simulate_stacks(wish: Wish, reporter: Reporter) -> None:
    """Drive the same commands on the truth and on every stack, and say how they differ."""
    engine()
    if wish.picture is not None and not wish.picture.absolute().parent.is_dir():
        raise SimulationError(f"{wish.picture}: there is no such folder; choose another place")
    terrains = [Terrain.of_stack(folder) for folder in wish.stacks]
    route = _route(wish, terrains[0])
    with reporter.progress() as progress:
        drives = _drives(wish, terrains, route, part(progress, 0, 0.8))
        cloud = _cloud(wish, terrains[0], route, part(progress, 0.8, 0.95))
        picture = _picture(wish, terrains[0], drives, reporter)
    if wish.viewer:
        _show(drives[0].world)
    _report(route, drives, cloud, picture, terrains[0], reporter)


def _route(wish: Wish, terrain: Terrain) -> Route:
    commands = parse_commands(wish.commands) if wish.commands is not None else None
    if wish.start is not None and commands is not None:
        return Route(parse_start(wish.start, terrain), commands)
    if wish.start is not None:
        raise ParameterError("--start says where, but not what to do; give --commands, too")
    way = longest_way(terrain)
    return way if commands is None else Route(way.start, commands)


def _drives(wish: Wish, terrains: Sequence[Terrain], route: Route, progress: Progress) -> list[Drive]:
    """Drive on the truth first, if it is known: the others are compared with the first."""
    made = []
    if wish.truth is not None:
        made.append(worlds.of_mesh(TRUTH, meshes.true_mesh(wish.truth, terrains[0]), route.start))
    for folder, name, terrain in zip(wish.stacks, _names(wish.stacks), terrains, strict=True):
        if terrain.local_origin != terrains[0].local_origin:
            raise SimulationError(f"{folder}: lies elsewhere than {wish.stacks[0]}; give stacks of one scan")
        made.append(worlds.of_stack(name, terrain, route.start))
    share = 1 / len(made)
    return [
        Drive(world, drive(world, route, part(progress, i * share, (i + 1) * share)))
        for i, world in enumerate(made)
    ]


def _names(folders: Sequence[Path]) -> list[str]:
    """Call stacks by their folders, with what is above these where that is the same."""
    names = [folder.resolve().name for folder in folders]
    plain = len({*names, TRUTH, CLOUD}) == len(names) + 2
    return names if plain else [f"{number} {folder}" for number, folder in enumerate(folders, 1)]


def _cloud(wish: Wish, terrain: Terrain, route: Route, progress: Progress) -> Drive | None:
    """Load the mesh of all points and drive on it for so long that its costs are known."""
    if not wish.scan:
        return None
    stack = Stack.open(wish.stacks[0])
    scan = open_scan(wish.scan, stack.manifest.parameters, part(progress, 0, 0.5))
    world = worlds.of_mesh(CLOUD, meshes.cloud_mesh(scan, stack, terrain), route.start)
    return Drive(world, drive(world, route, part(progress, 0.5, 1), TRIAL))


def _picture(wish: Wish, terrain: Terrain, drives: Sequence[Drive], reporter: Reporter) -> str | None:
    """Save the strip, or else the plan; return which."""
    if wish.picture is None:
        return None
    pairs = [(each.world, each.track) for each in drives]
    shown = pictures.strip(pairs)
    if shown is None:
        reporter.warn("MuJoCo cannot draw here, for want of EGL or what MUJOCO_GL names: paths instead")
    write_atomically(wish.picture, shown or pictures.plan(terrain, pairs), SimulationError)
    return "plan" if shown is None else "strip"


def _show(world: World) -> None:
    """Open MuJoCo's own viewer where there is a screen, and wait until it is closed."""
    try:
        viewer().launch(world.model)
    except Exception as error:  # noqa: BLE001  whatever a system without a screen makes of it
        raise SimulationError(f"MuJoCo's viewer does not open ({error}); leave out --viewer") from None


# ---- report ----------------------------------------------------------------------------------------


def _report(
    route: Route,
    drives: Sequence[Drive],
    cloud: Drive | None,
    picture: str | None,
    terrain: Terrain,
    reporter: Reporter,
) -> None:
    first, *others = drives
    gone = {each.world.name: behaviour(each.track) for each in drives}
    apart = {each.world.name: difference(each.track, first.track) for each in others}
    values: dict[str, Any] = {
        "local_origin": list(terrain.local_origin),
        "start": asdict(route.start),
        "commands": [asdict(command) for command in route.commands],
        "reference": first.world.name,
        "drives": {name: asdict(each) for name, each in gone.items()},
        "differences": {name: each.as_dict() for name, each in apart.items()},
        "costs": {each.world.name: _costs(each) for each in (*drives, *([cloud] if cloud else []))},
        "picture": picture,
    }
    lines = [_start(route), *(_gone(name, each) for name, each in gone.items())]
    lines += [_apart(name, first.world.name, each) for name, each in apart.items()]
    lines += [_cost(name, each) for name, each in values["costs"].items()]
    reporter.result(values, "\n".join(lines))


def _costs(each: Drive) -> dict[str, Any]:
    world = each.world
    return {
        "parts": world.parts,
        "load_seconds": world.load_seconds,
        "megabytes": world.megabytes,
        "step_milliseconds": 1000 * each.track.step_seconds,
    }


def _start(route: Route) -> str:
    start = route.start
    return (
        f"from ({start.x:.2f}, {start.y:.2f}, {start.z:.2f}) m, heading {start.heading:g} degrees from east: "
        f"{counted(len(route.commands), 'command')}, {route.seconds:.1f} s"
    )


def _gone(name: str, each: Behaviour) -> str:
    stuck = (
        f"stuck {counted(each.stuck, 'time')} ({each.stuck_seconds:.1f} s)" if each.stuck else "never stuck"
    )
    end = ", fell out of the world" if each.fell else ", overturned" if each.overturned else ""
    return (
        f"{name}: {each.distance:.2f} m in {each.seconds:.1f} s, pitch up to {each.greatest_pitch:.1f}, "
        f"roll up to {each.greatest_roll:.1f} degrees, {stuck}{end}"
    )


def _apart(name: str, other: str, each: Difference) -> str:
    return (
        f"{name} against {other} over {each.seconds:.1f} s: "
        f"path {each.path_rmse:.3f} m (at most {each.path_max:.3f}), "
        f"height {each.height_rmse:.3f} m ({each.height_max:.3f}), pitch {each.pitch_rmse:.2f} degrees "
        f"({each.pitch_max:.2f}), roll {each.roll_rmse:.2f} degrees ({each.roll_max:.2f}), "
        f"stuck {each.stuck:+d} times"
    )


def _cost(name: str, costs: dict[str, Any]) -> str:
    return (
        f"cost of {name}: {costs['parts']} parts, loads in {costs['load_seconds']:.2f} s, "
        f"{costs['megabytes']:.1f} MB, {costs['step_milliseconds']:.3f} ms a step of 2 ms"
    )
