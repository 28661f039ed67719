"""Where the robot starts and what it is told."""

from __future__ import annotations

import math
from dataclasses import dataclass

from stepfield.errors import ParameterError
from stepfield.simulate.ground import height_near
from stepfield.simulate.robot import WHEEL_RADIUS, Place
from stepfield.targets.terrain import Terrain

#: Seconds that the robot stands after it was put down, before the first command.
SETTLING = 1.0
#: How far above the ground it is put down, metres: worlds differ by less.
DROP = 0.05
#: Seconds.
LONGEST_COMMANDS = 3600.0


@dataclass(frozen=True)
class Command:
    """Go on for ``seconds`` at ``forward`` metres and ``turn`` degrees a second, anticlockwise."""

    seconds: float
    forward: float
    turn: float


@dataclass(frozen=True)
class Route:
    """A start in the scene's local coordinates, and one command after the other."""

    start: Place
    commands: tuple[Command, ...]

    @property
    def seconds(self) -> float:
        """How long it takes, settling included."""
        return SETTLING + sum(command.seconds for command in self.commands)

    def at(self, time: float) -> Command:
        """Return the command of a moment; before and after all of them the robot stands."""
        left = time - SETTLING
        for command in self.commands if left >= 0 else ():
            if left < command.seconds:
                return command
            left -= command.seconds
        return Command(0.0, 0.0, 0.0)


def parse_commands(text: str) -> tuple[Command, ...]:
    """Read "SECONDS,M/S,DEG/S; ..."; raise ParameterError in one sentence."""
    commands = tuple(Command(*_numbers(part, 3, "commands")) for part in text.split(";") if part.strip())
    if not commands or any(command.seconds <= 0 for command in commands):
        raise ParameterError("impossible commands: give at least one, each of more than 0 seconds")
    if sum(command.seconds for command in commands) > LONGEST_COMMANDS:
        raise ParameterError(f"impossible commands: longer than {LONGEST_COMMANDS:g} s; give fewer")
    if any(abs(command.forward) > 3 or abs(command.turn) > 180 for command in commands):
        raise ParameterError("impossible commands: faster than 3 m/s or 180 degrees/s; give slower ones")
    return commands


def parse_start(text: str, terrain: Terrain) -> Place:
    """Read "X,Y,HEADING[,Z]" in scan coordinates; without Z it is the topmost layer there.

    Raises
    ------
    ParameterError
        When it is not numbers, or nothing of the stack is there to stand on.
    """
    parts = _numbers(text, 4 if text.count(",") == 3 else 3, "start")
    x, y = parts[0] - terrain.local_origin[0], parts[1] - terrain.local_origin[1]
    below = parts[3] - terrain.local_origin[2] if len(parts) == 4 else math.inf
    ground = height_near(terrain, x, y, below)
    if ground is None:
        raise ParameterError("impossible start: nothing of the stack lies there; give another")
    return Place(x, y, ground + WHEEL_RADIUS + DROP, parts[2])


def _numbers(text: str, count: int, name: str) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) != count or not all(map(math.isfinite, values)):
        raise ParameterError(f"impossible {name} {text.strip()!r}: {count} numbers are needed")
    return values
