"""Every program that takes triangles gets the ground of every pillar: no side cut, no beam lost."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.core.targets.stacks import CELL, asymmetric, places_in, rays, stack_of
from tests.core.targets.test_gazebo import check_with_libsdformat
from tests.core.targets.test_mujoco import corner, dropped, looked_down, only

from stepfield.errors import ParameterError
from stepfield.targets import gazebo, mesh, mujoco, pybullet
from stepfield.targets.target import Options
from stepfield.targets.terrain import Terrain, TerrainLayer
from stepfield.targets.tiles import tiles
from stepfield.targets.writing import wishes, write_targets

Raster = NDArray[np.float64]
#: A beam two metres above the lower layer, one compartment wide, and a lone pillar.
BEAM_ROW, BEAM_TOP, LONE = 12, 5.5, (3, 30)


def layers() -> list[Raster]:
    lower, upper = asymmetric()
    beam = np.full_like(lower, np.nan)
    beam[BEAM_ROW, 4:30] = BEAM_TOP
    beam[LONE] = 7.0
    return [lower, upper, beam]


@pytest.fixture(scope="module")
def edged(tmp_path_factory: pytest.TempPathFactory) -> Terrain:
    return Terrain.of_stack(
        stack_of(tmp_path_factory.mktemp("edged") / "made", layers(), reconstruction="edges")
    )


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory, edged: Terrain) -> Path:
    """Give a folder with every target in a folder of its name."""
    folder = tmp_path_factory.mktemp("written")
    for module in (gazebo, mesh, mujoco, pybullet):
        own = folder / module.__name__.rpartition(".")[2]
        own.mkdir()
        found = module.write(edged, own, Options())
        assert sorted(found.files) == sorted(
            path.relative_to(own).as_posix() for path in own.rglob("*") if path.is_file()
        )
    return folder


def spread(terrain: Terrain, layer: TerrainLayer) -> tuple[Raster, Raster]:
    """Return places over a layer, some of them just within its rims, and the heights of its surface there."""
    around = places_in(corner(terrain), terrain.cell_size, (terrain.rows, terrain.columns))
    row, column = np.nonzero(layer.occupied)
    middles = np.column_stack(
        [terrain.west + column * terrain.cell_size, terrain.north - row * terrain.cell_size]
    )
    ends = np.concatenate([middles + np.array(d) * terrain.cell_size * 0.49 for d in ((-1, 0.1), (0.2, 1))])
    places = np.concatenate([around, ends[:: max(1, len(ends) // 500)]])
    whole = terrain.surface(layer)
    return places, rays(whole.vertices, whole.triangles, places)


def covered(layer: TerrainLayer, terrain: Terrain, places: Raster) -> NDArray[np.bool_]:
    """Tell which places lie over a pillar."""
    west, south = corner(terrain)
    column = np.floor((places[:, 0] - west) / terrain.cell_size).astype(int)
    row = terrain.rows - 1 - np.floor((places[:, 1] - south) / terrain.cell_size).astype(int)
    inside = (row >= 0) & (row < terrain.rows) & (column >= 0) & (column < terrain.columns)
    occupied: NDArray[np.bool_] = layer.occupied[np.where(inside, row, 0), np.where(inside, column, 0)]
    return occupied & inside


def bend(terrain: Terrain, layer: TerrainLayer) -> float:
    """How far the middle of a compartment is from that of its corners, at most."""
    sheet = terrain.sheets[layer.index]
    middles = [(sheet.corner[:, i] + sheet.corner[:, i + 2]) / 2 for i in (0, 1)]
    return float(max(np.abs(sheet.top - middle).max() for middle in middles))


def test_the_surface_is_over_every_pillar_and_nothing_else(edged: Terrain) -> None:
    for layer in edged.layers:
        places, wanted = spread(edged, layer)
        np.testing.assert_array_equal(np.isfinite(wanted), covered(layer, edged, places))
        assert edged.surface(layer).plan_area == pytest.approx(layer.occupied.sum() * CELL**2)


def test_real_scans_are_covered_exactly(find_stack: Callable[[str], Path]) -> None:
    terrain = Terrain.of_stack(find_stack("room_scan1"), "edges")
    for layer in terrain.layers:
        for bound in (None, 0.02):
            area = terrain.surface(layer, bound).plan_area
            assert area == pytest.approx(layer.occupied.sum() * terrain.cell_size**2, rel=1e-6)


def test_every_format_of_the_meshes_holds_it(edged: Terrain, made: Path) -> None:
    trimesh = pytest.importorskip("trimesh", reason="trimesh reads the meshes; pip install trimesh")
    for layer in edged.layers:
        for place in ("", f"{mesh.DECIMATED}/"):
            for suffix in (".obj", ".stl", ".ply"):
                found = trimesh.load_mesh(made / "mesh" / f"{place}{layer.label}{suffix}", process=False)
                up = np.asarray(found.triangles)
                a, b = up[:, 1, :2] - up[:, 0, :2], up[:, 2, :2] - up[:, 0, :2]
                area = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2
                assert area == pytest.approx(layer.occupied.sum() * CELL**2, rel=1e-4), suffix


def test_gazebo_gets_meshes_of_it(edged: Terrain, made: Path) -> None:
    trimesh = pytest.importorskip("trimesh", reason="trimesh reads the meshes; pip install trimesh")
    assert not (made / "gazebo" / "world_meshes.sdf").exists(), "a height-map would cut the sides"
    for layer in edged.layers:
        (path,) = (made / "gazebo").glob(f"models/*_{layer.label}/meshes/*.stl")
        found = trimesh.load_mesh(path)
        places, wanted = spread(edged, layer)
        seen = rays(np.asarray(found.vertices), np.asarray(found.faces), places)
        np.testing.assert_array_equal(np.isnan(seen), np.isnan(wanted))
        np.testing.assert_allclose(seen, wanted, atol=gazebo.CLOSE + 1e-4)


def test_libsdformat_takes_the_world(made: Path) -> None:
    check_with_libsdformat(made / "gazebo" / gazebo.WORLD)


class TestMujoco:
    @pytest.fixture(autouse=True)
    def _installed(self) -> None:
        pytest.importorskip("mujoco", reason="mujoco is not installed: its files are not loaded")

    def test_rays_meet_it_up_to_the_rims(self, edged: Terrain, made: Path) -> None:
        """A compartment is four quads; in two of them MuJoCo's diagonal is the other one."""
        for layer in edged.layers:
            places, wanted = spread(edged, layer)
            seen = looked_down(only(made / "mujoco" / mujoco.SCENE, layer), places)
            np.testing.assert_array_equal(np.isnan(seen), np.isnan(wanted))
            np.testing.assert_allclose(seen, wanted, atol=bend(edged, layer) / 2 + 2e-3)

    @pytest.mark.parametrize("place", [(4, BEAM_ROW), (20, BEAM_ROW), LONE[::-1]])
    def test_a_ball_rests_on_a_beam_one_compartment_wide(
        self, edged: Terrain, made: Path, place: tuple[int, int]
    ) -> None:
        x, y = edged.west + place[0] * CELL, edged.north - place[1] * CELL
        top = BEAM_TOP if place[1] == BEAM_ROW else 7.0
        gone = dropped(made / "mujoco" / mujoco.SCENE, (x, y, top + 0.3), (0, 0, 0))
        assert gone[-1, 2] == pytest.approx(top + 0.05, abs=0.01)

    def test_a_step_of_the_ground_is_closed(self, tmp_path: Path) -> None:
        """A ball rolled at a block of the lowest layer does not get into it."""
        mujoco_ = pytest.importorskip("mujoco")
        ground = np.zeros((8, 20))
        ground[:, 12:] = 1.5
        stack = stack_of(tmp_path / "made", [ground], reconstruction="edges", west=0.0, south=0.0)
        mujoco.write(Terrain.of_stack(stack), tmp_path / "out", Options())
        model = mujoco_.MjModel.from_xml_path(str(tmp_path / "out" / mujoco.SCENE))
        data, met = mujoco_.MjData(model), np.zeros(1, np.int32)
        mujoco_.mj_forward(model, data)
        for height in (0.05, 0.7, 1.45):
            east = mujoco_.mj_ray(
                model, data, np.array([1.0, 1.1, height]), np.array([1.0, 0, 0]), None, 1, -1, met
            )
            assert east == pytest.approx(12 * CELL - 1.0, abs=1e-6)


class TestPyBullet:
    @pytest.fixture
    def bodies(self, made: Path) -> Iterator[tuple[int, dict[str, list[int]]]]:
        engine = pytest.importorskip("pybullet", reason="pybullet is not installed: its files are not loaded")
        client: int = engine.connect(engine.DIRECT)
        engine.setGravity(0, 0, -9.81, physicsClientId=client)
        yield client, loaded(made / "pybullet", client)
        engine.disconnect(client)

    def test_rays_meet_it_up_to_the_rims(
        self, edged: Terrain, bodies: tuple[int, dict[str, list[int]]]
    ) -> None:
        from tests.core.targets.test_pybullet import layer_heights

        client, made = bodies
        for layer in edged.layers:
            places, wanted = spread(edged, layer)
            seen = layer_heights(made, layer.label, places, client)
            np.testing.assert_array_equal(np.isnan(seen), np.isnan(wanted))
            np.testing.assert_allclose(seen, wanted, atol=pybullet.CLOSE + 1e-3)

    @pytest.mark.parametrize("column", [4, 20])
    def test_a_ball_rests_on_a_beam_one_compartment_wide(
        self, edged: Terrain, bodies: tuple[int, dict[str, list[int]]], column: int
    ) -> None:
        from tests.core.targets.test_pybullet import dropped

        x, y = edged.west + column * CELL, edged.north - BEAM_ROW * CELL
        gone = dropped(bodies[0], (x, y, BEAM_TOP + 0.3), (0, 0, 0))
        assert gone[-1, 2] == pytest.approx(BEAM_TOP + 0.05, abs=0.015)

    def test_large_layers_are_several_bodies_without_a_seam(self, tmp_path: Path) -> None:
        engine = pytest.importorskip("pybullet", reason="pybullet is not installed: its files are not loaded")
        random = np.random.default_rng(3)
        rough = random.normal(0, 0.4, (200, 330))
        rough[50, 60] = np.nan
        (tmp_path / "out").mkdir()
        terrain = Terrain.of_stack(stack_of(tmp_path / "made", [rough], reconstruction="edges"))
        pybullet.write(terrain, tmp_path / "out", Options())
        client: int = engine.connect(engine.DIRECT)
        try:
            made = loaded(tmp_path / "out", client, visible=False, offset=(10.0, 20.0, 30.0))
            assert len(made["layer_00"]) == 6
            from tests.core.targets.test_pybullet import layer_heights

            places, wanted = spread(terrain, terrain.layers[0])
            seen = layer_heights(made, "layer_00", places + np.array([10.0, 20.0]), client)
            np.testing.assert_array_equal(np.isnan(seen), np.isnan(wanted))
            np.testing.assert_allclose(seen - 30, wanted, atol=5e-3)
        finally:
            engine.disconnect(client)


def loaded(folder: Path, client: int, **more: Any) -> dict[str, list[int]]:
    from tests.core.targets.test_pybullet import loaded as load

    return load(folder, client, **more)


def test_the_simulators_surface_is_still_to_be_had(edged: Terrain, tmp_path: Path) -> None:
    """What was built one way can be written the other, and then is what it always was."""
    for number, (way, other) in enumerate((("edges", "simulator"), ("simulator", "edges"))):
        stack = stack_of(tmp_path / way, layers(), reconstruction=way)  # type: ignore[arg-type]
        write_targets(stack, ["mesh", "pybullet"], tmp_path / f"as {number}", wishes(None, None, other))
        write_targets(stack, ["mesh", "pybullet"], tmp_path / f"own {number}")
    for here, there in (("as 0", "own 1"), ("as 1", "own 0")):
        for path in (tmp_path / here).rglob("layer_*"):
            assert path.read_bytes() == (tmp_path / there / path.relative_to(tmp_path / here)).read_bytes()
    assert (tmp_path / "as 0" / "pybullet" / "layer_02.npy").exists()
    with pytest.raises(ParameterError, match="unknown reconstruction 'round'; choose among edges, simulator"):
        wishes(None, None, "round")


def test_what_has_no_pillar_is_said(tmp_path: Path) -> None:
    stack = stack_of(tmp_path / "s", [np.zeros((5, 5)), np.full((5, 5), np.nan)], reconstruction="edges")
    terrain = Terrain.of_stack(stack)
    for module in (gazebo, mesh, mujoco, pybullet):
        assert any("no pillar" in note for note in module.limits(terrain)), module.__name__


def test_a_whole_map_of_a_large_scan_is_few_height_fields_where_it_is_smooth(edged: Terrain) -> None:
    from stepfield.targets.squares import squares

    by_compartment = list(squares(edged, 0))
    by_sample = list(tiles(edged, edged.layers[0]))
    assert len(by_compartment) <= len(by_sample) + 40, "the letters are steps; all else is one rectangle"
