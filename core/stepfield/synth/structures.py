"""Stairs, a bridge and a winding ramp: sound structures a robot can pass over and beneath."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stepfield.synth.geometry import Floats, Pose, Triple
from stepfield.synth.pieces import flight
from stepfield.synth.primitives import Cylinder, Plane, box
from stepfield.synth.scene import Scene, Surface
from stepfield.synth.sheets import Helicoid, Sheet, ruled, terrain


def stairs() -> Scene:
    """Build a dog-leg staircase through two storeys: every flight but the lowest two lies over another."""
    steps, rise, tread, width = 8, 0.17, 0.28, 1.2
    run, climb = steps * tread, steps * rise
    surfaces = [Surface("ground floor", Plane(7.0, 4.6), Pose.at(1.1, 1.3, 0))]
    for number in range(4):
        low, forth = number * climb, number % 2 == 0
        pose = Pose.at(0 if forth else run, 0.6 if forth else 2.0, low, yaw=0 if forth else 180)
        shape = flight(steps, rise, tread, width, soffit_from=1 if number == 0 else 0)
        surfaces.append(Surface(f"flight {number + 1}", shape, pose))
        x = run + 0.6 if forth else -0.6
        landing = box(1.2, 2.6, 0.16)
        surfaces.append(Surface(f"landing {number + 1}", landing, Pose.at(x, 1.3, low + climb - 0.08)))
    around: tuple[Triple, ...] = (
        (-2.0, -0.7, 1.5),
        (3.8, 3.3, 1.0),
        (1.1, 3.4, 1.6),
        (run + 0.6, 2.2, climb + 1.5),
        (-0.6, 0.5, 2 * climb + 1.5),
        (run + 0.6, 0.5, 3 * climb + 1.4),
    )
    return Scene(tuple(surfaces), 150_000, scan_positions=around)


# ---- bridge ----------------------------------------------------------------------------------------

_DECK, _CLEAR, _WIDTH = 3.4, 3.0, 5.0
_SPAN, _REACH = 6.0, 18.0


def bridge() -> Scene:
    """Build a road in a shallow cut, and a bridge over it with an embankment ramp at either end."""
    half = _WIDTH / 2
    surfaces = [
        Surface("terrain", _bridge_terrain()),
        Surface("road", terrain(np.array([-3.0, 3.0]), np.array([-12.0, 12.0]), lambda x, _: 0 * x)),
        Surface("deck", box(2 * _SPAN, _WIDTH, _DECK - _CLEAR), Pose.at(0, 0, (_DECK + _CLEAR) / 2)),
    ]
    for name, y in (("south", -half + 0.1), ("north", half - 0.1)):
        pose = Pose.at(0, y, _DECK + 0.25)
        surfaces.append(Surface(f"{name} kerb", box(2 * _SPAN, 0.2, 0.5, without=("bottom",)), pose))
    for name, side in (("west", -1.0), ("east", 1.0)):
        surfaces += _approach(name, side)
        pier = Cylinder(0.35, _CLEAR)
        for y in (-1.5, 1.5):
            surfaces.append(Surface(f"{name} pier", pier, Pose.at(side * 3.7, y, _CLEAR / 2)))
    around: tuple[Triple, ...] = ((0.0, -9.0, 1.7), (1.0, 9.0, 1.7), (-14.0, -8.0, 2.6), (14.0, 8.0, 2.6))
    return Scene(tuple(surfaces), 200_000, scan_positions=(*around, (-8.0, 0.6, 4.9), (9.0, -0.6, 4.7)))


def _bridge_ground(x: Floats, y: Floats) -> Floats:
    """Elevation beside the road: a gentle bank, then rolling, but even where the ramps end."""
    bank = np.clip((np.abs(x) - 3) / 5, 0, 1)
    away = np.clip((np.abs(y) - _WIDTH / 2) / 2, 0, 1)
    rolling = 0.12 * np.sin(0.7 * x + 1) * np.cos(0.5 * y) + 0.05 * np.sin(1.9 * x - 1.3 * y)
    ground: Floats = bank * bank * (3 - 2 * bank) * (0.7 + away * rolling)
    return ground


def _bridge_terrain() -> Sheet:
    def built_on(x: Floats, y: Floats) -> NDArray[np.bool_]:
        ramp = (np.abs(x) > _SPAN) & (np.abs(x) < _REACH) & (np.abs(y) < _WIDTH / 2)
        beside_road: NDArray[np.bool_] = ramp | (np.abs(x) < 3)
        return beside_road

    return terrain(np.arange(-21, 21.25, 0.25), np.arange(-12, 12.25, 0.25), _bridge_ground, built_on)


def _approach(name: str, side: float) -> list[Surface]:
    """Build the ramp, its two retaining walls and the abutment under the deck's end."""
    half = _WIDTH / 2
    x = np.linspace(_SPAN, _REACH, 49) * side
    surfaces, edges = [], []
    for wall, y in (("south", -half), ("north", half)):
        ground = np.column_stack([x, np.full_like(x, y), _bridge_ground(x, np.full_like(x, y))])
        top = ground.copy()
        top[:, 2] = np.linspace(_DECK, ground[-1, 2], len(x))
        edges.append(top)
        surfaces.append(Surface(f"{name} {wall} wall", ruled(ground, top)))
    foot = np.array([[side * _SPAN, y, _bridge_ground(x[:1], np.array([y]))[0]] for y in (-half, half)])
    head = foot * [1, 1, 0] + [0, 0, _CLEAR]
    abutment = Surface(f"{name} abutment", ruled(foot, head))
    return [Surface(f"{name} ramp", ruled(*edges)), *surfaces, abutment]


# ---- ramp ------------------------------------------------------------------------------------------

_INNER, _OUTER, _RISE, _TURNS = 4.0, 8.5, 3.0, 2.5
#: Share of the first turn that is a solid wedge on the ground: too low to look under.
_WEDGE = 0.3


def ramp() -> Scene:
    """Build a parking ramp: one continuous surface that winds two and a half times over itself."""
    top, middle = _RISE * _TURNS, (_INNER + _OUTER) / 2
    surfaces = [
        Surface(
            "ground", terrain(np.arange(-12, 12.2, 0.2), np.arange(-13, 12.2, 0.2), _level, _under_wedge)
        ),
        Surface("ramp", Helicoid(_INNER, _OUTER, _RISE, _TURNS)),
        Surface("exit deck", Plane(_OUTER - _INNER, 8.0), Pose.at(-middle, -4.0, top)),
        Surface("wedge inside", _wedge_wall(_INNER)),
        Surface("wedge outside", _wedge_wall(_OUTER)),
        Surface("wedge end", _wedge_end()),
    ]
    for number in range(10):
        angle = 2 * np.pi * (number + 0.5) / 10
        x, y = (_OUTER + 0.4) * np.cos(angle), (_OUTER + 0.4) * np.sin(angle)
        # Columns stand beside the ramp, but two of them under the exit deck.
        height = top if x < -_INNER and -8 < y < 0 else top + 0.5
        surfaces.append(Surface(f"column {number + 1}", Cylinder(0.25, height), Pose.at(x, y, height / 2)))
    return Scene(tuple(surfaces), 200_000, scan_positions=_ramp_scan_positions())


def _ramp_scan_positions() -> tuple[Triple, ...]:
    """Every half turn on the ramp, in the eye of the helix, and two outside."""
    middle = (_INNER + _OUTER) / 2
    turns = np.arange(0.25, _TURNS, 0.5)
    on_ramp = [
        (middle * float(np.cos(2 * np.pi * t)), middle * float(np.sin(2 * np.pi * t)), _RISE * float(t) + 1.6)
        for t in turns
    ]
    return (*on_ramp, (0.0, 0.0, 1.7), (0.0, 0.0, 5.5), (10.5, -10.0, 1.7), (-10.5, 10.5, 3.0))


def _level(x: Floats, _: Floats) -> Floats:
    return np.zeros_like(x)


def _under_wedge(x: Floats, y: Floats) -> NDArray[np.bool_]:
    radius, turn = np.hypot(x, y), np.arctan2(y, x) / (2 * np.pi)
    under: NDArray[np.bool_] = (
        (radius > _INNER + 0.15) & (radius < _OUTER - 0.15) & (turn > 0) & (turn < _WEDGE)
    )
    return under


def _wedge_wall(radius: float) -> Sheet:
    turn = np.linspace(0, _WEDGE, 55)
    foot = np.column_stack([radius * np.cos(2 * np.pi * turn), radius * np.sin(2 * np.pi * turn), 0 * turn])
    return ruled(foot, foot + np.column_stack([0 * turn, 0 * turn, _RISE * turn]))


def _wedge_end() -> Sheet:
    angle = 2 * np.pi * _WEDGE
    foot = np.outer([_INNER, _OUTER], [np.cos(angle), np.sin(angle), 0.0])
    return ruled(foot, foot + np.array([0.0, 0.0, _RISE * _WEDGE]))
