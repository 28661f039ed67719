"""Every shape keeps its equation, covers its area evenly, and agrees with its own mesh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stepfield.synth.geometry import Floats, Mesh, Pose, Shape
from stepfield.synth.pieces import broken_slab, chunks, flight
from stepfield.synth.primitives import FACES, Cylinder, Disc, Plane, Sphere, box
from stepfield.synth.sheets import Helicoid, prism, ruled, terrain

COUNT = 40_000

Equation = Callable[[Floats], Floats]


def rng() -> np.random.Generator:
    return np.random.default_rng(7)


def rolling(x: Floats, y: Floats) -> Floats:
    height: Floats = 0.4 * np.sin(x) * np.cos(0.7 * y)
    return height


def flat(x: Floats, _: Floats) -> Floats:
    return np.zeros_like(x)


def on_box(points: Floats) -> Floats:
    half = np.array([1.0, 0.5, 0.25])
    return np.asarray(
        np.abs(np.abs(points) - half).min(axis=1) + np.clip(np.abs(points) - half, 0, None).sum(axis=1)
    )


def on_helix(points: Floats) -> Floats:
    x, y, z = points.T
    turns = z / 3.0 - np.arctan2(y, x) / (2 * np.pi)
    return np.asarray(turns - np.round(turns))


EQUATIONS: list[tuple[str, Shape, Equation]] = [
    ("plane", Plane(4, 2), lambda p: p[:, 2]),
    ("disc", Disc(2), lambda p: p[:, 2]),
    ("sphere", Sphere(1.5), lambda p: np.linalg.norm(p, axis=1) - 1.5),
    ("cylinder", Cylinder(0.7, 3), lambda p: np.hypot(p[:, 0], p[:, 1]) - 0.7),
    ("box", box(2, 1, 0.5), on_box),
    ("helicoid", Helicoid(4, 8, 3, 2.5), on_helix),
]

SHAPES: dict[str, Shape] = {
    **{name: shape for name, shape, _ in EQUATIONS},
    "closed cylinder": Cylinder(1, 0.8, caps=True),
    "pierced plane": Plane(4, 3, [(-1, -1, 0.5, 0.2), (0, 0, 3, 1)]),
    "pierced box": box(2, 2, 0.5, holes=[(-0.5, -0.6, 0.2, 0.7)]),
    "flat helicoid": Helicoid(1, 3, 0, 0.75),
    "terrain": terrain(np.linspace(-3, 3, 30), np.linspace(-2, 2, 20), rolling),
    "prism": prism(np.array([[0, 0], [2, 0], [1.5, 1], [0.2, 1.4]]), 0.3),
    "flight": flight(8, 0.17, 0.28, 1.2, soffit_from=1),
    "broken slab": broken_slab(5, 3, 0.25, "sn", np.random.default_rng(1)),
    "chunks": chunks(
        np.array([[0.0, 0, 0.1], [1, 1, 0.2]]), np.array([0.8, 1.2]), flat, np.random.default_rng(2)
    ),
}


@pytest.mark.parametrize(
    ("shape", "equation"), [case[1:] for case in EQUATIONS], ids=[case[0] for case in EQUATIONS]
)
def test_points_keep_the_equation(shape: Shape, equation: Equation) -> None:
    points, _ = shape.draw(COUNT, rng())
    assert points.shape == (COUNT, 3)
    assert np.abs(equation(points)).max() < 1e-9


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
def test_normals_are_unit_and_square_to_the_surface(shape: Shape) -> None:
    points, normals = shape.draw(COUNT, rng())
    assert np.allclose(np.linalg.norm(normals, axis=1), 1)
    # Neighbouring points of one face lie square to the normal, as nearly as the surface is flat there.
    order = np.lexsort(points.T)
    step, facing = np.diff(points[order], axis=0), normals[order][:-1]
    near = np.linalg.norm(step, axis=1) < 0.02
    near &= (facing * normals[order][1:]).sum(axis=1) > 0.999
    assert np.abs((step[near] * facing[near]).sum(axis=1)).max(initial=0) < 0.005


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
def test_mesh_has_the_area(shape: Shape) -> None:
    assert triangle_areas(shape.mesh()).sum() == pytest.approx(shape.area, rel=2e-3)


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
@settings(max_examples=25, deadline=None)
@given(towards=st.tuples(*[st.floats(-1, 1)] * 3), share=st.floats(0.1, 0.9))
def test_points_are_spread_evenly_over_the_area(
    shape: Shape, towards: tuple[float, ...], share: float
) -> None:
    """Any plane through the shape divides the points as it divides the area."""
    points, _ = shape.draw(COUNT, rng())
    pieces = subdivided(shape.mesh())
    direction = np.add(towards, (1e-3, 2e-3, 3e-3))
    along = pieces.corners().mean(axis=1) @ direction
    cut = float(np.quantile(along, share))
    areas = triangle_areas(pieces)
    expected = areas[along < cut].sum() / areas.sum()
    # What lies about the cut may fall on either side of the pieces' middles.
    width = 0.5 * float(np.abs(np.diff(pieces.corners() @ direction, axis=1)).max())
    doubtful = areas[np.abs(along - cut) <= width].sum() / areas.sum()
    found = np.mean(points @ direction < cut)
    assert abs(found - expected) < 5 * np.sqrt(0.25 / COUNT) + doubtful


def test_holes_stay_empty() -> None:
    points, _ = SHAPES["pierced plane"].draw(COUNT, rng())
    x, y, _ = points.T
    assert not np.any((x > -1) & (x < 0.5) & (y > -1) & (y < 0.2))
    assert not np.any((x > 0) & (y > 0) & (y < 1))
    assert SHAPES["pierced plane"].area == pytest.approx(4 * 3 - 1.5 * 1.2 - 2 * 1 + 0.5 * 0.2)


def test_a_shaft_of_a_box_is_open_and_walled() -> None:
    points, normals = SHAPES["pierced box"].draw(COUNT, rng())
    x, y, z = points.T
    inside = (x > -0.5 + 1e-9) & (x < 0.2 - 1e-9) & (y > -0.6 + 1e-9) & (y < 0.7 - 1e-9)
    assert not inside.any()
    west_wall = np.isclose(x, -0.5) & (np.abs(z) < 0.2) & (np.abs(y - 0.05) < 0.6)
    assert west_wall.sum() > 100
    assert np.allclose(normals[west_wall], [1, 0, 0])


@pytest.mark.parametrize("face", FACES)
def test_a_face_of_a_box_can_be_left_out(face: str) -> None:
    whole, open_box = box(2, 3, 4), box(2, 3, 4, without=[face])
    axis, sign = {"w": (0, -1), "e": (0, 1), "s": (1, -1), "n": (1, 1), "b": (2, -1), "t": (2, 1)}[face[0]]
    points, _ = open_box.draw(COUNT, rng())
    assert not np.any(np.isclose(points[:, axis], sign * [2, 3, 4][axis] / 2, atol=1e-6))
    assert open_box.area == pytest.approx(whole.area - 24 / [2, 3, 4][axis])


def test_a_ruled_sheet_may_come_to_a_point() -> None:
    foot = np.array([[0.0, 0, 0], [1, 0, 0]])
    sheet = ruled(foot, foot + np.array([[0, 0, 0], [0, 0, 1]]))
    assert sheet.area == pytest.approx(0.5)


def test_lumps_end_at_the_floor() -> None:
    points, _ = SHAPES["chunks"].draw(COUNT, rng())
    assert points[:, 2].min() >= 0


@given(st.tuples(*[st.floats(-180, 180)] * 3), st.tuples(*[st.floats(-1e4, 1e4)] * 3))
def test_a_pose_keeps_distances_and_can_be_undone(
    angles: tuple[float, ...], position: tuple[float, ...]
) -> None:
    pose = Pose.at(*position, roll=angles[0], pitch=angles[1], yaw=angles[2])
    points = rng().normal(size=(20, 3))
    placed = pose.place(points)
    assert np.allclose(
        np.linalg.norm(placed[1:] - placed[0], axis=1), np.linalg.norm(points[1:] - points[0], axis=1)
    )
    assert np.allclose(pose.unplace(placed), points, atol=1e-9)


def test_rotations_turn_the_way_they_say() -> None:
    x, y, z = np.eye(3)
    assert np.allclose(Pose.at(0, 0, 0, yaw=90).place(x[None]), y)
    assert np.allclose(Pose.at(0, 0, 0, roll=90).place(y[None]), z)
    assert np.allclose(Pose.at(0, 0, 0, pitch=90).place(x[None]), -z)
    assert np.allclose(Pose.at(0, 0, 0, roll=90, yaw=90).place(y[None]), z)


def triangle_areas(mesh: Mesh) -> Floats:
    a, b, c = mesh.corners().swapaxes(0, 1)
    return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)


def subdivided(mesh: Mesh) -> Mesh:
    corners = mesh.corners()
    while len(corners) < 4000:
        a, b, c = corners.swapaxes(0, 1)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        quarters = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        corners = np.concatenate([np.stack(quarter, axis=1) for quarter in quarters])
    return Mesh(corners.reshape(-1, 3), np.arange(corners.size // 3, dtype=np.int32).reshape(-1, 3))
