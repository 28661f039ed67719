"""A collapsed three-storey building, as a rescue team would find it.

The west bay still stands with its broken floors, stairwell and facade; in the middle the floors lie
pancaked on each other with gaps a robot could crawl through; in the east a floor leans against the
standing wall and another has folded into a V. Debris lies around and between. The composition is
fixed, its details are drawn from a generator, so every seed is another collapse of the same house.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepfield.synth.debris import Ground, debris
from stepfield.synth.geometry import Assembly, Pose, Shape, Triple
from stepfield.synth.pieces import beam, broken_slab, chunks, flight
from stepfield.synth.primitives import Cylinder, box
from stepfield.synth.scene import Scene, Surface
from stepfield.synth.sheets import terrain

_THICK = 0.25
_STOREY = 3.0


@dataclass(frozen=True)
class _Slab:
    """A floor or a piece of one: middle of its top, extent (metres), attitude (degrees), broken edges."""

    name: str
    middle: Triple
    size: tuple[float, float]
    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0
    broken: str = "snwe"
    loose: float = 1.0


_SLABS = (
    # West bay, standing.
    _Slab("floor 1 west", (3.1, 9.6, 3.0), (6.6, 10.8), broken="e", loose=0),
    _Slab("floor 2 west", (2.5, 12.0, 6.0), (5.4, 6.0), broken="se", loose=0),
    _Slab("roof west", (2.0, 12.6, 8.95), (4.4, 4.8), roll=2, pitch=3, broken="se", loose=0.3),
    _Slab("floor 1 hanging", (7.35, 9.8, 2.3), (2.4, 4.6), pitch=38, broken="sne", loose=0.5),
    _Slab("floor 2 fallen", (3.6, 6.7, 3.75), (3.4, 2.6), roll=14, pitch=-6, yaw=12),
    # Middle, pancaked: three floors in two halves each.
    _Slab("pancake 1 south", (10.6, 3.7, 0.95), (7.4, 7.0), roll=2, pitch=-3, broken="nwe"),
    _Slab("pancake 1 north", (11.0, 11.4, 1.15), (7.0, 7.2), roll=-4, pitch=2, broken="swe"),
    _Slab("pancake 2 south", (10.9, 3.4, 1.95), (7.2, 6.8), roll=-2, pitch=2, yaw=3),
    _Slab("pancake 2 north", (10.8, 11.2, 2.15), (6.8, 7.0), roll=-2, pitch=-3, yaw=-4, broken="swe"),
    _Slab("roof south", (10.3, 3.9, 2.95), (7.0, 6.4), roll=3, pitch=7, yaw=-5),
    _Slab("roof north", (11.2, 12.6, 2.9), (6.4, 6.6), roll=-13, pitch=3, yaw=6),
    # East, a lean-to against the wall, one more floor slid down on it, and a V.
    _Slab("lean-to", (17.1, 10.0, 1.75), (5.9, 8.6), pitch=-27, broken="sw", loose=0.4),
    _Slab("lean-to, upper", (17.2, 10.6, 2.75), (4.6, 5.6), roll=3, pitch=-31, yaw=-5),
    _Slab("V west", (15.3, 2.6, 1.45), (3.4, 4.8), pitch=29, broken="se"),
    _Slab("V east", (18.3, 2.6, 1.7), (3.6, 4.8), pitch=-36, broken="sw", loose=0.5),
    # Thrown out.
    _Slab("slab outside south", (5.2, -1.5, 0.85), (3.2, 2.6), roll=-24, pitch=6, yaw=20),
    _Slab("slab outside east", (22.0, 11.0, 0.75), (2.6, 3.4), pitch=22, roll=4, yaw=-10),
)

#: Floors with debris on them.
_STREWN = (
    "floor 1 west",
    "pancake 1 south",
    "pancake 1 north",
    "pancake 2 south",
    "pancake 2 north",
    "roof south",
)

#: Columns as x, y, foot, head (metres) and lean (degrees).
_COLUMNS = (
    *((x, y, 0.0, 2.75, 0.0) for x in (0.25, 4.9) for y in (4.6, 9.7, 14.7)),
    *((x, y, 3.0, 5.75, 0.0) for x in (0.25, 4.9) for y in (9.7, 14.7)),
    *((0.25, y, 6.0, 8.6, 1.0) for y in (10.6, 14.7)),
    (4.7, 14.6, 6.0, 7.6, -4.0),
    (0.25, 0.3, 0.0, 2.3, 0.0),
    (5.0, 0.4, 0.0, 3.6, -9.0),
    (14.6, 5.2, 0.0, 2.1, 6.0),
    (14.4, 14.6, 0.0, 3.4, -12.0),
    (19.7, 0.3, 0.0, 5.2, 0.0),
    (19.7, 5.2, 0.0, 6.1, 2.0),
    (19.7, 10.0, 0.0, 4.4, 0.0),
    (19.7, 14.7, 0.0, 5.0, -3.0),
)


def rubble(rng: np.random.Generator) -> Scene:
    """Build the collapsed building; ``rng`` draws its details."""
    ground = Ground(rng)
    surfaces = [
        Surface("ground", terrain(np.arange(-5, 25.1, 0.2), np.arange(-6, 20.6, 0.2), ground.height)),
        *_floors(rng),
        *_columns(),
        *_facade(rng),
        *_stairs(),
        *_props(rng),
        *debris(ground, rng),
        *_fallen(rng),
    ]
    return Scene(tuple(surfaces), 400_000, noise=0.008, scan_positions=_SCAN_POSITIONS)


#: Around the site, from ladders and cranes, on and under the standing floor, and a robot in the voids.
_SCAN_POSITIONS: tuple[Triple, ...] = (
    (-3.0, -3.5, 1.7),
    (5.5, -4.7, 1.7),
    (11.0, -5.3, 1.7),
    (18.0, -4.8, 1.7),
    (23.3, -2.0, 1.7),
    (23.6, 14.5, 1.8),
    (15.0, 19.0, 1.7),
    (5.0, 18.5, 1.7),
    (-3.0, 12.5, 1.7),
    (12.5, -4.0, 8.5),
    (22.5, 18.0, 8.5),
    (6.5, 3.0, 11.5),
    (13.5, 4.5, 10.5),
    (9.0, 16.0, 10.5),
    (17.0, 12.0, 11.0),
    (2.6, 8.0, 4.7),
    (2.6, 9.0, 1.5),
    (18.4, 9.0, 0.6),
    (10.7, 7.5, 0.45),
    (11.0, 7.5, 1.45),
)


def _floors(rng: np.random.Generator) -> list[Surface]:
    floors = [_slab(slab, rng) for slab in _SLABS]
    spilt = [
        _spilt(floor, slab, rng) for floor, slab in zip(floors, _SLABS, strict=True) if slab.name in _STREWN
    ]
    return floors + spilt


def _slab(slab: _Slab, rng: np.random.Generator) -> Surface:
    roll, pitch, yaw = rng.uniform(-1.2, 1.2, 3) * slab.loose + (slab.roll, slab.pitch, slab.yaw)
    shape = broken_slab(*slab.size, _THICK, slab.broken, rng, 0.7)
    x, y, top = slab.middle
    return Surface(slab.name, shape, Pose.at(x, y, top - _THICK / 2, roll=roll, pitch=pitch, yaw=yaw))


def _columns() -> list[Surface]:
    return [
        Surface(f"column {number}", beam(head - foot, 0.4), _upright(x, y, foot, head, lean))
        for number, (x, y, foot, head, lean) in enumerate(_COLUMNS, 1)
    ]


def _upright(x: float, y: float, foot: float, head: float, lean: float) -> Pose:
    half = (head - foot) / 2
    shift = half * float(np.sin(np.radians(lean)))
    return Pose.at(x - shift, y, foot + half, pitch=-90 - lean)


def _facade(rng: np.random.Generator) -> list[Surface]:
    """Stubs of the outer walls: sills and the piers between windows, broken off at any height."""
    west = [_wall(f"west wall {floor}", 0.1, y0, 14.9, floor * _STOREY, top, rng) for floor, y0, top in _WEST]
    east = _wall("east wall", 19.9, 0.3, 14.7, 0.0, (2.6, 4.6), rng)
    return [*west, east, _north_wall(rng)]


#: Floor, southern end and height of the west facade's remains, metres.
_WEST = ((0, 0.3, (2.0, 2.75)), (1, 6.0, (1.2, 2.75)), (2, 10.8, (0.5, 2.2)))


def _wall(
    name: str,
    x: float,
    start: float,
    stop: float,
    foot: float,
    tops: tuple[float, float],
    rng: np.random.Generator,
) -> Surface:
    """Build a wall along y with a window every 2.4 m; every pier has its own broken top."""
    parts: list[tuple[Shape, Pose]] = []
    y = start
    while stop - y > 0.6:
        pier, window = 1.2, min(1.2, stop - y - 1.2)
        height = float(rng.uniform(*tops))
        parts.append(
            (broken_slab(height, pier, 0.2, "e", rng, 0.4), _standing(x, y + pier / 2, foot + height / 2))
        )
        if window > 0.2:
            sill = box(0.9, window, 0.2)
            parts.append((sill, _standing(x, y + pier + window / 2, foot + 0.45)))
        y += pier + window
    return Surface(name, Assembly(parts))


def _standing(x: float, y: float, z: float) -> Pose:
    """Stand a slab on its western edge, its own x axis up."""
    return Pose.at(x, y, z, pitch=-90)


def _north_wall(rng: np.random.Generator) -> Surface:
    piece = broken_slab(2.4, 4.0, 0.2, "en", rng, 0.8)
    turned = Pose(position=(2.3, 14.9, 1.2), matrix=Pose.at(0, 0, 0, pitch=-90, yaw=90).matrix)
    return Surface("north wall", piece, turned)


def _stairs() -> list[Surface]:
    """One whole flight in the stairwell, and the foot of the next one."""
    whole = flight(16, _STOREY / 16, 0.26, 1.3, soffit_from=1)
    rest = flight(7, _STOREY / 16, 0.26, 1.3, soffit_from=1)
    return [
        Surface("stairs", whole, Pose.at(2.0, 0.1, 0.0, yaw=90)),
        Surface("stairs, broken", rest, Pose.at(1.2, 6.2, _STOREY, yaw=90, pitch=0)),
    ]


def _props(rng: np.random.Generator) -> list[Surface]:
    """Crushed columns and lumps that keep the pancaked floors apart."""
    surfaces = []
    for level, (low, high) in enumerate([(0.0, 0.75), (0.95, 1.75), (1.95, 2.75)], 1):
        for x, y in [(8.2, 1.4), (12.6, 2.0), (8.6, 13.0), (12.8, 12.4), (10.4, 6.2)]:
            x, y = x + float(rng.uniform(-0.6, 0.6)), y + float(rng.uniform(-0.6, 0.6))
            pose = Pose.at(x, y, (low + high) / 2, pitch=90 + float(rng.uniform(-14, 14)))
            surfaces.append(Surface(f"crushed column {level}", beam(high - low + 0.1, 0.4), pose))
    return surfaces


def _spilt(floor: Surface, slab: _Slab, rng: np.random.Generator) -> Surface:
    """Lumps that came to rest on a floor, thickest where they slid together."""
    count = round(1.1 * slab.size[0] * slab.size[1])
    where = rng.normal(rng.uniform(-0.2, 0.2, 2), 0.22, (count, 2)).clip(-0.37, 0.37) * slab.size
    size = np.clip(rng.lognormal(-1.4, 0.45, count), 0.1, 0.7)
    centres = np.column_stack([where, _THICK / 2 + 0.12 * size])
    lumps = chunks(centres, size, lambda x, _: np.full_like(x, _THICK / 2), rng)
    return Surface(f"debris on {slab.name}", lumps, floor.pose)


def _fallen(rng: np.random.Generator) -> list[Surface]:
    """Beams across the heaps, a water tank off the roof, and reinforcement out of the broken edges."""
    beams = [
        (8.2, -1.3, 1.45, 4.6, 12, 25),
        (14.3, 7.6, 2.2, 5.0, -24, 70),
        (18.2, -1.6, 1.2, 3.8, 9, -35),
        (13.0, 17.0, 1.3, 4.4, -14, 160),
        (6.9, 5.2, 1.4, 4.2, -31, 115),
    ]
    surfaces = [
        Surface(f"fallen beam {number}", beam(length, 0.35), Pose.at(x, y, z, pitch=pitch, yaw=yaw))
        for number, (x, y, z, length, pitch, yaw) in enumerate(beams, 1)
    ]
    tank = Surface("water tank", Cylinder(0.75, 2.0, caps=True), Pose.at(13.6, -3.0, 0.78, roll=90, yaw=65))
    return [*surfaces, tank, _reinforcement(rng)]


def _reinforcement(rng: np.random.Generator) -> Surface:
    """Bars that stick out of the standing floors' broken edges, bent down a little."""
    edges = [(6.2, y, 2.88) for y in np.arange(4.8, 14.8, 0.35)] + [
        (5.0, y, 5.88) for y in np.arange(9.6, 14.8, 0.35)
    ]
    bars = [
        (
            Cylinder(0.012, 1.1),
            Pose.at(x, float(y), z, pitch=90 + float(rng.uniform(-6, 24)), yaw=float(rng.uniform(-20, 20))),
        )
        for x, y, z in edges
    ]
    return Surface("reinforcement", Assembly(bars))
