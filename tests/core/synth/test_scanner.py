"""The virtual scanner sees what a scanner would see, and spoils it as a scanner would."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stepfield.errors import SceneError
from stepfield.synth import SCENES, SyntheticScan, synthesise
from stepfield.synth.geometry import Floats

try:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import open3d as o3d
except (ImportError, OSError) as error:
    pytest.skip(
        f"the virtual scanner needs Open3D, which cannot be imported here: {error}", allow_module_level=True
    )


def scanned(folder: Path, *objects: dict[str, Any], points: int = 20_000, **more: Any) -> SyntheticScan:
    path = folder / "scene.json"
    path.write_text(json.dumps({"objects": objects, **more}), encoding="utf-8")
    return synthesise(path, points=points, noise=0.0, scanner=True)


def own(scan: SyntheticScan) -> Floats:
    """Points that lie on a surface, not the stray ones."""
    return np.asarray(scan.points[scan.surface >= 0])


@pytest.mark.parametrize("name", SCENES)
def test_a_scan_comes_close_to_the_number_asked_for(name: str) -> None:
    scan = synthesise(name, points=30_000, scanner=True)
    assert len(scan) == pytest.approx(30_000, rel=0.05)
    assert len(scan) == len(scan.surface) == len(scan.seen_from)
    assert set(scan.seen_from.tolist()) == set(range(len(scan.scan_positions)))
    assert np.isfinite(scan.points).all()
    assert 0 < np.mean(scan.surface < 0) < 0.08


def test_the_same_seed_gives_the_same_scan() -> None:
    first, again, other = (synthesise("table", points=5000, seed=seed, scanner=True) for seed in (3, 3, 4))
    assert np.array_equal(first.points, again.points)
    assert np.array_equal(first.surface, again.surface)
    assert not np.array_equal(first.points[:100], other.points[:100])


@pytest.mark.parametrize("name", ["table", "stairs", "crossing-plane"])
def test_nothing_is_seen_through_an_occluder(name: str) -> None:
    """Tried against every triangle without Open3D: nothing lies between a point and its scan position."""
    scan = synthesise(name, points=20_000, noise=0.0, scanner=True)
    chosen = np.random.default_rng(0).choice(np.flatnonzero(scan.surface >= 0), 400, replace=False)
    eyes = scan.scan_positions[scan.seen_from[chosen]]
    corners = scan.true_mesh.vertices[scan.true_mesh.triangles]
    for eye, point in zip(eyes, scan.points[chosen], strict=True):
        length = float(np.linalg.norm(point - eye))
        assert first_hit(eye, (point - eye) / length, corners) > length - 1e-3


def first_hit(eye: Floats, direction: Floats, corners: Floats) -> float:
    """Range of the nearest triangle along a ray, by Cramer's rule."""
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(direction, ac)
    volume = (ab * across).sum(axis=1)
    solid = np.abs(volume) > 1e-12
    a, ab, ac, across, volume = a[solid], ab[solid], ac[solid], across[solid], volume[solid]
    u = ((eye - a) * across).sum(axis=1) / volume
    turned = np.cross(eye - a, ab)
    v = (turned @ direction) / volume
    ranges = (turned * ac).sum(axis=1) / volume
    hit = (u > 1e-6) & (v > 1e-6) & (u + v < 1 - 1e-6) & (ranges > 1e-6)
    return float(ranges[hit].min(initial=np.inf))


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("scanner", [False, True])
def test_points_lie_on_the_true_mesh(name: str, scanner: bool) -> None:
    """Within what the triangles of the curved surfaces leave."""
    scan = synthesise(name, points=20_000, noise=0.0, scanner=scanner)
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor.from_numpy(scan.true_mesh.vertices.astype(np.float32)),
        o3d.core.Tensor.from_numpy(scan.true_mesh.triangles.astype(np.uint32)),
    )
    distances = scene.compute_distance(o3d.core.Tensor.from_numpy(own(scan).astype(np.float32))).numpy()
    assert distances.max() < 0.002


def test_what_lies_behind_is_in_shadow(tmp_path: Path) -> None:
    scan = scanned(
        tmp_path,
        {"kind": "plane", "name": "floor", "size": [12, 12]},
        {"kind": "box", "name": "box", "size": [1, 4, 3], "position": [2, 0, 1.5]},
        scan_positions=[[-4, 0, 1.5]],
    )
    x, y, _ = own(scan).T
    assert not np.any((x > 2.6) & (np.abs(y) < 1.5))
    assert np.any((x > 2.6) & (np.abs(y) > 4))


def test_density_falls_with_distance(tmp_path: Path) -> None:
    scan = scanned(
        tmp_path, {"kind": "plane", "size": [40, 40]}, points=100_000, scan_positions=[[0, 0, 2.0]]
    )
    away = np.hypot(*own(scan)[:, :2].T)
    rings = np.array([2.0, 4.0, 8.0, 16.0])
    counts, _ = np.histogram(away, rings)
    density = counts / np.diff(np.pi * rings**2)
    # On the ground the angles alone thin it out with the cube of the distance.
    assert np.all(density[:-1] / density[1:] > 4)


def test_range_noise_grows_with_range(tmp_path: Path) -> None:
    path = tmp_path / "scene.json"
    walls = [
        {"kind": "plane", "size": [4, 4], "position": [x, 0, 0], "rotation": [0, 90, 0]} for x in (2.0, -40.0)
    ]
    path.write_text(json.dumps({"objects": walls, "scan_positions": [[0, 0, 0]]}), encoding="utf-8")
    scan = synthesise(path, points=60_000, noise=0.01, scanner=True)
    near, far = (scan.points[scan.surface == number][:, 0] for number in (0, 1))
    assert (far + 40.0).std() > 2.5 * 0.01
    assert 0.008 < near[np.abs(near - 2) < 0.1].std() < 0.012


def test_grazing_rays_come_back_less_often(tmp_path: Path) -> None:
    """Per angle, not per area: the share of rays that return at 2 degrees is below that at 30."""
    scan = scanned(
        tmp_path, {"kind": "plane", "size": [400, 400]}, points=200_000, scan_positions=[[0, 0, 2.0]]
    )
    points = own(scan)
    below = np.degrees(np.arctan2(2.0, np.hypot(points[:, 0], points[:, 1])))
    grazing, steep = (np.count_nonzero(np.abs(below - angle) < 0.5) for angle in (2.0, 30.0))
    assert 0.3 < grazing / steep < 0.8


def test_edges_leave_comet_tails(tmp_path: Path) -> None:
    """Stray points lie between the post and the wall behind it, on the lines of sight past its edges."""
    scan = scanned(
        tmp_path,
        {"kind": "plane", "name": "wall", "size": [6, 6], "position": [5, 0, 0], "rotation": [0, -90, 0]},
        {"kind": "box", "name": "post", "size": [0.2, 1, 6], "position": [3.5, 0, 0]},
        points=40_000,
        scan_positions=[[0, 0, 0]],
    )
    x, y, _ = scan.points[scan.surface < 0].T
    tail = (x > 3.7) & (x < 4.9)
    assert tail.sum() > 20
    sideways = np.abs(y[tail] / x[tail])
    assert np.mean(np.abs(sideways - 0.5 / 3.4) < 0.02) > 0.8


def test_a_slanted_surface_has_no_edges(tmp_path: Path) -> None:
    scan = scanned(tmp_path, {"kind": "plane", "size": [60, 60]}, scan_positions=[[0, 0, 1.5]])
    assert np.mean(scan.surface < 0) < 0.003


def test_a_scene_without_scan_positions_is_seen_from_around(tmp_path: Path) -> None:
    scan = scanned(tmp_path, {"kind": "sphere", "radius": 1.0, "position": [500_000, 5_000_000, 300]})
    assert len(scan.scan_positions) == 5
    off = np.linalg.norm(own(scan) - [500_000, 5_000_000, 300], axis=1) - 1
    assert np.abs(off).max() < 2e-3


def test_nothing_in_sight(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="no ray from any scan position hits"):
        scanned(tmp_path, {"kind": "plane", "size": [1, 1]}, scan_positions=[[0, 0, -500]])
