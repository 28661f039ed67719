"""The scenes of the paper's figures 3 to 6, and a table: small, exact, each with one lesson."""

from __future__ import annotations

import numpy as np

from stepfield.synth.geometry import Pose, Triple
from stepfield.synth.primitives import Cylinder, Plane, box
from stepfield.synth.scene import Scene, Surface

#: Elevations of the three overlaid planes of figure 3, metres.
ELEVATIONS = (0.0, 1.0, 2.0)

_SIDE = 10.0
_SLOPE = 0.45
_LOW = 0.7
_RUN = 8.0

# Between the planes as well as above: from outside, one gap each.
_BETWEEN: tuple[Triple, ...] = ((-2.0, -7.0, 0.5), (2.0, 7.0, 1.5), (7.5, -3.0, 3.6), (7.5, 4.0, 0.5))


def three_planes() -> Scene:
    """Figure 3: three horizontal planes over each other, the perfect case."""
    return Scene(_overlaid_planes(), scan_positions=(*_BETWEEN, (-7.5, 0.0, 3.6)))


def inclined_plane() -> Scene:
    """Figure 4: a fourth plane crosses the elevations of the two upper planes, touching neither.

    It starts beside them between the lowest and the middle elevation, passes both upper elevations
    while it is still beside them, and ends above the highest.
    """
    return _with_inclined(start=-9.0)


def crossing_plane() -> Scene:
    """Figure 5: the inclined plane also cuts through the highest of the three."""
    return _with_inclined(start=-6.0)


def cylinder() -> Scene:
    """Figure 6: a cylinder lying on a plane, one object with a surface above itself."""
    floor = Surface("floor", Plane(_SIDE, _SIDE))
    lying = Surface("cylinder", Cylinder(1.0, 6.0), Pose.at(0, 0, 1.0, pitch=90))
    around: tuple[Triple, ...] = ((-6.0, -5.0, 1.6), (6.0, -5.0, 0.7), (0.0, 6.5, 1.6), (-5.0, 0.0, 1.0))
    return Scene((floor, lying), scan_positions=around)


def table() -> Scene:
    """Section 5.3.1's "perfect simple example": the floor, and a table top above it on thin legs."""
    top, leg, thickness = 0.75, 0.05, 0.04
    height = top - thickness
    surfaces = [
        Surface("floor", Plane(4.0, 3.0)),
        Surface("table top", box(1.6, 0.9, thickness), Pose.at(0, 0, top - thickness / 2)),
    ]
    for number, (x, y) in enumerate([(-1, -1), (1, -1), (-1, 1), (1, 1)], 1):
        shape = box(leg, leg, height, without=("top", "bottom"))
        surfaces.append(Surface(f"leg {number}", shape, Pose.at(x * 0.72, y * 0.37, height / 2)))
    around: tuple[Triple, ...] = ((-2.2, -1.6, 1.5), (2.2, -1.2, 0.4), (0.3, 2.0, 1.5))
    return Scene(tuple(surfaces), scan_positions=around)


def _overlaid_planes() -> tuple[Surface, ...]:
    names = ("lowest plane", "middle plane", "highest plane")
    return tuple(
        Surface(name, Plane(_SIDE, _SIDE), Pose.at(0, 0, z))
        for name, z in zip(names, ELEVATIONS, strict=True)
    )


def _with_inclined(start: float) -> Scene:
    """Add to the three planes a fourth that rises towards +x from ``start``, both in metres."""
    pose = Pose.at(
        start + _RUN / 2, 0.0, _LOW + _SLOPE * _RUN / 2, pitch=-float(np.degrees(np.arctan(_SLOPE)))
    )
    inclined = Surface("inclined plane", Plane(_RUN * float(np.hypot(1, _SLOPE)), 6.0), pose)
    beside: Triple = (start - 3.0, -1.0, 2.2)
    return Scene((*_overlaid_planes(), inclined), scan_positions=(*_BETWEEN, beside, (-3.0, -6.5, 5.0)))
