"""Complex parts: where height-maps fail is meshed, the rest is left alone, and nothing is lost on the way."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from stepfield.complex_parts import ComplexParts, build, build_complex_parts, without
from stepfield.complex_parts.detection import detect, dilated, touching
from stepfield.complex_parts.fitting import fitted
from stepfield.complex_parts.job import Job
from stepfield.complex_parts.pivoting import pivoted
from stepfield.complex_parts.points import owned_points
from stepfield.complex_parts.process import mesh_apart
from stepfield.complex_parts.reducing import distances, reduced
from stepfield.complex_parts.residuals import residuals
from stepfield.complex_parts.thinning import Thinning
from stepfield.errors import Cancelled, StackError, StepfieldError
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.progress import silent
from stepfield.reconstruction import Reconstruction
from stepfield.scan.write import write
from stepfield.stack import Stack, write_stack
from stepfield.stack.check import check_stack
from stepfield.surface import Mesh

Floats = NDArray[np.float64]
RNG = np.random.default_rng


def ground(points: int = 30_000, side: float = 6.0, slope: float = 0.2) -> Floats:
    """Draw an inclined plane."""
    plan = RNG(1).random((points, 2)) * side
    return np.column_stack([plan, slope * plan[:, 0]])


def wall(points: int = 6_000, at: float = 3.05, height: float = 2.0) -> Floats:
    """Draw a wall across the plane of :func:`ground`, from it upwards."""
    drawn = RNG(2).random((points, 2)) * [4.0, height]
    return np.column_stack([np.full(points, at), 1 + drawn[:, 0], 0.2 * at + drawn[:, 1]])


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write a wall on an inclined plane."""
    path = tmp_path_factory.mktemp("scan") / "wall.ply"
    write(path, np.concatenate([ground(), wall()]), {})
    return path


@pytest.fixture(scope="module")
def result(scan: Path) -> Reconstruction:
    wanted = Parameters(cell_size=0.2, layer_tolerance=0.5, complex_parts="mesh")
    return Pipeline().run([scan], wanted)


@pytest.fixture(scope="module")
def parts(result: Reconstruction) -> ComplexParts:
    return build_complex_parts(result)


def columns(result: Reconstruction, chosen: NDArray[np.bool_]) -> set[int]:
    """Columns of the grid that the chosen pillars stand in."""
    _, column = result.field.compartments.grid.row_column(result.field.compartment[chosen])
    return {int(each) for each in column}


# ---- where --------------------------------------------------------------------------------------------


def test_every_point_finds_its_own_pillar(result: Reconstruction) -> None:
    """A point counted for another pillar would make that one look complex."""
    counts = np.zeros(len(result.field), np.int64)
    for owned in owned_points(result.scan, result.field, silent):
        counts += np.bincount(owned.pillar, minlength=len(counts))
    assert np.array_equal(counts, result.field.points)


def test_an_inclined_plane_is_not_complex(tmp_path: Path) -> None:
    """The surface follows slopes, so that steep but smooth ground stays a height-map."""
    write(tmp_path / "plane.ply", ground(slope=0.8), {})
    result = Pipeline().run([tmp_path / "plane.ply"], Parameters(cell_size=0.2, layer_tolerance=0.5))
    found = residuals(result)
    inside = np.nanquantile(found, 0.9)  # at the edges of the plane compartments are cut
    assert inside < 0.02
    assert not detect(result, found).any()


def test_a_wall_is_complex_and_the_ground_beside_it_is_not(result: Reconstruction) -> None:
    found = detect(result, residuals(result))
    assert columns(result, found) == {15}
    assert 15 <= np.count_nonzero(found) <= 22  # four metres of wall, a fifth of a metre each


def test_specks_do_not_scatter(result: Reconstruction) -> None:
    """A compartment alone is measured badly, not shaped badly: a mesh of it would be a crumb."""
    far = np.zeros(len(result.field))
    far[100] = 1.0
    assert not detect(result, far).any()


def test_a_post_that_stands_alone_is_complex(result: Reconstruction) -> None:
    """A height-map is level at half the height of a post: its points are as far from that as it is high."""
    wall = np.flatnonzero(detect(result, residuals(result)))
    far = np.zeros(len(result.field))
    far[wall[0]] = 1.0
    assert np.flatnonzero(detect(result, far)).tolist() == [wall[0]]


def test_a_post_across_two_compartments_is_complex(result: Reconstruction) -> None:
    """Else half of all thin posts and of sparse walls would be left to level squares."""
    pair = neighbours_in_the_wall(result)[:2]
    far = np.zeros(len(result.field))
    far[pair] = 1.0
    assert np.flatnonzero(detect(result, far)).tolist() == sorted(pair)


def test_the_end_of_a_wall_is_left_to_the_overlap(result: Reconstruction) -> None:
    """The mesh of the wall reaches over it anyway; with an overlap of its own it would reach beyond."""
    row = neighbours_in_the_wall(result)[:4]
    far = np.zeros(len(result.field))
    far[row] = 1.0
    found = detect(result, far)
    assert np.flatnonzero(found).tolist() == sorted(row[1:3])
    assert dilated(result, found)[row].all()


def neighbours_in_the_wall(result: Reconstruction) -> list[int]:
    """Pillars of the wall, one beside the other."""
    wall = np.flatnonzero(detect(result, residuals(result)))
    row, _ = result.field.compartments.grid.row_column(result.field.compartment[wall])
    found = wall[np.argsort(row, kind="stable")]
    assert (np.diff(np.sort(row)[:4]) == 1).all()
    return [int(each) for each in found]


def test_touching_pillars_are_side_by_side_and_at_one_height(result: Reconstruction) -> None:
    field, grid = result.field, result.field.compartments.grid
    chosen = np.flatnonzero(detect(result, residuals(result)))
    one, other = touching(result, chosen).T
    assert len(one)
    (r, c), (s, d) = (grid.row_column(field.compartment[pillars]) for pillars in (one, other))
    assert (np.maximum(np.abs(r - s), np.abs(c - d)) == 1).all()
    assert (
        np.maximum(field.low[one], field.low[other]) - np.minimum(field.high[one], field.high[other]) <= 0.5
    ).all()


def test_the_overlap_is_one_compartment(result: Reconstruction) -> None:
    """Less and a crack would open between mesh and height-map; more and the mesh would grow for nothing."""
    found = detect(result, residuals(result))
    assert columns(result, dilated(result, found)) == {14, 15, 16}


# ---- thinning -----------------------------------------------------------------------------------------


def test_thinning_knows_no_order_and_no_chunks() -> None:
    """Else the mesh would depend on how a scan is stored."""
    points = RNG(3).random((5_000, 3)) * 10
    whole, parted = Thinning(0.25), Thinning(0.25)
    whole.add(points)
    for part in np.array_split(points[RNG(4).permutation(len(points))], 7):
        parted.add(part)
    assert np.array_equal(whole.means(), parted.means())
    assert np.linalg.norm(whole.means().mean(axis=0) - 5) < 0.2
    assert len(np.unique(whole.means() // 0.25, axis=0)) == len(whole.means())


def test_thinning_nothing_gives_nothing() -> None:
    assert Thinning(0.25).means().shape == (0, 3)


def test_a_huge_scan_is_meshed_from_fewer_points(
    result: Reconstruction, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else ten million points would take ten minutes and gigabytes."""
    found = detect(result, residuals(result))
    usual = build._gathered(result, found, silent).job
    monkeypatch.setattr(build, "MOST_POINTS", len(usual.points) // 3)
    fewer = build._gathered(result, found, silent).job
    assert len(fewer.points) <= len(usual.points) // 3
    assert fewer.spacing in {2 * usual.spacing, 4 * usual.spacing}
    assert np.array_equal(fewer.samples, usual.samples)


# ---- the mesh -----------------------------------------------------------------------------------------


def test_the_mesh_stands_in_for_the_wall(result: Reconstruction, parts: ComplexParts) -> None:
    assert columns(result, parts.replaced) == {15}
    assert parts.count >= 15
    x, y, z = parts.mesh.vertices.T
    assert 2.6 < x.min() < x.max() < 3.6  # with its overlap
    assert z.max() > 2.4
    assert 0.9 < y.min() < y.max() < 5.1 + 0.2
    assert set(np.unique(parts.mesh.triangles)) == set(range(len(x)))  # no vertex without a triangle


def test_the_same_scan_gives_the_same_mesh(result: Reconstruction, parts: ComplexParts) -> None:
    again = build_complex_parts(result)
    assert np.array_equal(again.mesh.vertices, parts.mesh.vertices)
    assert np.array_equal(again.mesh.triangles, parts.mesh.triangles)
    assert np.array_equal(again.replaced, parts.replaced)


def test_the_height_maps_have_holes_there_and_nowhere_else(
    result: Reconstruction, parts: ComplexParts
) -> None:
    before, after = (
        sum(len(layer.pillars) for layer in each.layers) for each in (result, without(result, parts))
    )
    assert before - after == parts.count


def test_without_complex_parts_nothing_is_meshed(tmp_path: Path) -> None:
    write(tmp_path / "plane.ply", ground(), {})
    result = Pipeline().run([tmp_path / "plane.ply"], Parameters(cell_size=0.2, layer_tolerance=0.5))
    parts = build_complex_parts(result)
    assert parts.count == 0
    assert not len(parts.mesh.triangles)


def test_sparse_parts_are_meshed_beside_dense_ones() -> None:
    """A wall far from the scanner has few points; that something near it has many is no reason to lose it."""
    x, y = (each.ravel() for each in np.meshgrid(np.arange(30.0), np.arange(30.0)))
    wavy = 0.1 * np.sin(x) + 0.1 * np.cos(2 * y)
    dense = np.column_stack([x, y, wavy]) * 0.1
    sparse = np.column_stack([2 * x, 60 + wavy, 2 * y]) * 0.1
    points = np.concatenate([dense, sparse])
    triangles = pivoted(points, 0.1)
    reached = np.zeros(len(points), bool)
    reached[triangles] = True
    assert reached[: len(dense)].mean() > 0.95
    assert reached[len(dense) :].mean() > 0.95
    is_sparse = triangles >= len(dense)
    assert (is_sparse.all(axis=1) == is_sparse.any(axis=1)).all()  # nothing spans the gap between them


def test_a_gap_between_dense_parts_stays_open() -> None:
    """A robot would drive over a pit that a wide ball closed, though everything around it was seen."""
    x, y = (each.ravel() for each in np.meshgrid(np.arange(40.0), np.arange(30.0)))
    x[x >= 20] += 5
    points = np.column_stack([x, y, 0.1 * np.sin(x) + 0.1 * np.cos(2 * y)]) * 0.1
    side = points[pivoted(points, 0.1)][:, :, 0] > 2.2
    assert side.any()
    assert (side.all(axis=1) == side.any(axis=1)).all()


def test_a_stopped_build_ends_its_process(result: Reconstruction) -> None:
    """Else a cancelled export would go on using a processor."""

    def stop(share: float, what: str) -> None:
        if what.startswith("meshing"):  # its process runs by then
            raise Cancelled

    with pytest.raises(Cancelled):
        build_complex_parts(result, stop)


def test_a_process_that_fails_is_one_sentence() -> None:
    broken = Job(0.1, np.zeros((10, 2)), np.zeros((0, 3)))
    with pytest.raises(StepfieldError, match=r"the complex parts cannot be meshed: .*Error"):
        mesh_apart(broken)


def test_nothing_here_loads_open3d_by_itself() -> None:
    """It takes seconds and a hundred megabytes, and holds the interpreter: the window would stand still."""
    probe = "import stepfield.complex_parts, stepfield.stack, sys; print('open3d' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def bowl(side: int) -> tuple[Floats, NDArray[np.int64]]:
    """Draw a bowl, its places so many a side, and triangles between them."""
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side)))
    corner = np.arange(side * side, dtype=np.int64).reshape(side, side)[:-1, :-1].ravel()
    square = np.column_stack([corner, corner + 1, corner + side + 1, corner + side])
    places: Floats = np.column_stack([x, y, 0.4 * (x**2 + y**2)])
    return places, square[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def test_a_reduced_mesh_is_drawn_to_the_points() -> None:
    """Corners on the points are not enough: what is between them cuts every bend short."""
    (points, _), (corners, triangles) = bowl(41), bowl(5)
    before = Mesh(corners, triangles)
    after = fitted(before, points, 0.05)
    rough, near = (np.sqrt(np.mean(np.square(distances(points, each)))) for each in (before, after))
    assert near < rough / 2
    assert np.array_equal(after.triangles, before.triangles)
    assert np.abs(after.vertices - before.vertices).max() < 0.1


def test_what_is_rough_keeps_its_triangles_and_what_is_flat_does_not() -> None:
    """A share that is the same everywhere wastes triangles on walls and takes from rubble what shapes it."""
    places, triangles = bowl(41)
    flat = places * [1.0, 1.0, 0.0]
    rough = flat + RNG(5).normal(0, 0.05, flat.shape) * [0.0, 0.0, 1.0]  # as wide as the points are apart
    plain, shaped = (reduced(Mesh(each, triangles), 0.05) for each in (flat, rough))
    assert len(plain.triangles) < len(triangles) / 20
    assert len(shaped.triangles) > len(triangles) / 5


@pytest.mark.parametrize("unit", [0.001, 1000.0])
def test_reducing_knows_no_unit(unit: float) -> None:
    """The same scene in millimetres is the same shape; Open3D by itself leaves out other triangles of it."""
    places, triangles = bowl(41)
    places += RNG(6).normal(0, 0.02, places.shape)
    usual, scaled = (
        reduced(Mesh(places, triangles), 0.05),
        reduced(Mesh(places * unit, triangles), 0.05 * unit),
    )
    assert len(scaled.triangles) == pytest.approx(len(usual.triangles), rel=0.01)


def test_points_far_from_a_mesh_do_not_draw_it() -> None:
    """They belong to something that no triangle was found for; a surface half way to it is nowhere."""
    corners, triangles = bowl(5)
    above = np.array([[0.0, 0.0, 2.0], [0.1, 0.1, 1.0]])
    assert np.array_equal(fitted(Mesh(corners, triangles), above, 0.05).vertices, corners)
    nothing = Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64))
    assert not len(fitted(nothing, above, 0.05).triangles)


# ---- the stack ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def stack(result: Reconstruction, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("stacks") / "stack"
    write_stack(result, folder)
    return folder


def test_a_stack_holds_the_mesh_and_says_so(stack: Path, result: Reconstruction, parts: ComplexParts) -> None:
    opened = Stack.open(stack)
    entry = opened.manifest.complex
    assert entry is not None
    assert entry.pillars == parts.count
    assert sum(layer.pillars for layer in opened.manifest.layers) == len(result.field) - parts.count
    mesh = opened.complex_mesh()
    assert mesh is not None
    assert np.array_equal(mesh.vertices, parts.mesh.vertices)
    assert np.array_equal(mesh.triangles, parts.mesh.triangles)


def test_a_stack_with_a_mesh_is_whole_and_true(stack: Path, scan: Path) -> None:
    report = check_stack(stack, [scan])
    assert report.faults == ()


def test_a_stack_with_a_mesh_is_the_same_bytes_every_time(
    stack: Path, result: Reconstruction, tmp_path: Path
) -> None:
    write_stack(result, tmp_path / "again")
    assert {path.name: path.read_bytes() for path in stack.iterdir()} == {
        path.name: path.read_bytes() for path in (tmp_path / "again").iterdir()
    }


@pytest.mark.parametrize("damage", ["missing", "short", "broken"])
def test_a_damaged_mesh_is_found(stack: Path, tmp_path: Path, damage: str) -> None:
    for path in stack.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    mesh = tmp_path / "complex.ply"
    content = mesh.read_bytes()
    if damage == "missing":
        mesh.unlink()
    elif damage == "short":
        mesh.write_bytes(content[:-5])
    else:
        mesh.write_bytes(content[:-4] + b"\xff\xff\xff\x7f")
    assert any("complex.ply" in fault for fault in check_stack(tmp_path).faults)
    with pytest.raises(StackError, match=r"complex\.ply"):
        Stack.open(tmp_path).complex_mesh()


def test_off_writes_no_mesh_and_older_manifests_have_none(result: Reconstruction, tmp_path: Path) -> None:
    off = result.parameters.model_copy(update={"complex_parts": "off"})
    write_stack(replace(result, parameters=off), tmp_path / "stack")
    assert not (tmp_path / "stack" / "complex.ply").exists()
    manifest = tmp_path / "stack" / "manifest.json"
    values = json.loads(manifest.read_text())
    assert values.pop("complex") is None
    for name in ("complex_parts", "complex_residual"):
        del values["parameters"][name]
    manifest.write_text(json.dumps(values))
    assert Stack.open(tmp_path / "stack").complex_mesh() is None


def test_complex_parts_of_a_real_scan_are_nearer_to_it(real_scan: Callable[[str], Path]) -> None:
    """Else a mesh would replace what was better before."""
    path = real_scan("pye57__pumpAVisualReferenceImage.e57")
    result = Pipeline().run([path], Parameters(complex_parts="mesh", cell_size=0.06))
    parts = build_complex_parts(result)
    assert 0.02 < parts.count / len(result.field) < 0.6
    assert parts.count > 0.8 * np.count_nonzero(parts.found)
